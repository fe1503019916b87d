// SPDX-License-Identifier: MIT
#include "files/svg/values.hpp"

#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor::detail {
namespace {

double number_at(std::string_view text, std::size_t& at)
{
    const std::size_t begin = at;
    const auto v = scan_number(text, at);
    if (!v)
        throw value_fault{at, fmt::format("{} is not a number", detail::quoted(text.substr(at))),
                          "e.g. 12.5"};
    if (!(std::abs(*v) <= max_user_units))
        throw value_fault{begin, fmt::format("{:g} is beyond {:g}", *v, max_user_units),
                          "is it the right unit?"};
    return *v;
}

affine translation(double x, double y)
{
    return {1.0, 0.0, 0.0, 1.0, x, y};
}

double tangent(double degrees)
{
    return std::tan(degrees * 3.14159265358979323846 / 180.0);
}

affine one_transform(std::string_view name, const std::vector<double>& v)
{
    const std::size_t n = v.size();
    if (name == "matrix" && n == 6)
        return {v[0], v[1], v[2], v[3], v[4], v[5]};
    if (name == "translate" && (n == 1 || n == 2))
        return translation(v[0], n == 2 ? v[1] : 0.0);
    if (name == "scale" && (n == 1 || n == 2))
        return {v[0], 0.0, 0.0, v[n - 1], 0.0, 0.0};
    if (name == "rotate" && n == 1)
        return rotation(v[0]);
    if (name == "rotate" && n == 3)
        return translation(v[1], v[2]) * rotation(v[0]) * translation(-v[1], -v[2]);
    if (name == "skewx" && n == 1)
        return {1.0, 0.0, tangent(v[0]), 1.0, 0.0, 0.0};
    if (name == "skewy" && n == 1)
        return {1.0, tangent(v[0]), 0.0, 1.0, 0.0, 0.0};
    throw value_fault{
        0, fmt::format("{} with {} is not a transform", detail::quoted(name), counted(n, "number")), ""};
}

} // namespace

double svg_number(std::string_view text)
{
    std::size_t at = 0;
    skip_blanks(text, at);
    const double v = number_at(text, at);
    if (const auto rest = without_blanks(text.substr(at)); !rest.empty())
        throw value_fault{at, fmt::format("{} behind the number", detail::quoted(rest)),
                          "a number without a unit"};
    return v;
}

std::vector<double> svg_numbers(std::string_view text, std::string_view unit)
{
    std::vector<double> all;
    std::size_t at = 0;
    skip_blanks(text, at);
    while (at < text.size()) {
        all.push_back(number_at(text, at));
        at += text.substr(at).starts_with(unit) ? unit.size() : 0;
        skip_blanks(text, at);
        if (at < text.size() && text[at] == ',') {
            ++at;
            skip_blanks(text, at);
            if (at == text.size())
                throw value_fault{at, "ends with a comma", "a number follows a comma"};
        }
    }
    return all;
}

svg_length parse_svg_length(std::string_view text)
{
    struct known_unit {
        std::string_view name;
        double mm;
    };
    constexpr std::array units{known_unit{"mm", 1.0},        known_unit{"cm", 10.0},
                               known_unit{"in", 25.4},       known_unit{"pt", 25.4 / 72.0},
                               known_unit{"pc", 25.4 / 6.0}, known_unit{"px", mm_per_px},
                               known_unit{"q", 0.25}};
    std::size_t at = 0;
    skip_blanks(text, at);
    const double v = number_at(text, at);
    const std::string unit = in_small_letters(std::string(without_blanks(text.substr(at))));
    if (unit.empty())
        return {v, svg_length::unit::none};
    if (unit == "%")
        return {v, svg_length::unit::percent};
    for (const known_unit& u : units)
        if (u.name == unit)
            return {v * u.mm, svg_length::unit::mm};
    throw value_fault{at, fmt::format("unit {} is not known", detail::quoted(unit)),
                      "known units: mm, cm, in, pt, pc, px, Q, %"};
}

double svg_length::user_units(const svg_viewport& v, svg_extent e) const noexcept
{
    if (in == unit::none)
        return value;
    if (in == unit::mm)
        return value * v.per_mm;
    const double whole = e == svg_extent::width ? v.width
                         : e == svg_extent::height
                             ? v.height
                             : std::sqrt(0.5 * (v.width * v.width + v.height * v.height));
    return value / 100.0 * whole;
}

svg_view_box parse_svg_view_box(std::string_view text)
{
    const std::vector<double> v = svg_numbers(text);
    if (v.size() != 4)
        throw value_fault{0, fmt::format("{} of 4 numbers", v.size()), "give x, y, width and height"};
    if (!(v[2] > 0.0 && v[3] > 0.0))
        throw value_fault{0, "has no size", "width and height are more than 0"};
    return {{v[0], v[1]}, v[2], v[3]};
}

affine parse_svg_transform(std::string_view text)
{
    affine all;
    if (text == "none")
        return all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = text.find('(', at);
        const std::size_t close = text.find(')', at);
        if (close == std::string_view::npos || !(open < close))
            throw value_fault{0, fmt::format("{} is not a transform", detail::quoted(text.substr(at))), ""};
        const std::string_view name = without_blanks(text.substr(at, open - at));
        const bool turns = name == "rotate" || name.starts_with("skew");
        const std::string_view unit = turns ? "deg" : name == "translate" ? "px" : "";
        all = all * one_transform(name, svg_numbers(text.substr(open + 1, close - open - 1), unit));
        at = close + 1;
        while (at < text.size() && (blank(text[at]) || text[at] == ','))
            ++at;
    }
    return all;
}

} // namespace tactor::detail
