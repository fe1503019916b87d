// SPDX-License-Identifier: MIT
#include "server/stroke_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "options/option.hpp"
#include "options/settle.hpp"
#include "server/faults.hpp"

namespace tactor::server {

namespace {

using net::json;
using net::reply_json;
using options::option;

options::value plain_value(const json& v)
{
    if (v.is_boolean())
        return v.get<bool>();
    if (v.is_number())
        return v.get<double>();
    if (v.is_string())
        return v.get<std::string>();
    return {};
}

const option& known_option(const std::string& name, options_for which)
{
    const option* o = options::find(name);
    if (o == nullptr || o->name != name || (o->where & options::by_client) == 0) {
        std::vector<std::string_view> names;
        for (const option& x : options::all())
            if ((x.where & options::by_client) != 0)
                names.push_back(x.name);
        bad_param("options." + name, "there is no such option",
                  fmt::format("one of {}", fmt::join(names, ", ")));
    }
    if (which == options_for::live && (o->where & options::live) == 0)
        bad_param("options." + name, "a live stroke does not know it", "its points say when it is where");
    return *o;
}

// Refuses a waveform in a file: files are the server's own.
void refuse_file(const option& o, const options::value& v)
{
    const auto* text = std::get_if<std::string>(&v);
    if (o.name == "waveform" && text != nullptr && waveform_names_file(*text))
        bad_param("options.waveform", "a client may name no file",
                  "one of sine, square, triangle, sawtooth, noise:LO-HI");
}

constexpr double longest_wait_s = 86400.0;

constexpr std::pair<std::string_view, view_kind> views[] = {{"full", view_kind::full},
                                                            {"bursts", view_kind::bursts},
                                                            {"percept", view_kind::percept},
                                                            {"peaks", view_kind::peaks}};

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
        choices = o.choices();
    return {{"name", o.name},
            {"key", in_file ? reply_json(o.field_name()) : reply_json(nullptr)},
            {"group", o.in},
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

options::wishes with_options(options::wishes w, const json& given, options_for which)
{
    if (!given.is_object())
        bad_param("options", "they are no object", R"(such as {"algorithm":"continuous"})");
    // A client starts from the owner's values.
    w.given.reset();
    w.in_file.clear();
    w.place = options::by_client;
    for (const auto& [name, value] : given.items()) {
        const option& o = known_option(name, which);
        const options::value v = options::read_value(o, plain_value(value));
        refuse_file(o, v);
        options::give(w, o, v);
    }
    options::settle(w);
    return w;
}

view_choice read_view(const json& params)
{
    constexpr double most_bins = 4000.0;
    view_choice v;
    if (const json* name = member(params, "view")) {
        const std::string said = text(*name, "view");
        const auto* found = std::find_if(std::begin(views), std::end(views),
                                         [&](const auto& one) { return one.first == said; });
        if (found == std::end(views))
            bad_param("view", fmt::format("\"{}\" is not known", said),
                      "one of full, bursts, percept, peaks");
        v.kind = found->second;
    }
    if (const json* bins = member(params, "bins")) {
        if (v.kind != view_kind::peaks)
            bad_param("bins", "only the view peaks has them", R"(add "view":"peaks")");
        v.bins = static_cast<std::size_t>(whole(*bins, "bins", {1.0, most_bins}));
    }
    return v;
}

options::wishes settle_options(options::wishes owner, const json& params)
{
    const bool predicts = read_view(params).kind == view_kind::percept;
    if (!predicts)
        owner.observer = observer_kind::centroid; // which uses no option
    if (const json* given = member(params, "observer")) {
        const option& o = *options::find("observer");
        const std::string name = text(*given, "observer");
        const std::vector<std::string_view> known = o.choices();
        if (!predicts)
            bad_param("observer", "only the view percept has one", R"(add "view":"percept")");
        if (std::find(known.begin(), known.end(), name) == known.end())
            bad_param("observer", fmt::format("\"{}\" is not known", name),
                      fmt::format("one of {}", options::choices_text(o)));
        o.to.set(owner, name);
    }
    const json* given = member(params, "options");
    return given == nullptr ? owner : with_options(std::move(owner), *given, options_for::planned);
}

start_time read_start(const net::json* start, std::int64_t now_ns)
{
    constexpr const char* forms = R"("now", "armed", {"delay_s":S}, {"monotonic_s":S} or {"unix_s":S})";
    if (start == nullptr || *start == "now")
        return {};
    if (*start == "armed")
        return {true, {}};
    if (!start->is_object() || start->size() != 1)
        bad_param("start", "it is not known", forms);
    const std::string name = start->begin().key();
    const net::json& value = start->begin().value();
    const std::string what = "start." + name;
    const double most_s = 9e9; // a time of day for centuries
    if (name == "delay_s")
        return {false, now_ns + std::llround(number(value, what, {0.0, longest_wait_s}) * 1e9)};
    if (name != "monotonic_s" && name != "unix_s")
        bad_param(what, "it is not known", forms);
    std::int64_t at = std::llround(number(value, what, {0.0, most_s}) * 1e9);
    if (name == "unix_s")
        at += now_ns - unix_ns();
    if (static_cast<double>(at - now_ns) * 1e-9 > longest_wait_s)
        bad_param(what, "it is more than a day ahead", forms);
    return {false, at};
}

reply_json option_rows(const options::wishes& owner)
{
    reply_json rows = reply_json::array();
    for (const option& o : options::all())
        if ((o.where & options::by_client) != 0)
            rows.push_back(row_json(o, owner));
    return rows;
}

} // namespace tactor::server
