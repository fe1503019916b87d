// SPDX-License-Identifier: MIT
// SVG path data, there and back again.
#include <cmath>
#include <optional>

#include <tactor/path.hpp>

#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const auto p = fuzz::accepted([&] { return std::optional(path::from_svg(fuzz::as_text(data, size))); });
    if (!p)
        return 0;
    fuzz::check_path(*p);
    try {
        const path again = path::from_svg(p->svg());
        HOLDS(std::abs(again.length_mm() - p->length_mm()) <= 1e-3 + 1e-9 * p->length_mm());
    } catch (const error& e) {
        // A flat arc within the limit may have radii beyond it.
        HOLDS(std::string_view(e.what()).find("is beyond 1e+06") != std::string_view::npos);
    }
    return 0;
}
