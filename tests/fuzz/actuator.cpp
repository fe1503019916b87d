// SPDX-License-Identifier: MIT
// Actuator files (ACF): what is read plays, and a configuration can hold it.
#include <tactor/setup.hpp>
#include <tactor/waveform.hpp>

#include "core/vibration.hpp"
#include "files/vibration_file.hpp"
#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const actuator_numbers a =
        fuzz::accepted([&] { return detail::read_actuator(fuzz::as_text(data, size), "fuzz.acf"); });
    detail::check_vibration({.duration_s = 1.0, .amplitude = {{0.0, 1.0}}, .actuator = a}, "fuzz.acf");
    HOLDS(parse_setup(detail::texture_text(a), "again").texture.value_or(actuator_numbers{}) == a);
    return 0;
}
