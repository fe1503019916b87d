// SPDX-License-Identifier: MIT
#include "study/experiment/definition_words.hpp"

#include <array>

namespace tactor::study {
namespace {

struct wording {
    std::string_view field;
    std::string_view key;
};

constexpr std::array wordings{
    wording{"level_dbfs", "level.dbfs"},
    wording{"sl_db", "level.sl_db"},
    wording{"fit_strokes() scales it to the array, ", ""},
    wording{"outside = clamp", "the method's outside, \"clamp\","},
    wording{"drop_points = true", "the method's drop-points, true,"},
    wording{"faces = delaunay", "the method's faces, \"delaunay\","},
    wording{"snap = true", "the method's snap, true,"},
};

} // namespace

std::string in_definition_words(std::string_view hint)
{
    std::string text(hint);
    for (const wording& w : wordings)
        if (const std::size_t at = text.find(w.field); at != std::string::npos)
            text.replace(at, w.field.size(), w.key);
    return text;
}

} // namespace tactor::study
