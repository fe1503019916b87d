// SPDX-License-Identifier: MIT
// WAV files as waveforms. The library has no other use for a reader of sound files, and WAV is a list of
// chunks: no package is needed for it.
#include "files/recording.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

static_assert(std::endian::native == std::endian::little, "WAV files are little-endian");

constexpr std::size_t max_file_bytes = std::size_t{64} << 20;
constexpr std::string_view noise_prefix = "noise:";
constexpr std::uint16_t pcm = 1;
constexpr std::uint16_t ieee = 3;
constexpr std::uint16_t extensible = 0xFFFE;

struct wav_format {
    std::uint16_t tag = 0;
    std::uint16_t channels = 0;
    std::uint32_t rate = 0;
    std::uint16_t bits = 0;
};

template <class T>
T get(std::string_view bytes, std::size_t at)
{
    T v{};
    std::memcpy(&v, bytes.data() + at, sizeof v);
    return v;
}

[[noreturn]] void refuse(const std::string& name, std::string_view why,
                         std::string_view hint = "give a WAV file of one channel")
{
    throw error(error_kind::bad_input, source_place{name}, why, hint);
}

wav_format read_format(std::string_view chunk, const std::string& name)
{
    if (chunk.size() < 16)
        refuse(name, "its format chunk is cut off");
    wav_format f{get<std::uint16_t>(chunk, 0), get<std::uint16_t>(chunk, 2), get<std::uint32_t>(chunk, 4),
                 get<std::uint16_t>(chunk, 14)};
    if (f.tag == extensible && chunk.size() >= 26)
        f.tag = get<std::uint16_t>(chunk, 24); // the first bytes of the sub-format are the plain tag
    const bool known = (f.tag == pcm && (f.bits == 8 || f.bits == 16 || f.bits == 24 || f.bits == 32)) ||
                       (f.tag == ieee && (f.bits == 32 || f.bits == 64));
    if (!known)
        refuse(name, fmt::format("its samples are of format {} with {} bits", f.tag, f.bits),
               "give integers of 8, 16, 24 or 32 bits, or floats");
    if (f.channels != 1)
        refuse(name, fmt::format("it has {} channels", f.channels),
               "give one, such as by: sox IN OUT remix 1");
    return f;
}

float sample_at(std::string_view data, std::size_t i, const wav_format& f)
{
    if (f.tag == ieee)
        return f.bits == 32 ? get<float>(data, 4 * i) : static_cast<float>(get<double>(data, 8 * i));
    switch (f.bits) {
    case 8:
        return static_cast<float>(get<std::uint8_t>(data, i) - 128) / 128.0F;
    case 16:
        return static_cast<float>(get<std::int16_t>(data, 2 * i)) / 32768.0F;
    case 24: {
        std::uint32_t v = 0;
        std::memcpy(&v, data.data() + 3 * i, 3);
        return static_cast<float>(static_cast<std::int32_t>(v << 8) >> 8) / 8388608.0F;
    }
    default:
        return static_cast<float>(static_cast<double>(get<std::int32_t>(data, 4 * i)) / 2147483648.0);
    }
}

std::vector<float> read_samples(std::string_view data, const wav_format& f)
{
    std::vector<float> x(std::min(data.size() / (f.bits / 8U), most_recording_samples + 1));
    for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = sample_at(data, i, f);
    return x;
}

recording read_wav(std::string_view bytes, const std::string& name)
{
    const std::string_view kind = bytes.substr(0, 4);
    if (bytes.size() < 12 || (kind != "RIFF" && kind != "RF64") || bytes.substr(8, 4) != "WAVE")
        refuse(name, "it is no WAV file");
    std::optional<wav_format> format;
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
        const std::string_view id = bytes.substr(at, 4);
        const std::size_t said = get<std::uint32_t>(bytes, at + 4);
        // A size of all ones stands elsewhere, and one that was never filled in ends with the file.
        const std::string_view chunk = bytes.substr(at + 8, said);
        if (id == "fmt ")
            format = read_format(chunk, name);
        if (id == "data") {
            if (!format)
                refuse(name, "its samples come before their format");
            return {name, static_cast<double>(format->rate), read_samples(chunk, *format)};
        }
        at += 8 + chunk.size() + chunk.size() % 2;
    }
    refuse(name, "there are no samples in it");
}

waveform noise_of(std::string_view band)
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
    const auto shared = std::make_shared<const recording>(read_wav(bytes, name));
    as_texture.recorded = shared;
    validate(as_texture);
    return *shared;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

recording load_recording(const std::filesystem::path& file)
{
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
    for (const waveform_kind k : values_of<waveform_kind>())
        if (text == to_string(k) && k != waveform_kind::noise && k != waveform_kind::recording) {
            w.kind = k;
            return w;
        }
    if (text.starts_with(noise_prefix)) {
        w = noise_of(text.substr(noise_prefix.size()));
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
