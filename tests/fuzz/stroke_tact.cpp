// SPDX-License-Identifier: MIT
// Stroke files: bHaptics' .tact.
#include <string>

#include "files/stroke_format.hpp"
#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string name = "fuzz.tact";
    for (const stroke& s : fuzz::accepted([&] {
             return detail::find_format_by_name("tact")->parse({fuzz::as_text(data, size), name});
         }))
        fuzz::check_stroke(s);
    return 0;
}
