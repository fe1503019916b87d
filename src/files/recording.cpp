// SPDX-License-Identifier: MIT
// WAV files as waveforms, and the words for all of these.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/path/number.hpp"
#include "core/sha256.hpp"
#include "core/suggest.hpp"
#include "files/sound_file.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{64} << 20;
constexpr std::string_view noise_prefix = "noise:";

waveform parse_noise(std::string_view band)
{
    waveform w;
    w.kind = waveform_kind::noise;
    std::size_t at = 0;
    const auto low = detail::scan_number(band, at);
    const bool dash = low && at < band.size() && band[at] == '-';
    const auto high = dash ? detail::scan_number(band, ++at) : std::nullopt;
    if (!high || at != band.size())
        throw error(error_kind::bad_input, "waveform", fmt::format("\"noise:{}\" is not noise:LO-HI", band),
                    "give two frequencies in Hz, such as noise:50-500")
            .with_field("wave");
    w.low_hz = *low;
    w.high_hz = *high;
    return w;
}

} // namespace

} // namespace v0
} // namespace tactor

namespace tactor::detail {

recording parse_recording(std::string_view bytes, const std::string& name)
{
    waveform as_texture;
    as_texture.kind = waveform_kind::recording;
    as_texture.texture = texture_kind::time;
    const wav_parts parts = find_wav_parts(bytes, name);
    const auto shared = std::make_shared<recording>();
    shared->file = name;
    shared->rate_hz = parts.format.rate;
    shared->samples = decode_wav(parts, most_recording_samples + 1);
    shared->sha256 = sha256_text(bytes);
    shared->missing = (parts.announced - parts.samples.size()) / parts.format.bytes;
    as_texture.recorded = shared;
    validate(as_texture);
    return std::move(*shared);
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

recording load_recording(const std::filesystem::path& file)
{
    // A pipe of the shell, <(...), has its other end already; this one would be waited for in silence.
    std::error_code unknown;
    if (std::filesystem::is_fifo(file, unknown) &&
        std::filesystem::exists(std::filesystem::canonical(file, unknown)))
        throw error(error_kind::bad_input, source_place{file.string()}, "is a pipe",
                    "name a WAV file, which can be read as often as it is needed");
    const detail::whole_text bytes = detail::read_text_file(file, max_file_bytes);
    return detail::parse_recording(bytes, file.string());
}

bool waveform_names_file(std::string_view text) noexcept
{
    // A word without a dot or a folder is a slip of a name.
    return text.find_first_of("./") != std::string_view::npos && !text.starts_with(noise_prefix);
}

waveform parse_waveform(std::string_view text, const std::filesystem::path& folder)
{
    waveform w;
    for (const waveform_kind k : all_values<waveform_kind>())
        if (text == to_string(k) && k != waveform_kind::noise && k != waveform_kind::recording) {
            w.kind = k;
            return w;
        }
    if (text.starts_with(noise_prefix)) {
        w = parse_noise(text.substr(noise_prefix.size()));
        validate(w);
        return w;
    }
    if (!waveform_names_file(text))
        throw error(error_kind::bad_input, "waveform", fmt::format("{} is not known", detail::quoted(text)),
                    "one of sine, square, triangle, sawtooth, noise:LO-HI, FILE.wav")
            .with_field("wave");
    w.kind = waveform_kind::recording;
    w.recorded = std::make_shared<const recording>(load_recording(folder / std::filesystem::path(text)));
    return w;
}

} // namespace v0
} // namespace tactor
