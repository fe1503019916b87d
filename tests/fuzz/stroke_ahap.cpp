// SPDX-License-Identifier: MIT
// Stroke files and textures: .ahap.
#include <memory>
#include <string>

#include <tactor/waveform.hpp>

#include "files/stroke_format.hpp"
#include "files/vibration_file.hpp"
#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string name = "fuzz.ahap";
    const auto as_texture = [&] {
        waveform w{.kind = waveform_kind::recording, .texture = texture_kind::time};
        w.recorded = std::make_shared<const recording>(
            recording{.source = detail::read_ahap(fuzz::as_text(data, size), name)});
        validate(w); // what a reader accepts is valid
        return true;
    };
    fuzz::accepted(as_texture);
    for (const stroke& s : fuzz::accepted([&] {
             return detail::find_format_by_name("ahap")->parse({fuzz::as_text(data, size), name});
         }))
        fuzz::check_stroke(s);
    return 0;
}
