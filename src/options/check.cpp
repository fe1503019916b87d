// SPDX-License-Identifier: MIT
#include "options/check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "options/parse_number.hpp"

namespace tactor::options {
namespace {

value choose(const option& o, const value& v)
{
    const auto* name = std::get_if<std::string>(&v);
    const auto known = o.choices();
    if (name != nullptr && std::find(known.begin(), known.end(), *name) != known.end())
        return v;
    const std::string_view like = name == nullptr ? "" : detail::nearest_name(*name, known);
    throw refusal(o, shown(v) + " is not known",
                  like.empty() ? fmt::format("one of {}", choices_text(o))
                               : fmt::format("did you mean {}? One of {}", like, choices_text(o)));
}

value check_number(const option& o, const value& v)
{
    const auto* d = std::get_if<double>(&v);
    if (d == nullptr)
        throw refusal(o, shown(v) + " is not a number", range_text(o));
    if (!std::isfinite(*d) || !o.allowed.holds(*d))
        throw refusal(o, shown(v) + " is out of range", sign_hint(o.allowed, *d) + range_text(o));
    if (o.what == kind::whole && *d != std::floor(*d))
        throw refusal(o, shown(v) + " is not a whole number",
                      fmt::format("give one, as {}", plain_number(std::max(o.allowed.low, std::floor(*d)))));
    return v;
}

} // namespace

value read_text(const option& o, const std::string& text)
{
    if (o.what == kind::flag && (text == "true" || text == "false"))
        return text == "true";
    if (o.what != kind::number && o.what != kind::whole)
        return read_value(o, text);
    try {
        return read_value(o, parse_number(mark(o), text, o.allowed, std::string(o.unit), range_text(o)));
    } catch (const error& e) {
        throw e.with_field(o.name);
    }
}

value read_value(const option& o, const value& said)
{
    switch (o.what) {
    case kind::number:
    case kind::whole:
        return check_number(o, said);
    case kind::flag:
        if (!std::holds_alternative<bool>(said))
            throw refusal(o, shown(said) + " is neither true nor false", "");
        return said;
    case kind::choice:
        return choose(o, said);
    case kind::text:
        break;
    }
    // A text that may be a number, such as HZ[:DEPTH].
    if (std::holds_alternative<double>(said) && o.allowed.high > 0.0)
        return check_number(o, said);
    if (!std::holds_alternative<std::string>(said))
        throw refusal(o, shown(said) + " is no text", "put it in quotes");
    return said;
}

void put(wishes& w, const option& o, const value& v)
{
    try {
        o.to.set(w, v);
    } catch (const error& e) {
        const bool about_it = e.subject() == o.name || e.subject() == mark(o) || e.field() == o.name;
        throw e.reworded(about_it ? mark(o) : fmt::format("{}: {}", mark(o), e.subject()), e.why(), e.hint())
            .with_field(o.name);
    }
}

} // namespace tactor::options
