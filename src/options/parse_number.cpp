// SPDX-License-Identifier: MIT
#include "options/parse_number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/words.hpp"

namespace tactor::options {
namespace {

// Returns one of the given unit in the option's own; 0 for another kind of unit.
double unit_factor(std::string_view given, std::string_view unit)
{
    struct entry {
        std::string_view unit;
        std::string_view given;
        double factor;
    };
    constexpr std::array<entry, 15> known{{{"s", "s", 1.0},
                                           {"s", "sec", 1.0},
                                           {"s", "ms", 1e-3},
                                           {"s", "us", 1e-6},
                                           {"s", "min", 60.0},
                                           {"ms", "ms", 1.0},
                                           {"ms", "s", 1e3},
                                           {"Hz", "Hz", 1.0},
                                           {"Hz", "kHz", 1e3},
                                           {"mm", "mm", 1.0},
                                           {"mm", "cm", 10.0},
                                           {"mm/s", "mm/s", 1.0},
                                           {"mm/s", "cm/s", 10.0},
                                           {"dBFS", "dB", 1.0},
                                           {"dB SL", "dB", 1.0}}};
    for (const entry& e : known)
        if (unit == e.unit && given == e.given)
            return e.factor;
    return given == unit ? 1.0 : 0.0;
}

// Returns what to write for "70ms" where seconds are meant, and for "1,5"; empty where that is not known.
std::string without_unit(const std::string& text, double v, std::string_view rest, detail::bounds b,
                         std::string_view unit)
{
    if (rest.front() == ',') {
        std::string point = text;
        point[point.find(',')] = '.';
        return detail::number_in<double>(point) ? fmt::format("write a decimal point, as {}", point) : "";
    }
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    const double meant = v * unit_factor(rest, unit);
    if (meant == 0.0 || !b.holds(meant))
        return {};
    return fmt::format("give {} without a unit, as {}", unit == "s" ? "seconds" : unit, plain_number(meant));
}

} // namespace

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
        const std::string meant = r.ec == std::errc() ? without_unit(text, v, {r.ptr, end}, b, unit) : "";
        throw detail::bad_field(what, fmt::format("\"{}\" is not a number", text),
                                meant.empty() ? range : fmt::format("{}; {}", meant, range));
    }
    if (r.ec != std::errc() || !std::isfinite(v) || !b.holds(v))
        throw detail::bad_field(what, fmt::format("{} is out of range", text), sign_hint(b, v) + range);
    return v;
}

double parse_whole(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit)
{
    const double v = parse_number(what, text, b, unit);
    if (v != std::floor(v))
        throw detail::bad_field(what, fmt::format("{} is not a whole number", text),
                                fmt::format("give one, as {}", plain_number(std::max(b.low, std::floor(v)))));
    return v;
}

std::string sign_hint(detail::bounds b, double v)
{
    return v > 0.0 && b.holds(-v) ? fmt::format("did you mean {}? ", plain_number(-v)) : "";
}

} // namespace tactor::options
