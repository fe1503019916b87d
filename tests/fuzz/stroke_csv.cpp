// SPDX-License-Identifier: MIT
// Stroke files: CSV.
#include <tactor/stroke.hpp>

#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    for (const stroke& s :
         fuzz::accepted([&] { return parse_strokes_csv(fuzz::as_text(data, size), "fuzz.csv"); }))
        fuzz::check_stroke(s);
    return 0;
}
