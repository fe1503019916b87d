// SPDX-License-Identifier: MIT
// Array files.
#include <tactor/setup.hpp>

#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const setup s = fuzz::accepted([&] { return parse_setup(fuzz::as_text(data, size), "fuzz.toml"); });
    if (s.array)
        fuzz::check_array(*s.array);
    return 0;
}
