// SPDX-License-Identifier: MIT
#include "sink/wav/wav.hpp"

#include <algorithm>
#include <fstream>
#include <string>

#include <sndfile.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "../../synth/pieces.hpp"
#include "core/sha256.hpp"
#include "folder.hpp"

namespace write_test {

using namespace tactor;
using namespace pieces;
namespace fs = std::filesystem;

namespace {

score make_score(double seconds = 0.3, unsigned rate = 48000)
{
    std::mt19937_64 random(17);
    render_options o{.rate = rate, .level_dbfs = -20.0, .channels = 5};
    return {row(4), {{make_random(random, 4, 20, seconds), {}}}, o};
}

struct read_file {
    SF_INFO info{};
    std::vector<std::byte> raw;
};

read_file read_back(const fs::path& p)
{
    read_file r;
    SNDFILE* f = sf_open(p.c_str(), SFM_READ, &r.info);
    REQUIRE(f != nullptr);
    const int kind = r.info.format & SF_FORMAT_SUBMASK;
    const std::size_t bytes = kind == SF_FORMAT_PCM_16 ? 2 : (kind == SF_FORMAT_PCM_24 ? 3 : 4);
    r.raw.resize(static_cast<std::size_t>(r.info.frames) * static_cast<std::size_t>(r.info.channels) * bytes);
    CHECK(sf_read_raw(f, r.raw.data(), static_cast<sf_count_t>(r.raw.size())) ==
          static_cast<sf_count_t>(r.raw.size()));
    sf_close(f);
    return r;
}

/// Restores the greatest size of a file, and the effect of exceeding it.
class file_size_limit {
public:
    explicit file_size_limit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN))
    {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &now);
    }
    ~file_size_limit()
    {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    file_size_limit(const file_size_limit&) = delete;
    file_size_limit& operator=(const file_size_limit&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

error_kind refusal_kind(const fs::path& p, format_kind f = format_kind::s16)
{
    try {
        write_wav(make_score(), f, p);
    } catch (const error& e) {
        return e.kind();
    }
    FAIL("nothing was thrown");
    return error_kind::runtime;
}

} // namespace

TEST_CASE("a WAV file holds the renderer's bytes, its rate and its channels")
{
    const folder dir;
    const int kinds[] = {SF_FORMAT_FLOAT, SF_FORMAT_PCM_16, SF_FORMAT_PCM_24, SF_FORMAT_PCM_32};
    const format_kind formats[] = {format_kind::float32, format_kind::s16, format_kind::s24_3,
                                   format_kind::s32};
    for (std::size_t i = 0; i < 4; ++i) {
        const score s = make_score(0.3, 44100);
        CHECK(write_wav(s, formats[i], dir / "a.wav"));
        const read_file r = read_back(dir / "a.wav");
        CHECK(r.info.format == (SF_FORMAT_WAV | kinds[i]));
        CHECK(r.info.samplerate == 44100);
        CHECK(r.info.channels == 5);
        CHECK(static_cast<std::uint64_t>(r.info.frames) == s.frames());
        CHECK((r.raw == render(s, formats[i])));
    }
    CHECK(dir.names() == std::vector<std::string>{"a.wav"});
}

TEST_CASE("the same score gives the same file, whatever was there before")
{
    const folder dir;
    for (const format_kind f : {format_kind::float32, format_kind::s24_3}) {
        write_wav(make_score(), f, dir / "a.wav");
        std::ofstream(dir / "b.wav") << std::string(1000000, 'x');
        write_wav(make_score(), f, dir / "b.wav");
        CHECK((dir.bytes("a.wav") == dir.bytes("b.wav")));
        CHECK((dir.bytes("a.wav") == wav::bytes(make_score(), f)));
    }
}

TEST_CASE("a marked file has its hash in a comment after the same samples")
{
    const folder dir;
    const score s = make_score();
    for (const format_kind f : {format_kind::float32, format_kind::s24_3})
        for (const wav::container c : {wav::container::wave, wav::container::rf64}) {
            CHECK(wav::write(s, f, dir / "a.wav", c, {}, true));
            const std::string bytes = dir.bytes("a.wav");
            const std::string without = bytes.substr(0, bytes.size() - 92);
            SNDFILE* file = nullptr;
            SF_INFO info{};
            REQUIRE((file = sf_open((dir / "a.wav").c_str(), SFM_READ, &info)) != nullptr);
            if (c == wav::container::wave) // libsndfile reads no comment of an RF64 file
                CHECK(sf_get_string(file, SF_STR_COMMENT) == "sha256 " + detail::sha256_text(without));
            sf_close(file);
            CHECK(bytes.find("sha256 " + detail::sha256_text(without)) == without.size() + 20);
            CHECK((read_back(dir / "a.wav").raw == render(s, f)));
            CHECK_NOTHROW(wav::check_output(dir / "a.wav", false));
        }
    CHECK(wav::save(s, format_kind::s16, dir / "a.wav", false, {}));
    write_wav(s, format_kind::s16, dir / "a.wav");
    CHECK_THROWS_WITH_AS(wav::save(s, format_kind::s16, dir / "a.wav", false, {}),
                         doctest::Contains("tactor did not write it"), error);
    CHECK(wav::save(s, format_kind::s16, dir / "a.wav", true, {}));
    dir.write("a.wav", dir.bytes("a.wav").replace(100, 2, "!!"));
    CHECK_THROWS_WITH_AS(wav::save(s, format_kind::s16, dir / "a.wav", false, {}),
                         doctest::Contains("somebody changed it"), error);
}

TEST_CASE("a score without frames is a file without frames")
{
    const folder dir;
    CHECK(write_wav(score(row(2), {}, {}), format_kind::s16, dir / "a.wav"));
    CHECK(read_back(dir / "a.wav").info.frames == 0);
}

TEST_CASE("RF64 is used where 32 bits are too few")
{
    using wav::container;
    CHECK(wav::choose_container(0, 36) == container::wave);
    CHECK(wav::choose_container(48000, 36) == container::wave);
    CHECK(wav::choose_container(119304647, 36) == container::rf64);
    CHECK(wav::choose_container((0xFFFFFFFFU - 4096U) / 36U, 36) == container::wave);
    CHECK(wav::choose_container((0xFFFFFFFFU - 4096U) / 36U + 1U, 36) == container::rf64);
    CHECK(wav::choose_container(~std::uint64_t{0}, 4096) == container::rf64);
    const folder dir;
    const score s = make_score();
    for (const format_kind f : {format_kind::float32, format_kind::s24_3}) {
        CHECK(wav::write(s, f, dir / "a.wav", container::rf64, {}));
        const std::string bytes = dir.bytes("a.wav");
        CHECK(bytes.substr(0, 4) == "RF64");
        // A PEAK chunk would hold the time of day.
        CHECK(bytes.substr(0, 400).find("PEAK") == std::string::npos);
        const read_file r = read_back(dir / "a.wav");
        CHECK((r.info.format & SF_FORMAT_TYPEMASK) == SF_FORMAT_RF64);
        CHECK(static_cast<std::uint64_t>(r.info.frames) == s.frames());
        CHECK((r.raw == render(s, f)));
    }
}

TEST_CASE("progress comes in order and ends with everything")
{
    const folder dir;
    const score s = make_score(8.0);
    std::vector<std::uint64_t> calls;
    CHECK(write_wav(s, format_kind::float32, dir / "a.wav", [&](std::uint64_t done, std::uint64_t all) {
        CHECK(all == s.frames());
        calls.push_back(done);
        return true;
    }));
    CHECK(calls.size() > 3);
    CHECK(calls.front() == 0);
    CHECK(calls.back() == s.frames());
    CHECK(std::is_sorted(calls.begin(), calls.end()));
}

TEST_CASE("giving up leaves nothing behind and an old file as it was")
{
    const folder dir;
    const score s = make_score(8.0);
    std::ofstream(dir / "old.wav") << "old";
    for (int after = 0; after < 3; ++after) {
        for (const char* name : {"old.wav", "new.wav"}) {
            int calls = 0;
            CHECK_FALSE(write_wav(s, format_kind::float32, dir / name,
                                  [&](std::uint64_t, std::uint64_t) { return calls++ != after; }));
        }
    }
    CHECK(dir.names() == std::vector<std::string>{"old.wav"});
    CHECK(dir.bytes("old.wav") == "old");
    CHECK_THROWS_AS(write_wav(s, format_kind::float32, dir / "old.wav",
                              [](std::uint64_t, std::uint64_t) -> bool { throw std::bad_alloc(); }),
                    std::bad_alloc);
    CHECK(dir.names() == std::vector<std::string>{"old.wav"});
}

TEST_CASE("the file's name shows nothing before it is complete")
{
    const folder dir;
    const score s = make_score(8.0);
    write_wav(s, format_kind::float32, dir / "a.wav", [&](std::uint64_t, std::uint64_t) {
        CHECK_FALSE(fs::exists(dir / "a.wav"));
        CHECK(dir.names().size() == 1);
        return true;
    });
    CHECK(fs::exists(dir / "a.wav"));
}

TEST_CASE("names that cannot be a file are bad input")
{
    const folder dir;
    CHECK(refusal_kind("") == error_kind::bad_input);
    CHECK(refusal_kind(dir / "") == error_kind::bad_input);
    CHECK(refusal_kind(dir / "missing/a.wav") == error_kind::bad_input);
    fs::create_directory(dir / "sub");
    CHECK(refusal_kind(dir / "sub") == error_kind::bad_input);
    std::ofstream(dir / "plain") << "x";
    CHECK(refusal_kind(dir / "plain/a.wav") == error_kind::bad_input);
    CHECK(refusal_kind(dir / "a.wav", format_kind::s24_4) == error_kind::bad_input);
    CHECK(dir.names() == std::vector<std::string>{"plain", "sub"});
}

TEST_CASE("a full disk is a failure at run time that leaves nothing")
{
    const folder dir;
    std::ofstream(dir / "old.wav") << "old";
    for (const rlim_t limit : {rlim_t{0}, rlim_t{20}, rlim_t{4096}, rlim_t{100000}}) {
        const file_size_limit small(limit);
        CHECK(refusal_kind(dir / "a.wav") == error_kind::runtime);
        CHECK(refusal_kind(dir / "old.wav") == error_kind::runtime);
    }
    CHECK(dir.names() == std::vector<std::string>{"old.wav"});
    CHECK(dir.bytes("old.wav") == "old");
    if (fs::exists("/dev/full")) {
        CHECK(refusal_kind("/dev/full") == error_kind::runtime);
        CHECK(fs::is_character_file("/dev/full"));
    }
}

TEST_CASE("a forbidden write is a failure at run time")
{
    if (::geteuid() == 0)
        return;
    const folder dir;
    std::ofstream(dir / "old.wav") << "old";
    fs::permissions(dir / "old.wav", fs::perms::owner_read);
    CHECK(refusal_kind(dir / "old.wav") == error_kind::runtime);
    fs::create_directory(dir / "sub");
    fs::permissions(dir / "sub", fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(refusal_kind(dir / "sub/a.wav") == error_kind::runtime);
    fs::permissions(dir / "sub", fs::perms::owner_all);
}

TEST_CASE("the longest name works")
{
    const folder dir;
    const std::string longest(255, 'x');
    CHECK(write_wav(make_score(), format_kind::s16, dir / longest));
    CHECK(fs::is_regular_file(dir / longest));
}

} // namespace write_test
