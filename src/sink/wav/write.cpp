// SPDX-License-Identifier: MIT

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/refused.hpp"
#include "core/sha256.hpp"
#include "files/output_file.hpp"
#include "sink/wav/wav.hpp"

namespace tactor::wav {
namespace {

/// Bytes between two calls of `progress`: few enough to react soon, enough to write efficiently.
constexpr std::size_t block_bytes = std::size_t{1} << 20;
constexpr std::uint64_t most_block_frames = 65536;

constexpr std::uint64_t elsewhere = 0xFFFFFFFFU; ///< marks a size that ds64 contains
constexpr unsigned integer_tag = 1;
constexpr unsigned float_tag = 3;

bool is_float(format_kind f)
{
    return f == format_kind::float32;
}

void check_format(format_kind f)
{
    if (f == format_kind::s24_4)
        throw detail::bad_field("sample_format", fmt::format("a WAV file cannot hold {}", to_string(f)),
                                "use float, s16, s24 or s32");
}

/// Returns the bytes of a number, least significant first, on any machine.
std::string number(std::uint64_t value, unsigned bytes)
{
    std::string s;
    for (unsigned i = 0; i < bytes; ++i)
        s += static_cast<char>(value >> (8 * i) & 0xFFU);
    return s;
}

std::string chunk(std::string_view name, const std::string& content)
{
    return std::string(name) + number(content.size(), 4) + content;
}

std::string make_format_chunk(format_kind f, unsigned channels, unsigned rate)
{
    const auto bytes = static_cast<unsigned>(sample_bytes(f));
    const std::uint64_t frame = std::uint64_t{channels} * bytes;
    std::string s = number(is_float(f) ? float_tag : integer_tag, 2) + number(channels, 2) + number(rate, 4) +
                    number(rate * frame, 4) + number(frame, 2) + number(8ULL * bytes, 2);
    if (is_float(f))
        s += number(0, 2); // bytes of extension
    return chunk("fmt ", s);
}

constexpr std::string_view comment_name = "INFOICMT";
constexpr std::uint64_t mark_bytes = 8 + 12 + 72;

/// Returns the chunk with a file's SHA-256. Players skip it; audio editors show it as the comment.
std::string mark(std::string_view digits)
{
    return chunk("LIST", "INFO" + chunk("ICMT", fmt::format("sha256 {}{}", digits, '\0')));
}

/// Renders a file block by block: calls put(data, bytes) with its parts and counts the frames in `done`.
/// Stops when go_on() returns false.
template <class GoOn, class Put>
void render_parts(const score& s, format_kind f, container c, std::uint64_t bytes_after, std::uint64_t& done,
                  GoOn go_on, Put put)
{
    const std::string before = header(f, c, s.channels(), s.rate(), s.frames(), bytes_after);
    const std::size_t frame_bytes = s.channels() * sample_bytes(f);
    const std::uint64_t at_once = std::clamp<std::uint64_t>(block_bytes / frame_bytes, 1, most_block_frames);
    std::vector<std::byte> block(at_once * frame_bytes);
    renderer r(s, f);
    put(before.data(), before.size());
    while (done < s.frames() && go_on()) {
        const std::uint64_t n = std::min(at_once, s.frames() - done);
        r.process(std::span(block).first(n * frame_bytes));
        put(block.data(), n * frame_bytes);
        done += n;
    }
    put("", padding(s.frames() * frame_bytes));
}

container choose_score_container(const score& s, format_kind f)
{
    return choose_container(s.frames(), s.channels() * sample_bytes(f));
}

} // namespace

std::string bytes(const score& s, format_kind f, bool marked)
{
    std::string all;
    all.reserve(s.frames() * s.channels() * sample_bytes(f) + 128);
    std::uint64_t done = 0;
    render_parts(
        s, f, choose_score_container(s, f), marked ? mark_bytes : 0, done, [] { return true; },
        [&](const void* data, std::size_t n) { all.append(static_cast<const char*>(data), n); });
    return marked ? all + mark(detail::sha256_text(all)) : all;
}

bool write(const score& s, format_kind f, const std::filesystem::path& file, container c,
           const wav_progress& progress, bool marked)
{
    std::uint64_t done = 0;
    bool given_up = false;
    detail::sha256_sum sum;
    const auto wanted = [&] { return !progress || progress(done, s.frames()); };
    check_format(f);
    detail::output_file to(file, wanted);
    render_parts(
        s, f, c, marked ? mark_bytes : 0, done, [&] { return to.good() && !(given_up = !wanted()); },
        [&](const void* data, std::size_t n) {
            if (marked)
                sum.add({static_cast<const char*>(data), n});
            to.write(data, static_cast<std::int64_t>(n));
        });
    if (marked && to.good() && !given_up)
        to.write(mark(sum.text()).data(), mark_bytes);
    if (given_up || to.given_up() || (to.good() && !wanted()))
        return false;
    to.commit();
    return true;
}

void check_output(const std::filesystem::path& file, bool force)
{
    const auto is_ours = [](std::string_view, std::string_view end) {
        const std::size_t at = end.find(comment_name);
        return at != end.npos && end.substr(at + comment_name.size()).substr(0, 11).ends_with("sha256 ");
    };
    detail::check_overwrite(file, force, is_ours, mark);
}

bool save(const score& s, format_kind f, const std::filesystem::path& file, bool force,
          const wav_progress& progress)
{
    check_output(file, force);
    return write(s, f, file, choose_score_container(s, f), progress, true);
}

std::string header(format_kind f, container c, unsigned channels, unsigned rate, std::uint64_t frames,
                   std::uint64_t bytes_after)
{
    check_format(f);
    const bool large = c == container::rf64;
    const std::uint64_t data = frames * channels * sample_bytes(f);
    std::string chunks = make_format_chunk(f, channels, rate);
    if (is_float(f))
        chunks += chunk("fact", number(large ? elsewhere : frames, 4));
    constexpr std::uint64_t ds64_bytes = 8 + 28;
    const std::uint64_t riff =
        4 + (large ? ds64_bytes : 0) + chunks.size() + 8 + data + padding(data) + bytes_after;
    std::string s = (large ? "RF64" : "RIFF") + number(large ? elsewhere : riff, 4) + "WAVE";
    if (large)
        s += chunk("ds64", number(riff, 8) + number(data, 8) + number(frames, 8) + number(0, 4));
    return s + chunks + "data" + number(large ? elsewhere : data, 4);
}

} // namespace tactor::wav

namespace tactor {
inline namespace v0 {

bool write_wav(const score& s, format_kind f, const std::filesystem::path& file, const wav_progress& progress)
{
    return wav::write(s, f, file, wav::choose_score_container(s, f), progress);
}

} // namespace v0
} // namespace tactor
