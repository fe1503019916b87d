// SPDX-License-Identifier: MIT
#include "plot/paint/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <boost/locale/utf.hpp>
#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::plot {
namespace {

constexpr std::array anchors{colour{68, 1, 84},    colour{71, 44, 122},  colour{59, 81, 139},
                             colour{44, 113, 142}, colour{33, 144, 141}, colour{39, 173, 129},
                             colour{92, 200, 99},  colour{170, 220, 50}, colour{253, 231, 37}};
constexpr double lightest = 0.92;

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, double part) noexcept
{
    return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
}

// Advance widths of the characters ' ' to '~', in 1/1000 of the font size.
constexpr std::array<std::uint16_t, 95> advances{
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361,  318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635,  611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352,  635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592,  525, 636, 337, 636, 838};
constexpr double other_advance = 1.0; // em; wide enough for ideographs
constexpr double bold_factor = 1.13;
constexpr std::string_view replacement = "\xEF\xBF\xBD";
constexpr std::string_view ellipsis = "\xE2\x80\xA6";

using utf8 = boost::locale::utf::utf_traits<char>;

constexpr std::uint32_t highest = 0x10FFFF;

bool is_printable(std::uint32_t v) noexcept
{
    return v >= 0x20 && v != 0x7F && !(v >= 0x80 && v < 0xA0) && v != 0xFFFE && v != 0xFFFF && v <= highest;
}

bool is_digit(char c) noexcept
{
    return c >= '0' && c <= '9';
}

// Shortens texts so that texts that differ still differ, if `most` pt are enough for this.
std::vector<std::string> shorten_apart(const std::vector<std::string>& texts, double size, double width,
                                       double most)
{
    const auto count = [](const auto& all) { return std::set(all.begin(), all.end()).size(); };
    for (;; width += size)
        for (const double end : {0.0, 0.5, 1.0}) {
            std::vector<std::string> all;
            for (const std::string& t : texts)
                all.push_back(shorten(t, size, std::min(width, most), false, end));
            if (width >= most || count(all) == count(texts))
                return all;
        }
}

} // namespace

colour map_to_colour(double u) noexcept
{
    const double at = (std::isfinite(u) ? std::clamp(u, 0.0, 1.0) : 0.0) * lightest * (anchors.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
    const double part = at - static_cast<double>(i);
    const colour a = anchors[i];
    const colour b = anchors[i + 1];
    return {mixed(a.r, b.r, part), mixed(a.g, b.g, part), mixed(a.b, b.b, part)};
}

colour stroke_colour(std::size_t n) noexcept
{
    constexpr std::array<colour, stroke_colours> all{
        colour{26, 133, 255}, colour{230, 159, 0},   colour{51, 34, 136}, colour{34, 136, 51},
        colour{170, 68, 153}, colour{102, 204, 238}, colour{102, 51, 51}, colour{119, 119, 119},
        colour{0, 0, 0},      colour{187, 187, 187}};
    return all[n % all.size()];
}

double text_width(std::string_view utf8, double size, bool bold) noexcept
{
    double em = 0.0;
    for (const char c : utf8) {
        const auto u = static_cast<unsigned char>(c);
        if (u >= 0x20 && u < 0x7F)
            em += advances[u - 0x20U] / 1000.0;
        else if ((u & 0xC0U) != 0x80U) // counts each UTF-8 sequence once
            em += other_advance;
    }
    return em * size * (bold ? bold_factor : 1.0);
}

std::string clean(std::string_view text)
{
    std::string out;
    for (const char* at = text.data(); at != text.data() + text.size();) {
        const char* const first = at;
        const std::uint32_t v = utf8::decode(at, text.data() + text.size());
        if (v > highest) // invalid: the bytes after the first may be valid
            at = first + 1;
        if (is_printable(v))
            out.append(first, at);
        else
            out += v == '\t' || v == '\n' ? " " : replacement;
    }
    return out;
}

std::string shorten(std::string_view text, double size, double width, bool bold, double end)
{
    const std::string all = clean(text);
    const double whole = text_width(all, size, bold);
    if (whole <= width)
        return all;
    const double space = width - text_width(ellipsis, size, bold);
    const auto find_next = [&](std::size_t i) {
        return i + 1 + static_cast<std::size_t>(utf8::trail_length(all[i]));
    };
    const auto measure = [&](std::size_t from, std::size_t to) {
        return text_width(std::string_view(all).substr(from, to - from), size, bold);
    };
    std::size_t tail = 0; // start of the end that remains
    for (double rest = whole; tail < all.size() && rest > end * space; tail = find_next(tail))
        rest -= measure(tail, find_next(tail));
    std::size_t head = 0; // end of the beginning that remains
    double used = measure(tail, all.size());
    while (head < tail && (used += measure(head, find_next(head))) <= space)
        head = find_next(head);
    return all.substr(0, head).append(ellipsis).append(all, tail);
}

std::string shorten_title(std::string_view text, double size, double width, bool bold)
{
    const std::size_t last = text.ends_with(')') ? std::min(text.rfind(" ("), text.size()) : text.size();
    const std::string end = clean(text.substr(last));
    const double space = width - text_width(end, size, bold);
    return space < width / 4.0 ? shorten(text, size, width, bold, 0.5)
                               : shorten(text.substr(0, last), size, space, bold, 0.5) + end;
}

std::vector<std::string> shorten_names(const std::vector<std::string>& names, double size, double width,
                                       double most)
{
    std::vector<std::vector<std::string_view>> parts; // by name
    std::size_t columns = 1;
    double widest = 0.0;
    for (const std::string& name : names) {
        parts.push_back(detail::split(name, ':'));
        columns = std::max(columns, parts.back().size());
        widest = std::max(widest, text_width(clean(name), size));
    }
    std::vector<std::string> all(names.size());
    if (widest <= width) {
        std::ranges::transform(names, all.begin(), clean);
        return all;
    }
    const auto share = static_cast<double>(columns);
    const double colon = text_width(":", size);
    for (std::size_t k = 0; k < columns; ++k) {
        std::vector<std::string> column;
        for (const std::vector<std::string_view>& own : parts)
            column.emplace_back(k < own.size() ? own[k] : "");
        column = shorten_apart(column, size, width / share - colon, most / share - colon);
        for (std::size_t i = 0; i < names.size(); ++i)
            all[i] += (k > 0 && k < parts[i].size() ? ":" : "") + column[i];
    }
    return all;
}

std::vector<std::string> wrap(std::string_view text, double size, double width, std::size_t most_lines)
{
    std::vector<std::string> lines;
    for (const std::string_view word : detail::split(text, ' ')) {
        if (word.empty())
            continue;
        const std::string longer = lines.empty() ? clean(word) : lines.back() + " " + clean(word);
        if (lines.empty() || (lines.size() < most_lines && text_width(longer, size) > width)) {
            std::string next = clean(word);
            if (const std::size_t space = lines.empty() ? std::string::npos : lines.back().rfind(' ');
                space != std::string::npos && is_digit(lines.back().back()) && !is_digit(next.front())) {
                next.insert(0, lines.back().substr(space + 1) + " "); // the number of this unit
                lines.back().resize(space);
            }
            lines.push_back(std::move(next));
        } else {
            lines.back() = longer;
        }
    }
    for (std::string& l : lines)
        l = shorten(l, size, width);
    return lines;
}

std::string number(double v, int digits)
{
    return fmt::format("{:.{}g}", v + 0.0, digits); // -0 becomes 0
}

} // namespace tactor::plot
