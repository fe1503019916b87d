// SPDX-License-Identifier: MIT
// Drive time, which outlives players and processes, and counts together with that of others.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "core/owned.hpp"
#include "engine/control/records.hpp"
#include "folder.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"

namespace drive_book_test {

using namespace tactor;
using namespace tactor::test;
using engine::drive_law;
using engine::drive_levels;
using engine::drive_share;

namespace {

constexpr double unlimited = 3600.0;

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
    drive_law law = {.limit_s = unlimited, .leak = 1.0};

    explicit driver(std::int64_t name = 1) { share.name = name; }
    /// Returns the level to which others have driven the channel; 0: they have not.
    double enter(drive_levels& l, double drive_s, bool goes_on, double now_s)
    {
        return share.enter(l, std::vector{drive_s}, law, goes_on, at(now_s)).at(0);
    }
};

double level(drive_levels l, double now_s, const drive_law& law = {.limit_s = unlimited, .leak = 1.0})
{
    l.advance(at(now_s), law);
    l.add({}, at(now_s), law);
    return l.levels_s.at(0);
}

// Name of this start of the machine, as the kernel has it.
std::string boot_id()
{
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    return id;
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

TEST_CASE("levels go through a text; one that is cut, foreign or of a time to come is none")
{
    const drive_levels l{.levels_s = {0.0, 1.25, 3600.0}, .at_ns = 77, .runs = {{5, 88}, {6, 99}}};
    const std::string text = l.text("b");
    const auto again = drive_levels::read(text, "b", 100);
    REQUIRE(again);
    CHECK(again->levels_s == l.levels_s);
    CHECK(again->at_ns == 77);
    REQUIRE(again->runs.size() == 2);
    CHECK(again->runs[1].name == 6);
    CHECK(again->runs[1].until_ns == 99);
    CHECK(drive_levels::read(text + "level 9\nend\n", "b", 100)->levels_s == l.levels_s); // of a longer one
    CHECK(drive_levels::read(drive_levels().text("b"), "b", 0)->levels_s.empty());
    for (std::size_t n = 0; n < text.size(); ++n) {
        CAPTURE(n);
        CHECK_FALSE(drive_levels::read(text.substr(0, n), "b", 100));
    }
    CHECK_FALSE(drive_levels::read(text, "b", 76));
    CHECK(drive_levels::read(text, "another start", 76)->levels_s.empty());
    for (const auto& [what, by] : {std::pair("1.25", "-1.25"),
                                   {"1.25", "nan"},
                                   {"1.25", "inf"},
                                   {"level 1.250000", "level"},
                                   {"level 1.250000", ""},
                                   {"77", "7.7"},
                                   {"run 5 88", "run 5"},
                                   {"run 5 88", "run 5 9999999999"},
                                   {"tactor-drive-time 2", "tactor-drive-time 1"}}) {
        std::string other = text;
        other.replace(other.find(what), std::string_view(what).size(), by);
        CAPTURE(other);
        CHECK_FALSE(drive_levels::read(other, "b", 100));
    }
}

TEST_CASE("who reads levels lets them leak by their age, from his own limit on")
{
    const auto after = [](double now_s, double limit_s, double leak, double one, double other) {
        drive_levels l{.levels_s = {1.0, 400.0}, .at_ns = at(100.0)};
        l.add({}, at(now_s), {.limit_s = limit_s, .leak = leak});
        REQUIRE(l.levels_s.size() == 2);
        CHECK(l.levels_s[0] == doctest::Approx(one));
        CHECK(l.levels_s[1] == doctest::Approx(other));
    };
    after(100.4, 5.0, 1.0, 0.6, 4.6);
    after(100.4, 5.0, 2.0, 0.2, 4.2);
    after(110.0, 5.0, 1.0, 0.0, 0.0);
    after(110.0, unlimited, 1.0, 0.0, 390.0);
}

TEST_CASE("what was driven is added, never above the limit; a run that was killed counts half a second more")
{
    drive_levels l;
    driver one;
    one.enter(l, 0.0, true, 10.0); // it begins
    CHECK(level(l, 10.0) == doctest::Approx(0.0));
    one.enter(l, 0.25, true, 10.25);
    one.enter(l, 0.25, true, 10.5);
    CHECK(level(l, 10.5) == doctest::Approx(0.5));
    CHECK(level(l, 11.0) == doctest::Approx(1.0)); // killed at 10.5: it counts until 11
    CHECK(level(l, 11.5) == doctest::Approx(0.5));
    one.enter(l, 0.25, false, 10.75);
    CHECK(level(l, 10.75) == doctest::Approx(0.75)); // ended in order
    CHECK(level(l, 11.25) == doctest::Approx(0.25));
    one.enter(l, 0.5, false, 12.25); // 1 s of rest before
    CHECK(level(l, 12.25) == doctest::Approx(0.5));
    one.law.limit_s = 5.0;
    one.enter(l, 7.0, false, 19.25);
    CHECK(l.levels_s[0] == 5.0);
}

TEST_CASE("drive time does not grow by being written, whatever the leak is")
{
    for (const double leak : {0.1, 1.0, 9.0}) {
        drive_levels l;
        driver one;
        one.law.leak = leak;
        for (int i = 0; i < 4000; ++i)
            CHECK(one.enter(l, i % 4 == 0 ? 0.25 : 0.0, true, 10.0 + 0.25 * i) == 0.0); // nobody else drives
        one.enter(l, 0.0, false, 1010.0);
        CAPTURE(leak);
        CHECK(level(l, 1010.0) <= (leak < 0.3 ? 250.0 - 750.0 * leak + 1.0 : 0.25));
        CHECK(level(l, 1010.0) >= (leak < 0.3 ? 250.0 - 750.0 * leak - 1.0 : 0.0));
    }
}

// Level of a channel that is driven in half-seconds with this many of each eight, by turns of two processes,
// ms by ms, as the law has it.
double by_the_law(int eighths, double leak, int half_seconds)
{
    double l = 0.0;
    for (int h = 0; h < half_seconds; ++h)
        for (int ms = 0; ms < 500; ++ms)
            l = h % 8 < eighths ? std::min(l + 0.001, 5.0) : std::max(l - 0.001 * leak, 0.0);
    return l;
}

TEST_CASE("two processes that drive a channel by turns count as one, and each hears of the other")
{
    for (const double leak : {0.25, 1.0, 4.0})
        for (const int eighths : {1, 4, 6, 8}) {
            drive_levels l;
            driver one(1);
            driver other(2);
            one.law = other.law = {.limit_s = 5.0, .leak = leak};
            double heard = 0.0;
            for (int i = 0; i < 64; ++i) { // each in turn for half a second, both write each quarter
                const bool drives = i / 2 % 8 < eighths;
                const bool first = i / 2 % 2 == 0;
                const double now_s = 10.0 + 0.25 * (i + 1);
                one.enter(l, drives && first ? 0.25 : 0.0, true, now_s - 0.01);
                heard = other.enter(l, drives && !first ? 0.25 : 0.0, true, now_s);
                CHECK(l.levels_s[0] <= 5.0);
                CHECK((heard > 0.0) == (drives && first));
            }
            CAPTURE(leak);
            CAPTURE(eighths);
            const double exact = by_the_law(eighths, leak, 32);
            CHECK(l.levels_s[0] >= exact - 0.02 * (1.0 + leak)); // "one" has not written the last 10 ms
            CHECK(l.levels_s[0] <= exact + 0.25 * leak + 0.02 * (1.0 + leak));
        }
}

TEST_CASE("a channel that nobody else drives is not heard of, however often others write")
{
    drive_levels l;
    driver one(1);
    driver other(2);
    for (int i = 0; i < 40; ++i) {
        CHECK(one.enter(l, 0.1, true, 10.0 + 0.1 * i) == 0.0);
        static_cast<void>(other.share.enter(l, std::vector{0.0, 0.1}, other.law, true, at(10.05 + 0.1 * i)));
    }
    CHECK(level(l, 13.95) == doctest::Approx(4.0).epsilon(0.05));
}

namespace {

constexpr unsigned slow_rate = 8000;

rig_options slow_options()
{
    rig_options o;
    o.sample_rate = slow_rate;
    o.dac.rate = slow_rate;
    o.loop.guards = synth::make_guards({}, slow_rate); // 5 s of each 10 s
    o.loop.horizon_frames = slow_rate / 2;
    return o;
}

stream_setup slow_setup(const std::string& device, stream_wiring wiring = {})
{
    return {.name = device, .device = device, .channels = 9, .rate = slow_rate, .wiring = std::move(wiring)};
}

/// A process that plays on a device, on a clock that moves with what it plays.
struct process : rig {
    explicit process(const std::string& device, stream_wiring wiring = {})
        : rig(slow_options()),
          book(slow_setup(device, std::move(wiring)), options.loop.guards, [this] { return now; })
    {
        also_control = [this] { book.enter(link.driven, link.sounds.load(), link.raised); };
    }
    void drive(double seconds, unsigned tactor = 0) { submit(tone(seconds, tactor, {.rate = slow_rate})); }

    engine::drive_book book;
};

void play_together(process& one, process& other, double seconds)
{
    for (double s = 0.0; s < seconds; s += 0.012) {
        one.play(one.options.period);
        other.play(other.options.period);
    }
}

// Time in which one of the streams drives a channel, s: parts of 10 ms that are loud enough.
double driven_s(std::span<const std::vector<double>> streams)
{
    constexpr std::size_t part = slow_rate / 100;
    std::size_t parts = 0;
    for (std::size_t from = 0; from < streams.front().size(); from += part)
        parts += std::any_of(streams.begin(), streams.end(),
                             [&](const auto& x) { return peak(x, from, from + part) > 0.01; });
    return 0.01 * static_cast<double>(parts);
}

} // namespace

TEST_CASE("two processes that drive a tactor by turns drive it half of the time at most")
{
    const folder here;
    const runtime r(here.path());
    process one("shared");
    process other("shared");
    for (int turn = 0; turn < 80; ++turn) {
        (turn % 2 == 0 ? one : other).drive(0.5);
        play_together(one, other, 0.5);
        std::ifstream file(here / "tactor/drive-time-shared");
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        const auto l = drive_levels::read(text, boot_id(), one.now);
        REQUIRE(l);
        CHECK(*std::max_element(l->levels_s.begin(), l->levels_s.end()) <= 5.0);
    }
    // A level of at most 5 s that rises while it is driven and falls as fast: T - (40 - T) <= 5, and a fade
    // of 20 ms for each time that it is closed.
    const std::vector<std::vector<double>> both{one.channel(0), other.channel(0)};
    CHECK(driven_s(both) <= 22.5 + 0.5);
    CHECK(driven_s(both) >= 17.0);
    CHECK(one.link.count.drives_cut + other.link.count.drives_cut > 0);
}

TEST_CASE("two processes on tactors of their own do not cut each other's strokes")
{
    const folder here;
    const runtime r(here.path());
    process one("shared");
    process other("shared");
    one.drive(4.9, 0);
    other.drive(4.9, 8);
    play_together(one, other, 5.2);
    CHECK(one.link.count.drives_cut == 0);
    CHECK(other.link.count.drives_cut == 0);
}

TEST_CASE("a channel that another process has driven to the limit is closed in the middle of a stroke")
{
    const folder here;
    const runtime r(here.path());
    process one("shared");
    process other("shared");
    one.drive(4.0);
    play_together(one, other, 3.0);
    other.drive(4.0);               // at once: both count
    play_together(one, other, 3.0); // it does not open again by then
    CHECK(other.link.count.drives_cut == 1);
    CHECK(largest_step(other.channel(0)) < 0.1); // it is faded: a carrier of 250 Hz has steps of 0.05
    const std::vector<std::vector<double>> own{other.channel(0)};
    CHECK(driven_s(own) <= 1.0 + 0.25 + 0.05); // 3 + 2 * 1 s
    CHECK(driven_s(own) >= 0.8);
}

TEST_CASE("drive time counts by the device's channels where the PCM moves them")
{
    const folder here;
    const runtime r(here.path());
    stream_wiring crossed;
    for (unsigned c = 0; c < 9; ++c)
        crossed.outputs.push_back({8 - c});
    std::int64_t now = 0;
    {
        process one("shared", crossed);
        one.drive(4.0, 1); // output 7
        one.play(slow_rate * 4 + 960);
        now = one.now;
    }
    const engine::drive_book book(slow_setup("shared"), synth::make_guards({}, slow_rate),
                                  [&] { return now; });
    CHECK(book.levels().at(7) == doctest::Approx(4.0).epsilon(0.05));
    CHECK(book.levels().at(1) == 0.0);
}

TEST_CASE("each channel begins with the level that an earlier run has left")
{
    const folder here;
    const runtime r(here.path());
    here.write("tactor/drive-time-shared",
               drive_levels{.levels_s = {0.0, 0.0, 0.0, 0.0, 4.9}, .at_ns = at(1000.0)}.text(boot_id()));
    std::filesystem::permissions(here / "tactor", std::filesystem::perms::owner_all);
    std::int64_t now = at(1000.0);
    const engine::drive_book book(slow_setup("shared"), synth::make_guards({}, slow_rate),
                                  [&] { return now; });
    CHECK(book.doubt().empty());
    rig_options o = slow_options();
    o.loop.driven_s = book.levels();
    rig played(o);
    played.submit(tone(0.5, 4, {.rate = slow_rate}));
    played.submit(tone(0.5, 3, {.rate = slow_rate}));
    played.play(slow_rate);
    const std::vector<std::vector<double>> used{played.channel(4)};
    const std::vector<std::vector<double>> fresh{played.channel(3)};
    CHECK(driven_s(used) < 0.3);
    CHECK(driven_s(fresh) > 0.45);
}

TEST_CASE("a long stroke is entered while it sounds, so that a killed run counts")
{
    const folder here;
    const runtime r(here.path());
    process one("shared");
    one.drive(4.0);
    one.play(slow_rate * 3); // and never again
    std::int64_t later = one.now + at(0.6);
    const engine::drive_book book(slow_setup("shared"), one.options.loop.guards, [&] { return later; });
    CHECK(book.levels().at(0) >= 3.0 - 0.25 + 0.5 - 0.6 - 0.1);
    CHECK(book.levels().at(0) <= 3.0 + 0.5);
    CHECK(book.levels().at(1) <= 0.5);
}

TEST_CASE("a file that is cut or foreign counts as the limit once, with a reason, and is whole then")
{
    for (const std::string& text : {std::string(), std::string("tactor-drive-time 1\n7\n1.0\nend\n"),
                                    drive_levels{.levels_s = {0.0}, .at_ns = 5}.text(boot_id()).substr(0, 60),
                                    drive_levels{.levels_s = {0.0}, .at_ns = at(1e9)}.text(boot_id())}) {
        CAPTURE(text);
        const folder here;
        const runtime r(here.path());
        const auto file = here.write("tactor/drive-time-x", text);
        std::filesystem::permissions(here / "tactor", std::filesystem::perms::owner_all);
        CHECK(drive_time_fault("x") == file.string() + " cannot be read completely");
        process one("x");
        CHECK(one.book.doubt() ==
              file.string() +
                  " cannot be read completely: each tactor counts as driven for as long as allowed");
        CHECK(one.book.levels() == std::vector<double>(9, 5.0));
        CHECK(drive_time_fault("x") == "");
        const process next("x");
        CHECK(next.book.doubt().empty());
    }
    const folder here;
    const runtime r(here.path());
    here.write("tactor/drive-time-x", drive_levels{.levels_s = {4.0}, .at_ns = at(1e9)}.text("old start"));
    std::filesystem::permissions(here / "tactor", std::filesystem::perms::owner_all);
    const process one("x");
    CHECK(one.book.doubt().empty()); // of an earlier start of the machine
    CHECK(one.book.levels() == std::vector<double>(9, 0.0));
}

TEST_CASE("a file that becomes foreign, or is kept locked, closes all channels while a stroke sounds")
{
    for (const bool locked : {false, true}) {
        CAPTURE(locked);
        const folder here;
        const runtime r(here.path());
        process one("x");
        one.drive(4.0);
        one.play(slow_rate);
        const std::string path = (here / "tactor/drive-time-x").string();
        detail::owned_fd held;
        if (locked) {
            held = detail::owned_fd(::open(path.c_str(), O_RDWR | O_CLOEXEC));
            REQUIRE(detail::lock_file(held, 0));
        } else {
            std::ofstream(path) << "something else";
        }
        one.play(slow_rate);
        CHECK(one.link.count.drives_cut == 1);
        const std::vector<std::vector<double>> own{one.channel(0)};
        CHECK(driven_s(own) <= 1.0 + 0.2 + 0.15 + 0.05);
        CHECK(one.book.doubt() ==
              path + (locked ? " is locked by another program" : " cannot be read completely") +
                  ": each tactor counts as driven for as long as allowed");
    }
}

TEST_CASE("a file that another process keeps locked counts as the limit from the beginning")
{
    const folder here;
    const runtime r(here.path());
    process one("x");
    one.drive(0.5);
    one.play(slow_rate);
    const std::string path = (here / "tactor/drive-time-x").string();
    const detail::owned_fd held(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    REQUIRE(detail::lock_file(held, 0));
    const process next("x");
    CHECK(next.book.levels() == std::vector<double>(9, 5.0));
    CHECK(next.book.doubt() ==
          path + " is locked by another program: each tactor counts as driven for as long as allowed");
}

TEST_CASE("a lock that another process holds for a moment costs nothing")
{
    const folder here;
    const runtime r(here.path());
    process one("x");
    one.drive(4.0);
    one.play(slow_rate);
    {
        const detail::owned_fd held(::open((here / "tactor/drive-time-x").c_str(), O_RDWR | O_CLOEXEC));
        REQUIRE(detail::lock_file(held, 0));
        one.play(slow_rate / 8);
    }
    one.play(slow_rate * 4);
    CHECK(one.link.count.drives_cut == 0);
    CHECK(one.book.doubt().empty());
}

TEST_CASE("no link is followed, and no folder of another user is used")
{
    const folder here;
    {
        const runtime r(here.path());
        CHECK(drive_time_fault("x") == "");
        const auto precious = here.write("precious", "text");
        for (const std::string target : {"precious", "nowhere"}) {
            const auto link = here / ("tactor/drive-time-to-" + target);
            std::filesystem::create_symlink(here / target, link);
            const process one("to-" + target);
            CHECK(one.book.doubt() ==
                  link.string() +
                      " cannot be read completely: each tactor counts as driven for as long as allowed");
            CHECK(here.names() == std::vector<std::string>{"precious", "tactor"});
            CHECK(here.bytes("precious") == "text");
        }
    }
    const bool root = ::geteuid() == 0;
    const std::string other = root ? here.path().string() : "/";
    if (root)
        REQUIRE(::chown(other.c_str(), 65534, static_cast<gid_t>(-1)) == 0);
    const runtime r(other);
    CHECK(drive_time_fault("x") == other + " is not a folder of this user");
}

TEST_CASE("a book that cannot be written is found out before anything sounds")
{
    const folder here;
    const runtime r(here.path());
    CHECK(drive_time_fault("x") == "");
    std::filesystem::remove(here / "tactor/drive-time-x");
    rlimit before = {};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{.rlim_cur = 0, .rlim_max = before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &none);
    const std::string fault = drive_time_fault("x");
    const process one("x");
    const std::string doubt = one.book.doubt();
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    const std::string path = (here / "tactor/drive-time-x").string();
    CHECK(fault == path + " cannot be made: File too large");
    CHECK(doubt == path + " cannot be written: File too large: the next run will not know for how long the "
                          "array was driven");
    CHECK(std::filesystem::is_empty(here / "tactor")); // no half of a file
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

TEST_CASE("what another process drove counts")
{
    const folder here;
    const runtime r(here.path());
    const drive_levels theirs{.levels_s = std::vector<double>(9, 0.4), .at_ns = rt::boottime_ns()};
    here.write("tactor/drive-time-of%20others", theirs.text(boot_id()));
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
    CHECK(drive_time_fault("e") == "");
    here.write("tactor/drive-time-d/x");
    CHECK(drive_time_fault("d") ==
          (here / "tactor/drive-time-d").string() + " cannot be opened: Is a directory");
    CHECK(count_cuts("d", 0.01) == 1); // it counts as the limit
    std::filesystem::permissions(here / "tactor", std::filesystem::perms::all);
    CHECK(drive_time_fault("d") ==
          (here / "tactor").string() + " must be a folder that only this user can write to");
    std::filesystem::remove_all(here / "tactor");
    std::filesystem::create_directory_symlink("/tmp", here / "tactor");
    CHECK(drive_time_fault("d") ==
          (here / "tactor").string() + " must be a folder that only this user can write to");
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
