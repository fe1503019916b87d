// SPDX-License-Identifier: MIT
#include "wav/write.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <sndfile.h>

#include <tactor/error.hpp>
#include <tactor/output_file.hpp>

namespace tactor {

namespace wav {

namespace {

/// Between two calls of `progress`: short to wait for, long to write.
constexpr std::size_t block_bytes = std::size_t{1} << 20;
constexpr std::uint64_t most_block_frames = 65536;

int subtype_of(sample_format f)
{
    switch (f) {
    case sample_format::float32:
        return SF_FORMAT_FLOAT;
    case sample_format::s16:
        return SF_FORMAT_PCM_16;
    case sample_format::s24_3:
        return SF_FORMAT_PCM_24;
    case sample_format::s32:
        return SF_FORMAT_PCM_32;
    case sample_format::s24:
        break;
    }
    throw error(errc::bad_input, "--sample-format", fmt::format("a WAV file cannot hold {}", to_string(f)),
                "use float, s16, s24 or s32");
}

output_file& file_of(void* user)
{
    return *static_cast<output_file*>(user);
}

SF_VIRTUAL_IO file_calls()
{
    SF_VIRTUAL_IO io;
    io.get_filelen = [](void* user) -> sf_count_t { return file_of(user).size(); };
    io.seek = [](sf_count_t offset, int whence, void* user) -> sf_count_t {
        return file_of(user).seek(offset, whence);
    };
    io.read = [](void* data, sf_count_t n, void* user) -> sf_count_t { return file_of(user).read(data, n); };
    io.write = [](const void* data, sf_count_t n, void* user) -> sf_count_t {
        return file_of(user).write(data, n);
    };
    io.tell = [](void* user) -> sf_count_t { return file_of(user).seek(0, SEEK_CUR); };
    return io;
}

struct closer {
    void operator()(SNDFILE* f) const noexcept { sf_close(f); }
};
using sound_file = std::unique_ptr<SNDFILE, closer>;

sound_file open(const score& s, sample_format f, container c, output_file& to)
{
    SF_INFO info{};
    info.samplerate = static_cast<int>(s.rate());
    info.channels = static_cast<int>(s.channels());
    info.format = (c == container::rf64 ? SF_FORMAT_RF64 : SF_FORMAT_WAV) | subtype_of(f);
    SF_VIRTUAL_IO io = file_calls();
    sound_file out(sf_open_virtual(&io, SFM_WRITE, &info, &to));
    if (!out) {
        if (to.failure() != 0) {
            to.fail(to.failure());
        }
        throw error(errc::runtime, "WAV file", sf_strerror(nullptr));
    }
    // The PEAK chunk holds the time of day: the same stroke would not give the same bytes.
    sf_command(out.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    return out;
}

/// libsndfile 1.2 writes the PEAK chunk into an RF64 file whether it is wanted or not. Its place is kept as a
/// chunk of junk, which readers skip.
void blank_peak(output_file& f)
{
    constexpr std::uint32_t first_chunk = 12;
    std::array<char, 8> head{};
    for (std::int64_t at = first_chunk; at < static_cast<std::int64_t>(header_bytes);) {
        f.seek(at, SEEK_SET);
        if (f.read(head.data(), head.size()) != static_cast<std::int64_t>(head.size())) {
            return;
        }
        const std::string_view id(head.data(), 4);
        std::uint32_t bytes = 0;
        std::memcpy(&bytes, head.data() + 4, sizeof bytes);
        if (id == "data") {
            return;
        }
        if (id == "PEAK" && bytes < header_bytes) {
            const std::vector<char> zeros(bytes, 0);
            f.seek(at, SEEK_SET);
            f.write("JUNK", 4);
            f.seek(at + static_cast<std::int64_t>(head.size()), SEEK_SET);
            f.write(zeros.data(), bytes);
        }
        at += static_cast<std::int64_t>(head.size()) + bytes + bytes % 2;
    }
}

} // namespace

bool write(const score& s, sample_format f, const std::filesystem::path& file, container c,
           const wav_progress& progress)
{
    subtype_of(f);
    output_file to(file);
    sound_file out = open(s, f, c, to);
    const std::size_t frame_bytes = s.channels() * bytes_of(f);
    const std::uint64_t at_once = std::clamp<std::uint64_t>(block_bytes / frame_bytes, 1, most_block_frames);
    std::vector<std::byte> block(at_once * frame_bytes);
    renderer r(s, f);
    for (std::uint64_t done = 0; done < s.frames();) {
        if (progress && !progress(done, s.frames())) {
            return false;
        }
        const std::uint64_t n = std::min(at_once, s.frames() - done);
        r.process(n, block.data());
        const auto bytes = static_cast<sf_count_t>(n * frame_bytes);
        if (sf_write_raw(out.get(), block.data(), bytes) != bytes || to.failure() != 0) {
            to.fail(to.failure() != 0 ? to.failure() : EIO);
        }
        done += n;
    }
    const int closed = sf_close(out.release());
    if (c == container::rf64) {
        blank_peak(to);
    }
    if (closed != 0 || to.failure() != 0) {
        to.fail(to.failure() != 0 ? to.failure() : EIO);
    }
    if (progress && !progress(s.frames(), s.frames())) {
        return false;
    }
    to.commit();
    return true;
}

} // namespace wav

bool write_wav(const score& s, sample_format f, const std::filesystem::path& file,
               const wav_progress& progress)
{
    return wav::write(s, f, file, wav::container_for(s.frames(), s.channels() * bytes_of(f)), progress);
}

} // namespace tactor
