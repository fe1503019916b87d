// SPDX-License-Identifier: MIT
// Records of a stream: the program's log, its counters, and drive time, which outlives players and processes.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>
#include <sys/stat.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "amplifier_rig.hpp"
#include "clock_runner.hpp"
#include "engine/control/records.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rt/clock.hpp"
#include "rt/event_fd.hpp"
#include "scores.hpp"

namespace records_test {

using namespace tactor;
using namespace tactor::test;
using engine::drive_levels;
using engine::drive_share;

namespace {

struct heard {
    std::mutex mutex; // a player's lines come from its control thread
    std::vector<std::string> lines;

    log_function function()
    {
        return [this](log_kind k, std::string_view text) {
            const std::lock_guard lock(mutex);
            lines.push_back(std::string(to_string(k)) + " " + std::string(text));
        };
    }
    std::size_t count(std::string_view part)
    {
        const std::lock_guard lock(mutex);
        return static_cast<std::size_t>(std::count_if(
            lines.begin(), lines.end(), [&](const std::string& l) { return l.find(part) != l.npos; }));
    }
};

// A rig whose control side looks after each period.
template <typename Rig>
struct logged : Rig {
    explicit logged(const rig_options& o = {}, const drive_limits& held = {})
        : Rig(o), log(told.function(), this->link, held)
    {
        this->also_control = [this, before = this->also_control] {
            if (before)
                before();
            log.look(this->status(), this->now);
            log.write();
        };
    }
    heard told;
    engine::stream_log log;
};

// Reports n ms for its n-th xrun.
class dry_sink final : public forwarding_sink {
public:
    using forwarding_sink::forwarding_sink;
    std::int64_t xrun_ns() noexcept override { return ++xruns_ * 1'000'000; }

private:
    std::int64_t xruns_ = 0;
};

// Plays all frames at once.
class hasty_sink final : public sink {
public:
    hasty_sink() { ready_.signal(); }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 1; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override
    {
        fds[0] = {.fd = ready_.fd(), .events = POLLIN, .revents = 0};
        return 1;
    }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {io_kind::ok, setup_.buffer_frames, 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const std::size_t n = frames.size() / setup_.frame_bytes();
        written_ += n;
        return {io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        time_ns_ += 1'000'000;
        return {written_, written_, time_ns_, true};
    }
    void drop() noexcept override {}

private:
    stream_setup setup_{
        .name = "hasty", .channels = 9, .rate = rate, .period_frames = 96, .buffer_frames = 288};
    rt::event_fd ready_;
    std::uint64_t written_ = 0;
    std::int64_t time_ns_ = 0;
};

} // namespace

TEST_CASE("an xrun is a line, and so is the restart of the stream")
{
    logged<rig> r;
    r.play(9600);
    CHECK(r.told.count("") == 1); // strokes may sound
    r.xrun();
    CHECK(r.told.count("warning xrun 1: the device ran dry") == 1);
    CHECK(r.told.count("info the stream runs again, started 2 times by now") == 1);
    r.play(9600);
    CHECK(r.told.count("xrun") == 1);
}

TEST_CASE("the reason why a lost device ended the stream is a line, once")
{
    logged<rig> r;
    r.play(960);
    r.dac.disconnect();
    for (int i = 0; i < 10 && !r.loop.over(); ++i)
        r.step();
    r.control();
    REQUIRE(r.feed.stream_over());
    r.log.end(r.feed.end().why);
    r.log.end(r.feed.end().why);
    r.log.write();
    CHECK(r.told.count("error the stream has ended: the device is gone") == 1);
}

TEST_CASE("a muted amplifier is a line")
{
    logged<playing> r;
    CHECK(r.told.count("mute") == 0);
    r.line.is_on = false; // like after its holder's death: beat() shows it
    r.wait(200 * ms);
    r.play(960);
    CHECK(r.told.count("warning the amplifier was muted") == 1);
}

TEST_CASE("limits that act are logged once a second at most")
{
    rig_options o;
    o.loop.guards = synth::make_guards({.power_dbfs = -60.0}, rate);
    logged<rig> r(o, {.power_dbfs = -60.0});
    r.submit(tone(2.5));
    r.play(120'000);
    CHECK(r.told.count("warning the power of all tactors was held at -60 dBFS") == 3);
}

TEST_CASE("a player logs its start and its end, and survives a log that throws")
{
    for (const bool throws : {false, true}) {
        CAPTURE(throws);
        heard told;
        player_options o = patient();
        o.log = [to = told.function(), throws](log_kind k, std::string_view text) {
            to(k, text);
            if (throws)
                throw std::runtime_error("log");
        };
        {
            dac_player p(o);
            CHECK(told.count("info stream on \"null\" runs: 9 channels at 48000 Hz, 3 of 96 frames") == 1);
            const stroke_id id = p.submit(tone(0.1));
            const running_clock clock(p.dac);
            REQUIRE(p.wait(id));
            p.stop();
            CHECK(p.ended()->reason == reason_kind::none);
        }
        CHECK(told.count("info the stream has ended") == 1);
    }
}

TEST_CASE("a live stroke above its level is logged once, at its end")
{
    heard told;
    player_options o = patient();
    o.log = told.function();
    dac_player p(o);
    const running_clock clock(p.dac);
    for (const double intensity : {80.0, 1.0}) {
        live_stroke live = p.begin({.timeout_s = 86400.0});
        live.to(20.0, 20.0, intensity);
        live.to(20.0, 20.0, intensity);
        CHECK(live.counts().held == (intensity > 1.0 ? 2 : 0));
        live.end();
        CHECK(p.wait(live.id())->held_points == live.counts().held);
    }
    p.stop();
    CHECK(told.count("warning live stroke 1: 2 points above intensity 1 sounded as 1") == 1);
    CHECK(told.count("live stroke") == 1);
}

TEST_CASE("the length of each xrun is kept, of many the newest")
{
    rig_options o;
    o.wrap = [](std::unique_ptr<sink> s) { return std::make_unique<dry_sink>(std::move(s)); };
    rig r(o);
    for (unsigned i = 1; i <= 70; ++i) {
        r.play(rate); // more than three in a second end the stream
        r.dac.advance(1 << 20);
        r.step();
        r.control();
        REQUIRE(r.link.count.xruns == i);
        CHECK(r.link.count.xrun_ns[(i - 1) % r.link.count.xrun_ns.size()] == i * 1'000'000);
    }
    CHECK_FALSE(r.loop.over());
}

TEST_CASE("an audio thread that never rests gives up real time, reports it once, and plays on")
{
    std::atomic<bool> fifo{false};
    std::atomic<int> told{0};
    std::string text;
    player_options o = patient();
    o.realtime = true;
    o.log = [&](log_kind kind, std::string_view line) {
        fifo = fifo || line == "the audio thread has real-time priority";
        if (line.find("gave up") == std::string_view::npos)
            return;
        CHECK(kind == log_kind::warning);
        text = line;
        ++told;
        told.notify_all();
    };
    player p(std::make_unique<hasty_sink>(), palm(), o);
    if (fifo)
        told.wait(0);
    else
        MESSAGE("no real-time priority here: checks only that nothing is given up");
    CHECK_FALSE(p.stats().realtime);
    CHECK(p.wait(p.submit(tone(0.01)))->state == state_kind::finished);
    p.stop();
    CHECK(told == (fifo ? 1 : 0));
    if (fifo)
        has(text,
            "the audio thread gave up its real-time priority: it had worked for some 0.1 s without a pause");
}

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

// Allows half a second in an hour: no test takes so long that time itself gives it back.
std::uint64_t count_cuts(const std::string& device, double seconds, player_options o = patient())
{
    o.limits.max_drive_s = 0.5;
    o.limits.window_s = 3600.0;
    stream_setup s{.name = device, .device = device, .channels = 9, .rate = rate};
    player p(std::make_unique<deaf_sink>(s), palm(), o);
    CHECK(p.wait(p.submit(tone(seconds))));
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

} // namespace records_test
