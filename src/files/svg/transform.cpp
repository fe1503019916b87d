// SPDX-License-Identifier: MIT
// The transform attribute: https://www.w3.org/TR/css-transforms-1/#svg-transform
#include <cmath>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <fmt/format.h>

#include "core/suggest.hpp"
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

[[noreturn]] void wrong_count(std::string_view name, std::size_t got, std::size_t offset)
{
    throw value_fault{offset, fmt::format("{}() with {} numbers", name, got),
                      "matrix takes 6, translate and scale 1 or 2, rotate 1 or 3, skewX and skewY 1"};
}

affine one(std::string_view name, const std::vector<double>& v, std::size_t offset)
{
    const std::size_t n = v.size();
    if (name == "matrix")
        return n == 6 ? affine{v[0], v[1], v[2], v[3], v[4], v[5]} : (wrong_count(name, n, offset), affine{});
    if (name == "translate" && (n == 1 || n == 2))
        return translation(v[0], n == 2 ? v[1] : 0.0);
    if (name == "scale" && (n == 1 || n == 2))
        return {v[0], 0.0, 0.0, v[n - 1], 0.0, 0.0};
    if (name == "rotate" && n == 1)
        return rotation(v[0]);
    if (name == "rotate" && n == 3)
        return translation(v[1], v[2]) * rotation(v[0]) * translation(-v[1], -v[2]);
    if (name == "skewX" && n == 1)
        return {1.0, 0.0, tangent(v[0]), 1.0, 0.0, 0.0};
    if (name == "skewY" && n == 1)
        return {1.0, tangent(v[0]), 0.0, 1.0, 0.0, 0.0};
    for (const std::string_view known : {"translate", "scale", "rotate", "skewX", "skewY"})
        if (name == known)
            wrong_count(name, n, offset);
    throw value_fault{offset, fmt::format("{} is not a transform", quoted(name)),
                      "known: matrix, translate, scale, rotate, skewX, skewY"};
}

} // namespace

affine parse_svg_transform(std::string_view text)
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
            throw value_fault{begin, fmt::format("{} is not a transform", quoted(text.substr(begin))),
                              "e.g. translate(20, 20) rotate(90)"};
        std::string_view name = text.substr(begin, open - begin);
        while (!name.empty() && blank(name.back()))
            name.remove_suffix(1);
        std::vector<double> numbers;
        try {
            numbers = svg_numbers(text.substr(open + 1, close - open - 1));
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

} // namespace tactor::detail
