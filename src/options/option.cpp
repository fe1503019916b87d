// SPDX-License-Identifier: MIT
#include "options/option.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/marks.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor::options {
namespace {

// Compares option names. '-' and '_' count as equal.
bool is_same_name(std::string_view a, std::string_view b)
{
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
               return (x == '-' ? '_' : x) == (y == '-' ? '_' : y);
           });
}

value choose(const option& o, const value& v)
{
    const auto* name = std::get_if<std::string>(&v);
    const auto known = o.choices();
    if (name != nullptr && std::find(known.begin(), known.end(), *name) != known.end())
        return v;
    const std::string_view like = name == nullptr ? "" : detail::nearest_name(*name, known);
    throw refusal(o, value_text(v) + " is unknown",
                  like.empty() ? fmt::format("use one of {}", choices_text(o))
                               : fmt::format("did you mean {}? Use one of {}", like, choices_text(o)));
}

value check_number(const option& o, const value& v)
{
    const auto* d = std::get_if<double>(&v);
    if (d == nullptr)
        throw refusal(o, value_text(v) + " is not a number", "use " + range_text(o));
    if (!std::isfinite(*d) || !o.allowed.holds(*d))
        throw refusal(o, value_text(v) + " is out of range", sign_hint(o.allowed, *d) + range_text(o));
    if (o.what == kind::whole && *d != std::floor(*d))
        throw refusal(o, value_text(v) + " is not a whole number",
                      fmt::format("give a whole number, such as {}",
                                  plain_number(std::max(o.allowed.low, std::floor(*d)))));
    return v;
}

// Returns the factor that converts a typed unit to the option's unit, or 0 if this is impossible.
double unit_factor(std::string_view typed, std::string_view unit)
{
    struct entry {
        std::string_view unit;
        std::string_view typed;
        double factor;
    };
    constexpr std::array<entry, 10> known{{{"s", "sec", 1.0},
                                           {"s", "ms", 1e-3},
                                           {"s", "us", 1e-6},
                                           {"s", "min", 60.0},
                                           {"ms", "s", 1e3},
                                           {"Hz", "kHz", 1e3},
                                           {"mm", "cm", 10.0},
                                           {"mm/s", "cm/s", 10.0},
                                           {"dBFS", "dB", 1.0},
                                           {"dB SL", "dB", 1.0}}};
    for (const entry& e : known)
        if (unit == e.unit && typed == e.typed)
            return e.factor;
    return typed == unit ? 1.0 : 0.0;
}

// Returns the number that the user should have typed instead of "70ms" (for an option in seconds) or "1,5".
// Returns "" if this number is not known.
std::string unit_hint(const std::string& text, double v, std::string_view rest, detail::bounds b,
                      std::string_view unit)
{
    if (rest.front() == ',') {
        std::string point = text;
        point[point.find(',')] = '.';
        return detail::parse_number_text<double>(point)
                   ? fmt::format("write a decimal point, as in {}", point)
                   : "";
    }
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    const double meant = v * unit_factor(rest, unit);
    if (meant == 0.0 || !b.holds(meant))
        return {};
    return fmt::format("give {} without a unit, such as {}", unit == "s" ? "seconds" : unit,
                       plain_number(meant));
}

const own_word* find_own(std::string_view mark, const spelling& by)
{
    const auto found =
        std::find_if(by.own.begin(), by.own.end(), [mark](const own_word& w) { return w.mark == mark; });
    return found == by.own.end() ? nullptr : &*found;
}

std::string write(const detail::mark& m, const spelling& by, bool in_file)
{
    const own_word* own = find_own(m.setting, by);
    if (own == nullptr)
        own = find_own(m.name, by);
    if (own != nullptr)
        return own->here.empty() ? "" : fmt::format(fmt::runtime(own->here), m.value).append(m.clause);
    const option* o = find(m.name);
    if (o == nullptr && detail::command_name(m).empty())
        return std::string(m.text);
    const bool has_it =
        o != nullptr && (o->where & by.where) != 0 && !(in_file && (o->where & in_stroke) != 0);
    return (has_it ? by.write(*o, m.value) : detail::plain(m)).append(m.clause);
}

} // namespace

std::span<const place_name> command_names() noexcept
{
    static constexpr std::array names{place_name{on_plan, "plan"},
                                      place_name{on_render, "render"},
                                      place_name{on_plot, "plot"},
                                      place_name{on_convert, "convert"},
                                      place_name{on_compare, "compare"},
                                      place_name{on_play, "play"},
                                      place_name{on_check, "check"},
                                      place_name{on_calibrate, "calibrate"},
                                      place_name{on_experiment, "experiment"},
                                      place_name{on_devices, "devices"},
                                      place_name{on_off, "off"},
                                      place_name{on_serve, "serve"}};
    return names;
}

const option* find(std::string_view name) noexcept
{
    for (const option& o : all())
        if (is_same_name(o.name, name) || o.field_name() == name)
            return &o;
    return nullptr;
}

std::string dashed(const option& o)
{
    std::string name(o.name);
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

std::vector<std::string> dashed_names(std::uint64_t where)
{
    std::vector<std::string> names;
    for (const option& o : all())
        if ((o.where & where) != 0)
            names.push_back(dashed(o));
    return names;
}

std::string value_text(const value& v)
{
    if (const auto* b = std::get_if<bool>(&v))
        return *b ? "true" : "false";
    if (const auto* d = std::get_if<double>(&v))
        return fmt::format("{}", *d);
    if (const auto* s = std::get_if<std::string>(&v))
        return fmt::format("\"{}\"", *s);
    return "that";
}

error refusal(const option& o, std::string_view why, std::string_view hint)
{
    return detail::bad_field(o.name, why, hint);
}

std::string choices_text(const option& o)
{
    return fmt::format("{}", fmt::join(o.choices(), ", "));
}

std::string range_text(const option& o)
{
    return o.range.empty() ? range_text(o.allowed, o.unit) : std::string(o.range);
}

std::string type_text(const option& o)
{
    if (!o.shown.empty())
        return std::string(o.shown);
    if (o.choices != nullptr)
        return fmt::format("{}", fmt::join(o.choices(), "|"));
    if (o.what == kind::whole)
        return o.unit == "Hz" ? "HZ" : "N";
    if (o.unit == "mm/s")
        return "MM_PER_S";
    std::string unit(o.unit);
    std::transform(unit.begin(), unit.end(), unit.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    return unit.empty() ? "X" : unit;
}

value read_text(const option& o, const std::string& text)
{
    if (o.what == kind::flag && (text == "true" || text == "false"))
        return text == "true";
    if (o.what != kind::number && o.what != kind::whole)
        return read_value(o, text);
    return read_value(o, parse_number(o.name, text, o.allowed, o.unit, range_text(o)));
}

value read_value(const option& o, const value& v)
{
    switch (o.what) {
    case kind::number:
    case kind::whole:
        return check_number(o, v);
    case kind::flag:
        if (!std::holds_alternative<bool>(v))
            throw refusal(o, value_text(v) + " is neither true nor false", "");
        return v;
    case kind::choice:
        return choose(o, v);
    case kind::text:
        break;
    }
    // A number is allowed for an option that is a text but may be a number, such as HZ[:DEPTH].
    if (std::holds_alternative<double>(v) && o.allowed.high > 0.0)
        return check_number(o, v);
    if (!std::holds_alternative<std::string>(v))
        throw refusal(o, value_text(v) + " is not a text", "put it in quotes");
    return v;
}

void put(option_values& w, const option& o, const value& v)
{
    try {
        o.to.set(w, v);
    } catch (const error& e) {
        if (e.field() == o.name)
            throw;
        throw e.reworded(fmt::format("{{{}}}: {}", o.name, e.subject()), e.why(), e.hint())
            .with_field(o.name);
    }
}

std::string range_text(detail::bounds b, std::string_view unit)
{
    return fmt::format("{}{} to {}{}{}", b.above_low ? "above " : "", plain_number(b.low),
                       plain_number(b.high), unit.empty() ? "" : " ", unit);
}

double parse_number(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit,
                    std::string range)
{
    double v = 0.0;
    const char* end = text.data() + text.size();
    const auto r = std::from_chars(text.data(), end, v);
    if (range.empty())
        range = range_text(b, unit);
    if (r.ec == std::errc::invalid_argument || r.ptr != end) {
        const std::string meant = r.ec == std::errc() ? unit_hint(text, v, {r.ptr, end}, b, unit) : "";
        throw detail::bad_field(what, fmt::format("\"{}\" is not a number", text),
                                meant.empty() ? "use " + range : fmt::format("{}; use {}", meant, range));
    }
    if (r.ec != std::errc() || !std::isfinite(v) || !b.holds(v))
        throw detail::bad_field(what, fmt::format("{} is out of range", text), sign_hint(b, v) + range);
    return v;
}

double parse_whole(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit)
{
    const double v = parse_number(what, text, b, unit);
    if (v != std::floor(v))
        throw detail::bad_field(
            what, fmt::format("{} is not a whole number", text),
            fmt::format("give a whole number, such as {}", plain_number(std::max(b.low, std::floor(v)))));
    return v;
}

std::string sign_hint(detail::bounds b, double v)
{
    return v > 0.0 && b.holds(-v) ? fmt::format("did you mean {}? Use ", plain_number(-v)) : "use ";
}

std::string spell(std::string_view text, const spelling& by, bool in_file)
{
    return detail::replace_marks(text, [&](const detail::mark& m) { return write(m, by, in_file); });
}

std::string spell_field(std::string_view field, const spelling& by)
{
    return write({.text = field, .setting = field, .name = field}, by, false);
}

error spell(const error& e, const spelling& by)
{
    const bool in_file = e.place().line != 0;
    const bool is_field = !in_file && e.subject() == e.field();
    return e.reworded(is_field ? spell_field(e.field(), by) : spell(e.subject(), by, in_file),
                      spell(e.why(), by, in_file), spell(e.hint(), by, in_file));
}

} // namespace tactor::options
