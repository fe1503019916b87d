// SPDX-License-Identifier: MIT
#include "server/option_rows.hpp"

#include <array>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "options/option.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::reply_json;
using options::option;

reply_json value_json(const option& o, const options::value& v)
{
    return std::visit(
        [&]<class T>(const T& x) -> reply_json {
            if constexpr (std::is_same_v<T, std::monostate>)
                return nullptr;
            else if constexpr (std::is_same_v<T, double>)
                return o.what == options::kind::whole ? reply_json(static_cast<std::int64_t>(x))
                                                      : reply_json(x);
            else
                return x;
        },
        v);
}

reply_json row_json(const option& o, const options::wishes& owner)
{
    constexpr std::array kinds{"number", "whole", "choice", "flag", "text"};
    const bool is_number = o.what == options::kind::number || o.what == options::kind::whole;
    const bool has_bounds = is_number && o.range.empty(); // else other values decide
    const auto bound = [&](double x) { return has_bounds ? value_json(o, x) : reply_json(nullptr); };
    const bool in_file = (o.where & options::in_stroke) != 0;
    reply_json choices = reply_json::array();
    if (o.choices != nullptr)
        for (const std::string_view c : o.choices())
            choices.push_back(c);
    return {{"name", o.name},
            {"key", in_file ? reply_json(o.field_name()) : reply_json(nullptr)},
            {"group", to_string(o.in)},
            {"kind", kinds.at(static_cast<std::size_t>(o.what))},
            {"unit", o.unit},
            {"least", bound(o.allowed.low)},
            {"most", bound(o.allowed.high)},
            {"choices", choices},
            {"default", value_json(o, o.to.get(owner))},
            {"help", in_words_of_protocol(o.help)},
            {"live", (o.where & options::live) != 0}};
}

} // namespace

reply_json option_rows(const options::wishes& owner)
{
    reply_json rows = reply_json::array();
    for (const option& o : options::all())
        if ((o.where & options::by_client) != 0)
            rows.push_back(row_json(o, owner));
    return rows;
}

} // namespace tactor::server
