// SPDX-License-Identifier: MIT
// Drive time of a device: it outlives players and processes.
#include "engine/control/records.hpp"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "folder.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"

namespace drive_book_test {

using namespace tactor;
using namespace tactor::test;
using engine::drive_levels;
using engine::drive_share;

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double rate_hz = 1000.0;

std::int64_t at(double s)
{
    return static_cast<std::int64_t>(s * 1e9);
}

/// XDG_RUNTIME_DIR for a test.
class runtime {
public:
    explicit runtime(const std::string& path)
    {
        ::unsetenv("RUNTIME_DIRECTORY");
        if (path.empty())
            ::unsetenv("XDG_RUNTIME_DIR");
        else
            ::setenv("XDG_RUNTIME_DIR", path.c_str(), 1);
    }
    ~runtime() { ::unsetenv("XDG_RUNTIME_DIR"); }
    runtime(const runtime&) = delete;
    runtime& operator=(const runtime&) = delete;
};

// A process that drives a channel. Times in s.
struct driver {
    drive_share share = {};
    std::uint64_t frames = 0;

    void enter(drive_levels& l, double driven_s, double ahead_s, double now_s, double leak = 1.0)
    {
        frames += static_cast<std::uint64_t>(driven_s * rate_hz);
        const std::uint64_t all[] = {frames};
        share.enter(l, all, rate_hz, leak, ahead_s, at(now_s));
    }
};

double level(const drive_levels& l, double now_s, double limit_s = unlimited, double leak = 1.0)
{
    return l.after_rest(at(now_s), limit_s, leak).at(0);
}

// A sink of a device, in memory.
class device_sink final : public paced_sink {
public:
    explicit device_sink(const std::string& device) : paced_sink(named(device)) {}

private:
    static stream_setup named(const std::string& device)
    {
        stream_setup s;
        s.name = s.device = device;
        s.channels = 9;
        s.rate = rate;
        return s;
    }
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }
};

// Allows half a second in an hour: no test takes so long that time itself gives it back.
std::uint64_t count_cuts(const std::string& device, double seconds, player_options o = patient())
{
    o.limits.max_drive_s = 0.5;
    o.limits.window_s = 3600.0;
    player p(std::make_unique<device_sink>(device), palm(), o);
    p.wait(p.submit(tone(seconds)));
    p.stop();
    return p.stats().drives_cut;
}

} // namespace

TEST_CASE("levels go through a text; one that is not whole counts as none")
{
    const drive_levels l{{0.0, 1.25, 3600.0}, 77};
    const std::string text = l.text();
    const drive_levels again = drive_levels::read(text);
    CHECK(again.levels_s == l.levels_s);
    CHECK(again.at_ns == 77);
    CHECK(drive_levels::read(drive_levels().text()).levels_s.empty());
    CHECK(text.size() == drive_levels{{1e5, 0.5, 12.0}, std::int64_t{1} << 62}.text().size());
    for (std::size_t n = 0; n < text.size(); ++n) {
        CAPTURE(n);
        CHECK(drive_levels::read(text.substr(0, n)).levels_s.empty());
    }
    for (const auto& [what, by] : {std::pair("1.25", "-1.25"),
                                   {"1.25", "nan"},
                                   {"1.25", "inf"},
                                   {"000000001.250000", ""},
                                   {"77", "7.7"},
                                   {"tactor-drive-time 1", "tactor-drive-time 2"}}) {
        std::string other = text;
        other.replace(other.find(what), std::string_view(what).size(), by);
        CAPTURE(other);
        CHECK(drive_levels::read(other).levels_s.empty());
    }
}

TEST_CASE("who reads levels lets them leak by their age, from his own limit on")
{
    const drive_levels l{{1.0, 400.0}, at(100.0)};
    const auto after = [&](double now_s, double limit_s, double leak, double one, double other) {
        const std::vector<double> levels = l.after_rest(at(now_s), limit_s, leak);
        REQUIRE(levels.size() == 2);
        CHECK(levels[0] == doctest::Approx(one));
        CHECK(levels[1] == doctest::Approx(other));
    };
    after(100.4, 5.0, 1.0, 0.6, 4.6);
    after(100.4, 5.0, 2.0, 0.2, 4.2);
    after(110.0, 5.0, 1.0, 0.0, 0.0);
    after(110.0, unlimited, 1.0, 0.0, 390.0);
    after(99.6, 5.0, 1.0, 1.0, 5.0);                 // somebody drives them
    CHECK(l.after_rest(at(98.0), 5.0, 1.0).empty()); // before this machine last started
}

TEST_CASE("what was driven is added, and what was added beforehand is taken back")
{
    drive_levels l;
    driver one;
    one.enter(l, 0.0, 0.5, 10.0); // it begins
    CHECK(level(l, 10.0) == doctest::Approx(0.5));
    one.enter(l, 0.25, 0.5, 10.25);
    one.enter(l, 0.25, 0.5, 10.5);
    CHECK(level(l, 10.5) == doctest::Approx(1.0)); // killed now: 0.5 s too much
    one.enter(l, 0.25, 0.0, 10.75);
    CHECK(level(l, 10.75) == doctest::Approx(0.75));
    CHECK(level(l, 11.25) == doctest::Approx(0.25));
    one.enter(l, 0.5, 0.0, 12.25); // 1 s of rest before
    CHECK(level(l, 12.25) == doctest::Approx(0.5));
    one.enter(l, 0.1, 0.0, 5.0); // this machine started anew
    CHECK(level(l, 5.0) == doctest::Approx(0.1));
}

TEST_CASE("drive time does not grow by being written, whatever the leak is")
{
    for (const double leak : {0.1, 1.0, 9.0}) {
        drive_levels l;
        driver one;
        for (int i = 0; i < 4000; ++i)
            one.enter(l, i % 4 == 0 ? 0.25 : 0.0, 0.5, 10.0 + 0.25 * i, leak);
        one.enter(l, 0.0, 0.0, 1010.0, leak);
        CAPTURE(leak);
        CHECK(level(l, 1010.0) <= (leak < 0.3 ? 250.0 - 750.0 * leak + 1.0 : 0.25));
        CHECK(level(l, 1010.0) >= (leak < 0.3 ? 250.0 - 750.0 * leak - 1.0 : 0.0));
    }
}

TEST_CASE("two processes on one device each add what they drive")
{
    drive_levels l;
    driver one;
    driver other;
    for (int i = 0; i < 40; ++i) { // one drives all the time, the other at times
        one.enter(l, i == 0 ? 0.0 : 0.25, 0.5, 10.0 + 0.25 * i);
        other.enter(l, i % 2 == 0 ? 0.0 : 0.1, 0.5, 10.1 + 0.25 * i);
    }
    one.enter(l, 0.25, 0.0, 20.0);
    other.enter(l, 0.0, 0.0, 20.0);
    CHECK(level(l, 20.0) >= 12.0 - 0.25);
    CHECK(level(l, 20.0) <= 12.0 + 0.75);
}

TEST_CASE("players one after the other on a device count together")
{
    const folder here;
    const runtime r(here.path());
    CHECK(count_cuts("a", 0.3) == 0);
    CHECK(count_cuts("b", 0.3) == 0);
    CHECK(count_cuts("", 0.3) == 0); // no device
    CHECK(count_cuts("", 0.3) == 0);
    player_options declines = patient();
    declines.keep_drive_time = false;
    CHECK(count_cuts("a", 0.3, declines) == 0);
    CHECK(count_cuts("a", 0.3) == 1);
    CHECK(std::filesystem::exists(here / "tactor/drive-time-a"));
    struct stat s = {};
    REQUIRE(::stat((here / "tactor/drive-time-a").c_str(), &s) == 0);
    CHECK((s.st_mode & 0777U) == 0600);
    CHECK(std::distance(std::filesystem::directory_iterator(here / "tactor"), {}) == 2);
}

TEST_CASE("what another process drove counts, and what it may have driven before it was killed")
{
    const folder here;
    const runtime r(here.path());
    const drive_levels theirs{std::vector<double>(9, 0.4), rt::boottime_ns()};
    here.write("tactor/drive-time-of%20others", theirs.text());
    std::filesystem::permissions(here / "tactor", std::filesystem::perms::owner_all);
    CHECK(count_cuts("of others", 0.05) == 0);
    CHECK(count_cuts("of others", 0.2) == 1);
}

TEST_CASE("without a folder of one's own players of a process count together, and it is said why")
{
    const folder here;
    {
        const runtime r("");
        CHECK(drive_time_fault("c") == "there is no runtime folder (XDG_RUNTIME_DIR)");
        CHECK(count_cuts("c", 0.3) == 0);
        CHECK(count_cuts("c", 0.3) == 1);
    }
    const runtime r(here.path());
    CHECK(drive_time_fault("d") == "");
    here.write("tactor/drive-time-d/x");
    CHECK(drive_time_fault("d") == (here / "tactor/drive-time-d").string() + " cannot be written");
    CHECK(count_cuts("d", 0.3) == 0);
    CHECK(count_cuts("d", 0.3) == 1);
    std::filesystem::permissions(here / "tactor", std::filesystem::perms::all);
    CHECK(drive_time_fault("d") == (here / "tactor").string() + " is not a folder of this user alone");
    std::filesystem::remove_all(here / "tactor");
    std::filesystem::create_directory_symlink("/tmp", here / "tactor");
    CHECK(drive_time_fault("d") == (here / "tactor").string() + " is not a folder of this user alone");
    const runtime gone((here / "nowhere").string());
    CHECK(drive_time_fault("d") == (here / "nowhere").string() + " is not a folder of this user");
}

TEST_CASE("a device's name becomes one file name")
{
    const folder here;
    const runtime r(here.path());
    CHECK(count_cuts("hw:CARD=a/../b", 0.01) == 0);
    CHECK(std::filesystem::exists(here / "tactor/drive-time-hw%3ACARD%3Da%2F..%2Fb"));
    CHECK(count_cuts(std::string(5000, 'x'), 0.01) == 0);
    CHECK(std::filesystem::exists(here / ("tactor/drive-time-" + std::string(200, 'x'))));
}

} // namespace drive_book_test
