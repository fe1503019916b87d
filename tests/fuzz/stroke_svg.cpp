// SPDX-License-Identifier: MIT
// Stroke files: SVG.
#include <tactor/stroke.hpp>

#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    for (const stroke& s :
         fuzz::accepted([&] { return parse_strokes_svg(fuzz::as_text(data, size), "fuzz.svg"); }))
        fuzz::check_stroke(s);
    return 0;
}
