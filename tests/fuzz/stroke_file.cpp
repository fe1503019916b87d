// SPDX-License-Identifier: MIT
// Stroke files of the format FORMAT; .haptic and .ahap also as textures.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/waveform.hpp>

#include "files/stroke_format.hpp"
#include "files/vibration_file.hpp"
#include "holds.hpp"

using namespace tactor;

namespace {

constexpr std::string_view format = FORMAT;

// Does what a reader of waveforms does: what it accepts is valid.
void read_as_texture(vibration read(std::string_view, const std::string&), std::string_view text,
                     const std::string& name)
{
    fuzz::accepted([&] {
        waveform w{.kind = waveform_kind::recording, .texture = texture_kind::time};
        w.recorded = std::make_shared<const recording>(recording{.source = read(text, name)});
        validate(w);
        return true;
    });
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text = fuzz::as_text(data, size);
    const std::string name = "fuzz." + std::string(format);
    if (format == "haptic")
        read_as_texture(detail::read_haptic, text, name);
    if (format == "ahap")
        read_as_texture(detail::read_ahap, text, name);
    const detail::stroke_format& f = *detail::find_format_by_name(format);
    const std::vector<stroke> strokes = fuzz::accepted([&] { return f.parse({text, name}); });
    for (const stroke& s : strokes)
        fuzz::check_stroke(s);
    if (format == "haptic" && !strokes.empty())
        static_cast<void>(f.parse({f.write(strokes), name})); // what is written can be read
    return 0;
}
