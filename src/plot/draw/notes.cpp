// SPDX-License-Identifier: MIT
#include "plot/draw/notes.hpp"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/split.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_listed = 8;
constexpr const char* note_gap = "; ";

} // namespace

std::string tactors_text(const std::vector<unsigned>& tactors)
{
    if (tactors.size() > most_listed)
        return fmt::format("{} tactors", tactors.size());
    return fmt::format("tactor{} {}", tactors.size() == 1 ? "" : "s", fmt::join(tactors, ", "));
}

std::vector<std::string> note_lines(const std::vector<std::string>& notes, double width,
                                    std::size_t most_lines)
{
    constexpr std::size_t all = std::numeric_limits<std::size_t>::max();
    const double space = width - text_width(";", small_text);
    std::vector<std::string> lines;
    for (const std::string& n : notes) {
        if (n.empty())
            continue;
        if (!lines.empty() && text_width(lines.back() + note_gap + n, small_text) <= space) {
            lines.back() += note_gap + n;
            continue;
        }
        if (!lines.empty())
            lines.back() += ";";
        if (text_width(n, small_text) <= width) {
            lines.push_back(n);
            continue;
        }
        const auto words = detail::split(n, ' ');
        for (std::string& part : wrap({words.begin(), words.end()}, " ", small_text, space, all))
            lines.push_back(std::move(part));
    }
    if (lines.size() > most_lines) {
        const std::string longer = lines[most_lines - 1] + " " + lines[most_lines];
        lines.resize(most_lines);
        lines.back() = longer;
    }
    for (std::string& l : lines)
        l = shorten(l, small_text, width);
    return lines;
}

double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines)
{
    double y = where.y;
    for (const std::string& line : note_lines(notes, where.width, most_lines)) {
        c.text({where.x, y + cap_height(small_text) + 1.0}, line, {.size = small_text}, {.kind = "note"});
        y += note_height;
    }
    return y - where.y;
}

double draw_heading(canvas& c, const std::string& title, const std::vector<std::string>& lines, box where)
{
    double y = where.y + cap_height(title_size);
    c.text({where.x, y}, shorten(title, title_size, where.width, true), {.size = title_size, .bold = true});
    for (const std::string& line : lines) {
        y += line_pitch;
        c.text({where.x, y}, line, {.size = small_text, .ink = dark_grey});
    }
    return y;
}

} // namespace tactor::plot
