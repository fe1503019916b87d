// SPDX-License-Identifier: MIT
#include "plot/draw/notes.hpp"

#include <string>
#include <vector>

#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {

double draw_words(canvas& c, std::string_view text, box where, std::size_t most_lines, const char* kind)
{
    double y = where.y;
    for (const std::string& line : wrap(text, small_text, where.width, most_lines)) {
        c.text({where.x, y + cap_height(small_text) + 1.0}, line, {.size = small_text, .ink = dark_grey},
               {.kind = kind});
        y += note_height;
    }
    return y - where.y;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator)
{
    std::string all;
    for (const std::string& p : parts)
        if (!p.empty())
            all.append(all.empty() ? "" : separator).append(p);
    return all;
}

double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines)
{
    return draw_words(c, join(notes, "; "), where, most_lines, "note");
}

double draw_heading(canvas& c, const std::string& title, std::string_view text, box where)
{
    const double title_height = cap_height(title_size);
    c.text({where.x, where.y + title_height}, shorten(title, title_size, where.width, true),
           {.size = title_size, .bold = true});
    where.y += title_height + 2.5;
    return title_height + draw_words(c, text, where, 3, "facts");
}

} // namespace tactor::plot
