// SPDX-License-Identifier: MIT
// WAV files as waveforms and as the user's own samples, and the names of waveforms.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/waveform.hpp>

#include "core/sha256.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/sound_file.hpp"
#include "files/text_file.hpp"
#include "files/vibration_file.hpp"

namespace tactor::detail {
namespace {

static_assert(std::endian::native == std::endian::little, "WAV files are little-endian");

constexpr std::uint16_t integers = 1;
constexpr std::uint16_t floats = 3;
constexpr std::uint16_t extensible = 0xFFFE;
constexpr std::uint32_t elsewhere = 0xFFFFFFFF; ///< value that means: the size is in the chunk ds64
/// Smallest size in a header that counts as unknown. Recorders that write to a pipe write about 2 GB or 4 GB
/// there, more than a recording may have.
constexpr std::uint32_t open_from = 0x7FF00000;
constexpr std::size_t head_bytes = 8; ///< bytes of a chunk's header

template <class T>
T get(std::string_view bytes, std::size_t at)
{
    T v{};
    std::memcpy(&v, bytes.data() + at, sizeof v);
    return v;
}

/// A valid format chunk.
struct wav_format {
    std::uint16_t tag = 0; ///< 1 for integers, 3 for floats
    std::uint16_t channels = 0;
    std::uint32_t rate = 0;
    std::uint16_t bits = 0; ///< bits of a sample without padding
    std::size_t bytes = 0;  ///< bytes of a sample with padding
};

/// Format and samples of a WAV file. Other chunks may come between them, and the recorder may have left out
/// the sizes.
struct wav_parts {
    wav_format format;
    std::string_view samples;    ///< a part of the file
    std::uint64_t announced = 0; ///< bytes of samples in the header; if none, the existing bytes
};

[[noreturn]] void refuse_wav(const std::string& name, std::string_view why,
                             std::string_view hint = "give a WAV file")
{
    throw error(error_kind::bad_input, source_place{name}, why, hint);
}

wav_format read_format(std::string_view chunk, const std::string& name)
{
    if (chunk.size() < 16)
        refuse_wav(name, "its format chunk is incomplete");
    wav_format f{get<std::uint16_t>(chunk, 0), get<std::uint16_t>(chunk, 2), get<std::uint32_t>(chunk, 4),
                 get<std::uint16_t>(chunk, 14), 0};
    const auto frame_bytes = get<std::uint16_t>(chunk, 12);
    if (f.tag == extensible && chunk.size() >= 26)
        f.tag = get<std::uint16_t>(chunk, 24); // the sub-format begins with the tag of a plain format
    if (f.channels == 0 || f.rate == 0 || frame_bytes % f.channels != 0)
        refuse_wav(name, fmt::format("its frames of {} for {} at {} Hz are impossible",
                                     counted(frame_bytes, "byte"), counted(f.channels, "channel"), f.rate));
    f.bytes = frame_bytes == 0 ? (f.bits + 7U) / 8U : frame_bytes / std::size_t{f.channels};
    const bool known = (f.tag == integers && f.bits >= 1 && f.bits <= 32) ||
                       (f.tag == floats && (f.bits == 32 || f.bits == 64));
    const bool fits = f.bytes == (f.bits + 7U) / 8U || (f.tag == integers && f.bytes == 4);
    if (!known || !fits)
        refuse_wav(name,
                   fmt::format("its samples are of format {} with {} in {}", f.tag, counted(f.bits, "bit"),
                               counted(f.bytes, "byte")),
                   "give integers of 8, 16, 24 or 32 bits, or floats");
    return f;
}

bool is_id(std::string_view bytes, std::size_t at)
{
    const std::string_view id = bytes.substr(std::min(at, bytes.size()), 4);
    return id.size() == 4 && std::all_of(id.begin(), id.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// Returns the offset of the next chunk. A chunk of odd size should be padded with one byte, but some
/// programs omit the byte.
std::size_t find_next_chunk(std::string_view file, std::size_t at, std::size_t size)
{
    const std::size_t end = at + head_bytes + size;
    return size % 2 == 0 || (is_id(file, end) && !is_id(file, end + 1)) ? end : end + 1;
}

/// Returns true if the file has only complete chunks from this offset to its end.
bool has_complete_chunks(std::string_view file, std::size_t at)
{
    while (is_id(file, at) && file.size() - at >= head_bytes) {
        const std::size_t size = get<std::uint32_t>(file, at + 4);
        if (size > file.size() - at - head_bytes)
            return false;
        at = find_next_chunk(file, at, size);
    }
    return at >= file.size();
}

/// Returns the number of bytes of samples according to the header, or nothing if the header has no size.
std::optional<std::uint64_t> announced_bytes(std::string_view file, std::size_t at,
                                             std::optional<std::uint64_t> long_size)
{
    const auto size = get<std::uint32_t>(file, at + 4);
    if (size == elsewhere && long_size)
        return *long_size == 0 ? std::nullopt : long_size;
    if (size == 0 && !has_complete_chunks(file, at + head_bytes))
        return std::nullopt;
    return size >= open_from ? std::nullopt : std::optional<std::uint64_t>(size);
}

/// Returns true if the 24 bits of a sample are the upper three of four bytes (the format of Microsoft). ALSA
/// (S24_LE), and programs that record with it, use the lower three bytes. Their fourth byte is a sign
/// extension, zero or any value.
bool is_in_upper_bytes(std::string_view samples)
{
    bool signs_only = true;
    for (std::size_t i = 0; i + 4 <= samples.size(); i += 4) {
        const bool negative = (static_cast<unsigned char>(samples[i + 2]) & 0x80U) != 0;
        if (samples[i] != '\0')
            return false;
        signs_only = signs_only && (samples[i + 3] == '\0' || (negative && samples[i + 3] == '\xFF'));
    }
    return !signs_only;
}

/// Converts an integer sample of `bytes` bytes to a fraction of full scale.
float decode_integer(std::string_view sample, std::size_t bytes)
{
    if (bytes == 1)
        return (static_cast<float>(get<std::uint8_t>(sample, 0)) - 128.0F) / 128.0F;
    std::array<char, 4> upper{};
    std::copy_n(sample.begin(), bytes, upper.end() - static_cast<std::ptrdiff_t>(bytes));
    return static_cast<float>(std::bit_cast<std::int32_t>(upper)) * 0x1p-31F;
}

/// Returns true for samples of 24 bits or less in the lower three of four bytes.
bool is_in_lower_bytes(const wav_format& f, std::string_view samples)
{
    return f.tag == integers && f.bytes == 4 && f.bits <= 24 && !is_in_upper_bytes(samples);
}

/// Returns the first `most` samples. Integers are converted to fractions of full scale.
std::vector<float> decode_wav(const wav_parts& parts, std::size_t most)
{
    const wav_format& f = parts.format;
    const std::string_view samples = parts.samples.substr(0, most * f.bytes);
    const bool is_lower = is_in_lower_bytes(f, samples);
    std::vector<float> x;
    x.reserve(samples.size() / f.bytes);
    for (std::size_t at = 0; at + f.bytes <= samples.size(); at += f.bytes) {
        const std::string_view one = samples.substr(at, f.bytes);
        x.push_back(f.tag == integers ? decode_integer(one, is_lower ? 3 : f.bytes)
                    : f.bits == 32    ? get<float>(one, 0)
                                      : static_cast<float>(get<double>(one, 0)));
    }
    return x;
}

wav_parts find_wav_parts(std::string_view file, const std::string& name)
{
    const std::string_view kind = file.substr(0, 4);
    if (file.size() < 12 || (kind != "RIFF" && kind != "RF64" && kind != "BW64") ||
        file.substr(8, 4) != "WAVE")
        refuse_wav(name, "it is not a WAV file");
    std::optional<wav_format> format;
    std::optional<std::uint64_t> long_size;
    for (std::size_t at = 12; at + head_bytes <= file.size();) {
        const std::string_view id = file.substr(at, 4);
        const std::string_view chunk = file.substr(at + head_bytes, get<std::uint32_t>(file, at + 4));
        if (id == "ds64" && chunk.size() >= 16)
            long_size = get<std::uint64_t>(chunk, 8);
        if (id == "fmt ")
            format = read_format(chunk, name);
        if (id == "data") {
            if (!format)
                refuse_wav(name, "its samples come before their format");
            const auto announced = announced_bytes(file, at, long_size);
            const std::string_view rest = file.substr(at + head_bytes);
            const std::string_view samples = rest.substr(0, announced.value_or(rest.size()));
            return {*format, samples, announced.value_or(samples.size())};
        }
        at = find_next_chunk(file, at, chunk.size());
    }
    refuse_wav(name, "it has no samples");
}

} // namespace

own_samples parse_samples(std::string_view bytes, const std::string& name)
{
    const wav_parts parts = find_wav_parts(bytes, name);
    const wav_format& f = parts.format;
    const std::size_t frame_bytes = f.channels * f.bytes;
    const std::uint64_t announced = parts.announced / frame_bytes;
    const std::size_t frames = parts.samples.size() / frame_bytes;
    if (frames < announced)
        refuse_wav(name,
                   fmt::format("it is cut short: {} of {} are there", frames, counted(announced, "frame")),
                   "write it again");
    own_samples s{.file = name, .rate = f.rate, .channels = f.channels};
    const auto take = [&s](std::span<const std::byte> all) { s.bytes.assign(all.begin(), all.end()); };
    if (f.bytes == 1 || f.bytes == 8) { // floats can represent 8-bit integers, too
        const std::vector<float> decoded = decode_wav(parts, frames * f.channels);
        take(std::as_bytes(std::span(decoded)));
        return s;
    }
    const bool is_lower = is_in_lower_bytes(f, parts.samples);
    s.format = f.tag == floats ? format_kind::float32
               : f.bytes == 2  ? format_kind::s16
               : f.bytes == 3  ? format_kind::s24_3
               : is_lower      ? format_kind::s24_4
                               : format_kind::s32;
    take(std::as_bytes(std::span(parts.samples.substr(0, frames * frame_bytes))));
    return s;
}

recording parse_recording(std::string_view bytes, const std::string& name)
{
    waveform as_texture;
    as_texture.kind = waveform_kind::recording;
    as_texture.texture = texture_kind::time;
    const wav_parts parts = find_wav_parts(bytes, name);
    if (parts.format.channels != 1)
        refuse_wav(name, fmt::format("it has {} channels", parts.format.channels),
                   "keep one: sox IN OUT remix 1");
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
            .with_field("waveform");
    w.low_hz = *low;
    w.high_hz = *high;
    return w;
}

/// Refuses a named pipe, because waiting for its other end could block without a message. Accepts a pipe of
/// the shell, <(...), which already has another end.
void refuse_pipe(const std::filesystem::path& file)
{
    std::error_code unknown;
    if (std::filesystem::is_fifo(file, unknown) &&
        std::filesystem::exists(std::filesystem::canonical(file, unknown)))
        throw error(error_kind::bad_input, source_place{file.string()}, "it is a pipe",
                    "name a WAV file: tactor reads it several times");
}

} // namespace

own_samples load_samples(const std::filesystem::path& file)
{
    refuse_pipe(file);
    constexpr std::size_t most_bytes = most_own_bytes + (std::size_t{1} << 16); // space for other chunks
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(file, unknown);
    if (!unknown && size > most_bytes)
        throw error(error_kind::bad_input, source_place{file.string()}, too_large_text(size),
                    "cut the file into pieces: sox IN OUT trim 0 600");
    const detail::whole_text bytes = detail::read_text_file(file, most_bytes);
    return detail::parse_samples(bytes, file.string());
}

recording load_recording(const std::filesystem::path& file)
{
    refuse_pipe(file);
    if (detail::is_vibration_file(file))
        return detail::load_vibration(file);
    const detail::whole_text bytes = detail::read_text_file(file, max_file_bytes);
    return detail::parse_recording(bytes, file.string());
}

bool waveform_names_file(std::string_view text) noexcept
{
    // A word without a dot and without a slash is a mistyped name of a waveform.
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
        throw error(
            error_kind::bad_input, "waveform", fmt::format("{} is unknown", detail::quoted(text)),
            "use one of sine, square, triangle, sawtooth, noise:LO-HI, FILE.wav, FILE.haptic, FILE.ahap")
            .with_field("waveform");
    w.kind = waveform_kind::recording;
    w.recorded = std::make_shared<const recording>(load_recording(folder / std::filesystem::path(text)));
    return w;
}

} // namespace v0
} // namespace tactor
