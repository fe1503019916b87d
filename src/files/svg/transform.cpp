// SPDX-License-Identifier: MIT
// Transforms: https://www.w3.org/TR/css-transforms-1/
#include <algorithm>
#include <cmath>
#include <optional>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/svg/values.hpp"

namespace tactor::detail {
namespace {

affine rotation(double degrees)
{
    // Exact for quarter turns.
    const double c = boost::math::cos_pi(degrees / 180.0);
    const double s = boost::math::sin_pi(degrees / 180.0);
    return {c, s, -s, c, 0.0, 0.0};
}

affine translation(double x, double y)
{
    return {1.0, 0.0, 0.0, 1.0, x, y};
}

double tangent(double degrees)
{
    return std::tan(degrees * 3.14159265358979323846 / 180.0);
}

std::vector<std::string_view> split_words(std::string_view text)
{
    std::vector<std::string_view> words;
    for (std::size_t at = 0;;) {
        skip_blanks(text, at);
        if (at == text.size())
            return words;
        const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
        words.push_back(text.substr(at, end - at));
        at = end;
    }
}

[[noreturn]] void wrong_count(std::string_view name, std::size_t got, std::size_t offset)
{
    throw value_fault{offset, fmt::format("{}() with {}", name, counted(got, "number")),
                      "matrix takes 6, translate and scale 1 or 2, rotate 1 or 3, skewX and skewY 1"};
}

double in_degrees(double value, std::string_view unit)
{
    struct angle {
        std::string_view name;
        double degrees;
    };
    for (const angle& a :
         {angle{"deg", 1.0}, {"grad", 0.9}, {"turn", 360.0}, {"rad", 180.0 / 3.14159265358979323846}})
        if (a.name == unit)
            return value * a.degrees;
    throw value_fault{0, fmt::format("{} is no unit of an angle", detail::quoted(unit)),
                      "deg, grad, rad or turn"};
}

double in_user_units(double value, std::string_view unit, const svg_viewport& v, svg_extent e)
{
    const svg_length l = parse_svg_length(fmt::format("{}{}", value, unit));
    return l.in == svg_length::unit::mm ? l.value / mm_per_px : l.user_units(v, e);
}

/// Returns the unit of a function's numbers.
double with_unit(std::string_view name, double value, std::string_view unit, std::size_t index,
                 const svg_viewport& v)
{
    if (name.starts_with("translate"))
        return in_user_units(value, unit, v,
                             name == "translatey" || index == 1 ? svg_extent::height : svg_extent::width);
    if (name.starts_with("rotate") || name.starts_with("skew"))
        return in_degrees(value, unit);
    if (name.starts_with("scale") && unit == "%")
        return value / 100.0;
    throw value_fault{0, fmt::format("unit {} in {}()", detail::quoted(unit), name),
                      "a number without a unit"};
}

affine one(std::string_view name, const std::vector<double>& v, std::size_t offset)
{
    const std::size_t n = v.size();
    if (name == "matrix")
        return n == 6 ? affine{v[0], v[1], v[2], v[3], v[4], v[5]} : (wrong_count(name, n, offset), affine{});
    if (name == "translate" && (n == 1 || n == 2))
        return translation(v[0], n == 2 ? v[1] : 0.0);
    if (name == "translatex" && n == 1)
        return translation(v[0], 0.0);
    if (name == "translatey" && n == 1)
        return translation(0.0, v[0]);
    if (name == "scalex" && n == 1)
        return {v[0], 0.0, 0.0, 1.0, 0.0, 0.0};
    if (name == "scaley" && n == 1)
        return {1.0, 0.0, 0.0, v[0], 0.0, 0.0};
    if (name == "skew" && (n == 1 || n == 2))
        return {1.0, n == 2 ? tangent(v[1]) : 0.0, tangent(v[0]), 1.0, 0.0, 0.0};
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
    for (const std::string_view known : {"translate", "translatex", "translatey", "scale", "scalex", "scaley",
                                         "rotate", "skew", "skewx", "skewy"})
        if (name == known)
            wrong_count(name, n, offset);
    throw value_fault{offset, fmt::format("{} is not a transform", detail::quoted(name)),
                      "known: matrix, translate, scale, rotate, skewX, skewY"};
}

} // namespace

affine parse_svg_transform(std::string_view text, const svg_viewport& v)
{
    affine all;
    std::size_t at = 0;
    skip_blanks(text, at);
    if (text.substr(at) == "none")
        return all;
    while (at < text.size()) {
        const std::size_t begin = at;
        const std::size_t open = text.find('(', at);
        const std::size_t close = text.find(')', at);
        if (close == std::string_view::npos || !(open < close))
            throw value_fault{begin, fmt::format("{} is not a transform", detail::quoted(text.substr(begin))),
                              "e.g. translate(20, 20) rotate(90)"};
        std::string_view name = text.substr(begin, open - begin);
        while (!name.empty() && blank(name.back()))
            name.remove_suffix(1);
        std::vector<double> numbers;
        try {
            numbers = svg_numbers(text.substr(open + 1, close - open - 1),
                                  [&](double value, std::string_view unit, std::size_t index) {
                                      return with_unit(name, value, unit, index, v);
                                  });
        } catch (value_fault& f) {
            f.offset += open + 1;
            throw;
        }
        all = all * one(name, numbers, begin);
        at = close + 1;
        while (at < text.size() && (blank(text[at]) || text[at] == ','))
            ++at;
    }
    return all;
}

point parse_svg_origin(std::string_view text, const svg_viewport& v)
{
    const auto words = split_words(text);
    if (words.empty() || words.size() > 3)
        throw value_fault{0, fmt::format("{} is not an origin", detail::quoted(text)),
                          "e.g. 20 20, 50% 50% or center"};
    std::optional<double> x;
    std::optional<double> y;
    for (std::size_t i = 0; i < std::min<std::size_t>(words.size(), 2); ++i) {
        const std::string_view w = words[i];
        if (w == "left" || w == "right")
            x = w == "left" ? 0.0 : v.width;
        else if (w == "top" || w == "bottom")
            y = w == "top" ? 0.0 : v.height;
        else if (w != "center")
            (i == 0 ? x : y) =
                svg_numbers(w, [&](double value, std::string_view unit, std::size_t) {
                    return in_user_units(value, unit, v, i == 0 ? svg_extent::width : svg_extent::height);
                }).front();
    }
    return {x.value_or(v.width / 2.0), y.value_or(v.height / 2.0)};
}

} // namespace tactor::detail
