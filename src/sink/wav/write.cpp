// SPDX-License-Identifier: MIT
#include "sink/wav/write.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include <tactor/error.hpp>

#include "files/output_file.hpp"
#include "sink/wav/header.hpp"

namespace tactor::wav {

namespace {

/// Between two calls of `progress`: short to wait for, long to write.
constexpr std::size_t block_bytes = std::size_t{1} << 20;
constexpr std::uint64_t most_block_frames = 65536;

} // namespace

bool write(const score& s, format_kind f, const std::filesystem::path& file, container c,
           const wav_progress& progress)
{
    const std::string before = header(f, c, s.channels(), s.rate(), s.frames());
    std::uint64_t done = 0;
    const auto go_on = [&] { return !progress || progress(done, s.frames()); };
    detail::output_file to(file, go_on);
    const std::size_t frame_bytes = s.channels() * bytes_of(f);
    const std::uint64_t at_once = std::clamp<std::uint64_t>(block_bytes / frame_bytes, 1, most_block_frames);
    std::vector<std::byte> block(at_once * frame_bytes);
    renderer r(s, f);
    to.write(before.data(), static_cast<std::int64_t>(before.size()));
    while (done < s.frames() && to.good()) {
        if (!go_on())
            return false;
        const std::uint64_t n = std::min(at_once, s.frames() - done);
        r.process(std::span(block).first(n * frame_bytes));
        if (!r.failure().empty())
            throw error(error_kind::bad_input, "stroke", r.failure());
        to.write(block.data(), static_cast<std::int64_t>(n * frame_bytes));
        done += n;
    }
    to.write("", padding(s.frames() * frame_bytes));
    if (to.given_up() || (to.good() && !go_on()))
        return false;
    to.commit();
    return true;
}

} // namespace tactor::wav

namespace tactor {
inline namespace v0 {

bool write_wav(const score& s, format_kind f, const std::filesystem::path& file, const wav_progress& progress)
{
    return wav::write(s, f, file, wav::container_for(s.frames(), s.channels() * bytes_of(f)), progress);
}

} // namespace v0
} // namespace tactor
