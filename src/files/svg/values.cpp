// SPDX-License-Identifier: MIT
#include "files/svg/values.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

// Returns the rest of the text without the blanks round it.
std::string_view word_at(std::string_view text, std::size_t at)
{
    skip_blanks(text, at);
    std::size_t end = text.size();
    while (end > at && blank(text[end - 1]))
        --end;
    return text.substr(at, end - at);
}

std::size_t unit_end(std::string_view text, std::size_t at)
{
    while (at < text.size() &&
           (text[at] == '%' || (text[at] >= 'a' && text[at] <= 'z') || (text[at] >= 'A' && text[at] <= 'Z')))
        ++at;
    return at;
}

double alignment(std::string_view name, std::string_view whole)
{
    if (name == "Min")
        return 0.0;
    if (name == "Mid")
        return 0.5;
    if (name == "Max")
        return 1.0;
    throw value_fault{0, fmt::format("{} is not an alignment", detail::quoted(whole)),
                      "e.g. xMidYMid meet, or none"};
}

} // namespace

double svg_number(std::string_view text)
{
    std::size_t at = 0;
    skip_blanks(text, at);
    const double v = number_at(text, at);
    if (const auto rest = word_at(text, at); !rest.empty())
        throw value_fault{at, fmt::format("{} behind the number", detail::quoted(rest)),
                          "a number without a unit"};
    return v;
}

std::vector<double> svg_numbers(std::string_view text, const svg_unit& unit)
{
    std::vector<double> all;
    std::size_t at = 0;
    skip_blanks(text, at);
    while (at < text.size()) {
        double v = number_at(text, at);
        if (const std::size_t end = unit_end(text, at); unit && end > at) {
            try {
                v = unit(v, text.substr(at, end - at), all.size());
            } catch (value_fault& f) {
                f.offset += at;
                throw;
            }
            at = end;
        }
        all.push_back(v);
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
    const std::string unit = in_small_letters(std::string(word_at(text, at)));
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
    switch (in) {
    case unit::none:
        return value;
    case unit::mm:
        return value * v.per_mm;
    case unit::percent:
        break;
    }
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

svg_aspect parse_svg_aspect(std::string_view text)
{
    std::string_view rest = word_at(text, 0);
    if (constexpr std::string_view for_images = "defer "; rest.starts_with(for_images))
        rest = word_at(rest, for_images.size());
    const std::size_t gap = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    const std::string_view align = rest.substr(0, gap);
    const std::string_view how = word_at(rest, gap);
    if (!how.empty() && how != "meet" && how != "slice")
        throw value_fault{0, fmt::format("{} is neither meet nor slice", detail::quoted(how)),
                          "e.g. xMidYMid meet"};
    if (align == "none")
        return {false, false, 0.0, 0.0};
    if (align.size() != 8 || align[0] != 'x' || align[4] != 'Y')
        alignment({}, align);
    return {true, how == "slice", alignment(align.substr(1, 3), align), alignment(align.substr(5, 3), align)};
}

affine fit(const svg_view_box& box, point corner, double width, double height, const svg_aspect& a) noexcept
{
    double sx = width / box.width;
    double sy = height / box.height;
    if (a.keep)
        sx = sy = a.slice ? std::max(sx, sy) : std::min(sx, sy);
    return {sx,
            0.0,
            0.0,
            sy,
            corner.x_mm - box.corner.x_mm * sx + a.x * (width - box.width * sx),
            corner.y_mm - box.corner.y_mm * sy + a.y * (height - box.height * sy)};
}

} // namespace tactor::detail
