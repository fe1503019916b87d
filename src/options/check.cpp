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

std::string subject(const option& o)
{
    return fmt::format("{{{}}}", o.name);
}

[[noreturn]] void refuse_value(const option& o, const std::string& why, const std::string& hint)
{
    throw error(error_kind::bad_input, subject(o), why, hint).with_field(o.name);
}

std::string shown(const value& v)
{
    if (const auto* b = std::get_if<bool>(&v))
        return *b ? "true" : "false";
    if (const auto* d = std::get_if<double>(&v))
        return fmt::format("{}", *d);
    if (const auto* s = std::get_if<std::string>(&v))
        return fmt::format("\"{}\"", *s);
    return "that";
}

value choose(const option& o, const value& v)
{
    const auto* name = std::get_if<std::string>(&v);
    const auto known = o.choices();
    if (name != nullptr && std::find(known.begin(), known.end(), *name) != known.end())
        return v;
    const std::string_view like = name == nullptr ? "" : detail::nearest_name(*name, known);
    refuse_value(o, shown(v) + " is not known",
                 like.empty() ? fmt::format("one of {}", choices_text(o))
                              : fmt::format("did you mean {}? One of {}", like, choices_text(o)));
}

value check_number(const option& o, const value& v)
{
    const auto* d = std::get_if<double>(&v);
    if (d == nullptr)
        refuse_value(o, shown(v) + " is not a number", range_text(o));
    if (!std::isfinite(*d) || !o.allowed.holds(*d))
        refuse_value(o, shown(v) + " is out of range", range_text(o));
    if (o.what == kind::whole && *d != std::floor(*d))
        refuse_value(o, shown(v) + " is not a whole number",
                     fmt::format("give one, as {}", plain_number(std::max(o.allowed.low, std::floor(*d)))));
    return v;
}

} // namespace

value read_text(const option& o, const std::string& text)
{
    switch (o.what) {
    case kind::number:
    case kind::whole: {
        try {
            const double v = parse_number(subject(o), text, o.allowed.low, o.allowed.high,
                                          std::string(o.unit), range_text(o));
            return check_number(o, v);
        } catch (const error& e) {
            throw e.with_field(o.name);
        }
    }
    case kind::flag:
        if (text != "true" && text != "false")
            refuse_value(o, fmt::format("\"{}\" is neither true nor false", text), "");
        return text == "true";
    case kind::choice:
        return choose(o, text);
    case kind::text:
        break;
    }
    return text;
}

value read_value(const option& o, const value& said)
{
    switch (o.what) {
    case kind::number:
    case kind::whole:
        return check_number(o, said);
    case kind::flag:
        if (!std::holds_alternative<bool>(said))
            refuse_value(o, shown(said) + " is neither true nor false", "");
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
        refuse_value(o, shown(said) + " is no text", "put it in quotes");
    return said;
}

void put(wishes& w, const option& o, const value& v)
{
    try {
        o.to.set(w, v);
    } catch (const error& e) {
        const bool about_it = e.subject() == o.name || e.subject() == subject(o) || e.field() == o.name;
        throw e
            .reworded(about_it ? subject(o) : fmt::format("{}: {}", subject(o), e.subject()), e.why(),
                      e.hint())
            .with_field(o.name);
    }
}

} // namespace tactor::options
