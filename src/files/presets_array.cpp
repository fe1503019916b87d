// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <tactor/array.hpp>

#include "core/suggest.hpp"

namespace tactor {
inline namespace v0 {
namespace {

struct preset {
    std::string_view name;
    unsigned rows;
    unsigned columns;
    double pitch_mm;
};

constexpr preset presets[] = {
    {"palm-3x3", 3, 3, 20.0}, // Park et al. 2016, section 3
    {"palm-2x4", 2, 4, 20.0}, // as many tactors as an eight-channel card drives
};

} // namespace

const std::vector<std::string>& array_presets()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const preset& p : presets)
            all.emplace_back(p.name);
        return all;
    }();
    return names;
}

array preset_array(std::string_view name)
{
    for (const preset& p : presets)
        if (p.name == name)
            return make_grid(std::string(name), p.rows, p.columns, p.pitch_mm, p.pitch_mm);
    throw error(error_kind::bad_input, "array", fmt::format("there is no preset {}", detail::quoted(name)),
                detail::preset_hint(name, array_presets()) + "; or name a file");
}

} // namespace v0
} // namespace tactor
