// SPDX-License-Identifier: MIT
#include "study/calibrate/calibration.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "files/setup_text.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace tactor::study::test_calibration {
namespace {

namespace fs = std::filesystem;

calibration_settings settings()
{
    calibration_settings s;
    s.participant = "P07";
    s.tactors = {2, 0};
    s.ceilings_dbfs = {0.0, -3.0};
    s.staircase.reversals = 4;
    s.staircase.discard = 2;
    s.practice = 2;
    s.seed = 5;
    s.simulate = "threshold=-30,spread=2";
    s.date = "2026-11-21";
    return s;
}

const std::string header = "trial\ttactor\tlevel_dbfs\tinterval\tresponse\tcorrect\treversal\tpractice\t"
                           "response_time_s\tonset_frame\n";

const observer_settings who{{-30.0}, 2.0, 0.0};
const observer_settings careless{{-30.0}, 2.0, 0.1};

struct outcome {
    std::string log;
    std::string tables;
};

// Runs a session, or the rest of one.
outcome run(const fs::path& log, bool resume, calibration_settings s = settings(), std::size_t most = 10000,
            const observer_settings& asked = who)
{
    calibration_log lines(log, resume, s);
    calibration c(s);
    observer o(asked, s);
    replay(c, lines, &o);
    lines.begin();
    for (std::size_t i = 0; i < most && !c.done(); ++i)
        lines.append(c.answer(o.answer(c.next())));
    std::ifstream written(log, std::ios::binary);
    return {{std::istreambuf_iterator<char>(written), {}}, calibration_text(s, c.thresholds())};
}

std::string refusal(const fs::path& log, bool resume, const calibration_settings& s = settings())
{
    return caught_message([&] { run(log, resume, s); });
}

TEST_CASE("the same seed gives the same session, another seed another")
{
    const folder f;
    const outcome a = run(f / "a.tsv", false);
    const outcome b = run(f / "b.tsv", false);
    CHECK(a.log == b.log);
    CHECK(a.tables == b.tables);
    calibration_settings other = settings();
    other.seed = 6;
    CHECK(run(f / "c.tsv", false, other).log != a.log);
    has(a.log, "1\t2\t-20\t");
}

TEST_CASE("a log cut off anywhere resumes as if nothing had happened")
{
    const folder f;
    // A session with a second staircase, so that each phase is cut.
    calibration_settings s = settings();
    for (bool twice = false; !twice; s.seed += twice ? 0 : 1) {
        calibration c(s);
        observer o(careless, s);
        while (!c.done())
            c.answer(o.answer(c.next()));
        for (const tactor_threshold& t : c.thresholds())
            twice = twice || (t.staircases == 2 && t.end == staircase_end::felt);
    }
    const outcome whole = run(f / "a.tsv", false, s, 10000, careless);
    const std::string began = f.bytes("a.json");
    // Each byte of header, first and last trials; between them each 31st, which finds each place in a line.
    const std::size_t size = whole.log.size();
    for (std::size_t bytes = 0; bytes <= size; bytes += bytes < 150 || size - bytes <= 150 ? 1 : 31) {
        CAPTURE(bytes);
        f.write("b.tsv", whole.log.substr(0, bytes));
        f.write("b.json", began);
        calibration_settings later = s;
        later.date = "2026-11-30";
        const outcome again = run(f / "b.tsv", true, later, 10000, careless);
        REQUIRE(again.log == whole.log);
        REQUIRE(again.tables == whole.tables);
    }
}

TEST_CASE("a session killed before its first byte resumes, too")
{
    const folder f;
    const outcome whole = run(f / "a.tsv", false);
    f.write("log.tsv", "");
    CHECK(run(f / "log.tsv", true).log == whole.log); // the log is made first
    fs::copy(f / "a.json", f / "beside.json");
    CHECK(run(f / "beside.tsv", true).log == whole.log);
}

TEST_CASE("a session that was never begun does not resume")
{
    const folder f;
    has(refusal(f / "none.tsv", true), "there is no log");
    CHECK_FALSE(fs::exists(f / "none.tsv"));
}

TEST_CASE("without answers a session begins anew, even with other options")
{
    const folder f;
    run(f / "a.tsv", false, settings(), 0);
    CHECK_FALSE(fs::exists(f / "a.tsv"));
    CHECK_FALSE(fs::exists(f / "a.json"));
    // Like after a kill.
    f.write("a.tsv", header);
    f.write("a.json", settings_text(settings()));
    calibration_settings other = settings();
    other.carrier_hz = 100.0;
    const outcome again = run(f / "a.tsv", false, other);
    has(again.tables, "carrier_hz = 100\n");
    has(f.bytes("a.json"), "\"carrier_hz\": 100.0");
    f.write("b.json", "{\"mine\": 1}");
    has(refusal(f / "b.tsv", false), "b.json: it lacks the settings");
    CHECK(f.bytes("b.json") == "{\"mine\": 1}");
}

TEST_CASE("a person's answers and times come back from the log")
{
    const folder f;
    calibration_settings s = settings();
    s.simulate.clear();
    {
        calibration_log log(f / "a.tsv", false, s);
        log.begin();
        calibration c(s);
        for (unsigned i = 0; i < 9; ++i)
            log.append(
                c.answer({.interval = 1 + i % 2, .response_time_s = 0.25 * i, .onset_frame = 48000 * i}));
    }
    const std::string before = f.bytes("a.tsv");
    calibration_log log(f / "a.tsv", true, s);
    calibration c(s);
    replay(c, log, nullptr);
    CHECK(c.next().number == 10);
    CHECK(f.bytes("a.tsv") == before);
}

// Replaces each.
std::string with(std::string text, const std::string& from, const std::string& to)
{
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

TEST_CASE("a log saved by another program resumes, and keeps its line ends")
{
    const folder f;
    const outcome whole = run(f / "a.tsv", false);
    const std::string began = f.bytes("a.json");
    const std::string some = whole.log.substr(0, whole.log.find("\n9\t") + 1);
    const auto goes_on = [&](const std::string& saved, const std::string& end) {
        f.write("b.tsv", saved);
        f.write("b.json", began);
        const outcome again = run(f / "b.tsv", true);
        CHECK(again.tables == whole.tables);
        const std::string rest = with(whole.log.substr(some.size()), "\n", end);
        const std::string line_end = saved.ends_with("n/a") ? end : "";
        CHECK(again.log == saved + line_end + rest);
        CHECK_FALSE(fs::exists(f / "b.tsv.cut-1"));
    };
    goes_on(with(some, "\n", "\r"), "\r");
    goes_on(with(some, "\n", "\r\n"), "\r\n");
    goes_on("\xef\xbb\xbf" + some, "\n");
    goes_on(some.substr(0, some.size() - 1), "\n");
    goes_on(with(some, "\n", "\r").substr(0, some.size() - 1), "\r");
    goes_on(with(with(some, "true", "TRUE"), "false", "False"), "\n");
    goes_on(with(some, "true", "\"true\""), "\n");
    goes_on(with(some, "\t-20\t", "\t-20.0\t") + "\n\t\t\n", "\n");
}

TEST_CASE("a cut off part of a log is kept beside it, and only when the rest is of this session")
{
    const folder f;
    const outcome whole = run(f / "a.tsv", false);
    const std::string cut = whole.log.substr(0, whole.log.size() - 20);
    const std::string last = cut.substr(cut.rfind('\n') + 1);
    f.write("a.tsv", cut);
    calibration_settings other = settings();
    other.seed = 7;
    CHECK_FALSE(refusal(f / "a.tsv", true, other).empty());
    CHECK(f.bytes("a.tsv") == cut);
    f.write("a.tsv", with(cut, "true", "false"));
    has(refusal(f / "a.tsv", true), "a.tsv:2: the line does not match the session's settings");
    CHECK(f.bytes("a.tsv") == with(cut, "true", "false"));
    f.write("a.tsv", cut);
    CHECK(run(f / "a.tsv", true).log == whole.log);
    CHECK(f.bytes("a.tsv.cut-1") == last);
    f.write("a.tsv", cut);
    run(f / "a.tsv", true);
    CHECK(f.bytes("a.tsv.cut-2") == last);
}

TEST_CASE("the array file quotes the name of a device")
{
    calibration_settings s = settings();
    s.masker = "white noise";
    s.masker_pcm = "a\"b\\c\x01\x1f\x7f d";
    has(calibration_text(s, {}), "a\\\"b\\\\c\\u0001\\u001F\\u007F d\"");
}

TEST_CASE("a log of another session is refused with the line")
{
    const folder f;
    const outcome whole = run(f / "a.tsv", false);
    has(refusal(f / "a.tsv", false), "it exists");
    const std::string first = whole.log.substr(0, whole.log.find("\n2\t"));
    f.write("a.tsv", first + "\n2\t2\t-19\t1\t1\ttrue\tfalse\ttrue\tn/a\tn/a\n");
    has(refusal(f / "a.tsv", true), "a.tsv:3: the line does not match the session's settings");
    f.write("a.tsv", whole.log + whole.log.substr(header.size()));
    has(refusal(f / "a.tsv", true), "the session of these settings ends before this line");
    f.write("a.tsv", "name\tvalue\n");
    has(refusal(f / "a.tsv", true), "it is not the log");
    CHECK(f.bytes("a.tsv") == "name\tvalue\n");
    f.write("a.tsv", "no line");
    has(refusal(f / "a.tsv", true), "spaces separate the columns");
    CHECK(f.bytes("a.tsv") == "no line");
    f.write("a.tsv", whole.log);
    calibration_settings other = settings();
    other.carrier_hz = 200.0;
    has(refusal(f / "a.tsv", true, other), "began with carrier_hz 250.0, but now it is 200.0");
    f.write("a.json", "[]");
    has(refusal(f / "a.tsv", true), "it lacks the settings");
    fs::remove(f / "a.json");
    has(refusal(f / "a.tsv", true), "a.json: it is missing");
    fs::create_directory(f / "d.tsv");
    has(refusal(f / "d.tsv", true), "d.tsv: ");
}

TEST_CASE("two sessions do not write one log")
{
    const folder f;
    calibration_settings s = settings();
    const calibration_log first(f / "a.tsv", false, s);
    has(refusal(f / "a.tsv", true), "another session is writing it");
    has(refusal(f / "a.tsv", false), "another session is writing it");
}

TEST_CASE("practice trials come first and do not count")
{
    calibration c(settings());
    for (unsigned i = 0; i < 2; ++i) {
        CHECK(c.next().practice);
        CHECK(c.next().level_dbfs == -20.0);
        c.answer({.interval = 3 - c.next().interval});
    }
    CHECK(!c.next().practice);
    CHECK(c.next().level_dbfs == -20.0);
    while (c.thresholds().empty())
        c.answer({.interval = c.next().level_dbfs > -40.0 ? c.next().interval : 3 - c.next().interval});
    CHECK(c.thresholds().front().trials + 3 == c.next().number);
}

TEST_CASE("adjustment: six series from 15 dB above and below, mean and deviation")
{
    calibration_settings s = settings();
    s.method = calibration_method::adjustment;
    s.practice = 0;
    calibration c(s);
    const double set[] = {-30, -31, -29, -32, -30, -28};
    const double starts[] = {-5, -45, -16, -44, -17, -45};
    for (unsigned i = 0; i < 6; ++i) {
        CHECK(c.next().interval == 0);
        CHECK(c.next().level_dbfs == starts[i]);
        const calibration_record r = c.answer({.set_dbfs = set[i]});
        CHECK(r.response == "set");
        CHECK(r.trial.level_dbfs == set[i]);
    }
    REQUIRE(c.thresholds().size() == 1);
    CHECK(*c.thresholds().front().threshold_dbfs == -30.0);
    CHECK(*c.thresholds().front().sd_db == doctest::Approx(std::sqrt(2.0)));
    CHECK(c.next().level_dbfs == -5.0); // the next tactor begins anew
    c.answer({});
    REQUIRE(c.done());
    CHECK(!c.thresholds().back().threshold_dbfs);
    CHECK(c.thresholds().back().end == staircase_end::not_felt);
}

TEST_CASE("simulated adjustment finds the threshold")
{
    calibration_settings s = settings();
    s.method = calibration_method::adjustment;
    s.practice = 0;
    double sum = 0.0;
    for (s.seed = 0; s.seed < 200; ++s.seed) {
        calibration c(s);
        observer o(who, s);
        while (!c.done())
            c.answer(o.answer(c.next()));
        sum += *c.thresholds().front().threshold_dbfs;
    }
    CHECK(std::abs(sum / 200 + 30.0) < 0.3);
}

TEST_CASE("the result is an array file of the whole array")
{
    const setup from = parse_setup(R"([array]
name = "a \"desk\""
[[tactor]]
x_mm = 0.1
y_mm = -2.5
gain_db = -3
threshold_dbfs = [[100, -30], [250, -50]]
[[tactor]]
x_mm = 20
y_mm = 0
channel = 4
max_dbfs = -6.5
polarity = -1
actuator = "lra"
rise_ms = 12.5
threshold_dbfs = -40
[[tactor]]
x_mm = 40
y_mm = 0
channel = 5
threshold_dbfs = [[100, -30.5], [250, -50]]
[output]
pcm = "hw:CARD=Tactor"
rate = 44100
channels = 8
period_frames = 128
periods = 4
[amplifier]
line = { chip = "pinctrl-rp1", offset = 17 }
active_low = true
settle_ms = 25
[sync]
out = { name = "GPIO5", pulse_ms = 2.5 }
channel = 7
in = { name = "GPIO6", edge = "falling", debounce_ms = 3, pull = "up" }
[limits]
max_drive_s = 3
[defaults]
carrier = 200
phantom = "linear"
snap = true
)",
                                   "desk.toml");
    const tactor_threshold felt{.tactor = 0,
                                .threshold_dbfs = -44.125,
                                .sd_db = 0.5,
                                .trials = 70,
                                .reversals_dbfs = {-44, -45},
                                .check_right = 10,
                                .check_below_right = 6};
    const tactor_threshold not_felt{.tactor = 1, .end = staircase_end::not_felt, .trials = 20};
    const array now = merge_thresholds(*from.array, from.calibration, {}, {felt, not_felt});
    const std::string text = detail::array_text(now, from) + calibration_text(settings(), {felt, not_felt});
    const setup read = parse_setup(text, "me.toml");
    REQUIRE(read.array);
    CHECK(read.array->name == "a \"desk\"");
    REQUIRE(read.array->tactors.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        const tactor_spec& a = now.tactors[i];
        const tactor_spec& b = read.array->tactors[i];
        CHECK(a.position == b.position);
        CHECK(a.channel == b.channel);
        CHECK(a.gain_db == b.gain_db);
        CHECK(a.max_dbfs == b.max_dbfs);
        CHECK(a.threshold_dbfs == b.threshold_dbfs);
        CHECK(a.polarity == b.polarity);
        CHECK(a.actuator == b.actuator);
        CHECK(a.thresholds == b.thresholds);
        CHECK(a.rise_s == b.rise_s);
    }
    // A measurement replaces a list; an unmeasured tactor keeps its list.
    CHECK(read.array->tactors[0].thresholds.empty());
    CHECK(read.array->tactors[2].thresholds == std::vector<threshold_point>{{100.0, -30.5}, {250.0, -50.0}});
    CHECK(*read.array->tactors[0].threshold_dbfs == -44.125);
    CHECK(!read.array->tactors[1].threshold_dbfs);
    // The file is complete: written again, it is the same.
    CHECK(detail::array_text(*read.array, read) == detail::array_text(now, from));
    CHECK(*read.output.channels == 8);
    CHECK(read.sync->in->name == "GPIO6");
    CHECK(read.sync->debounce_s == doctest::Approx(0.003));
    CHECK(read.defaults == from.defaults);
}

TEST_CASE("one participant's calibrations at several carriers come to lists by frequency")
{
    array a;
    for (unsigned i = 0; i < 4; ++i)
        a.tactors.push_back({.position = {10.0 * i, 0.0}, .channel = i});
    a.tactors[0].threshold_dbfs = -20.0;
    a.tactors[1].threshold_dbfs = -21.0;
    a.tactors[2].thresholds = {{60.0, -10.0}, {250.0, -33.0}};
    calibration_settings s;
    s.participant = "P07";
    s.carrier_hz = 250.0;
    const std::vector<tactor_threshold> measured{{.tactor = 0, .threshold_dbfs = -41.0},
                                                 {.tactor = 2, .threshold_dbfs = -42.0},
                                                 {.tactor = 3, .threshold_dbfs = -43.0}};
    using points = std::vector<threshold_point>;
    const calibration_origin before{"P07", 100.0, false};

    const array both = merge_thresholds(a, before, s, measured);
    CHECK(both.tactors[0].thresholds == points{{100.0, -20.0}, {250.0, -41.0}});
    CHECK_FALSE(both.tactors[0].threshold_dbfs);
    CHECK(both.tactors[1].thresholds == points{{100.0, -21.0}}); // it was measured there, and not here
    CHECK(both.tactors[2].thresholds == points{{60.0, -10.0}, {250.0, -42.0}});
    CHECK(both.tactors[3].threshold_dbfs == -43.0);
    CHECK(threshold_at(both.tactors[0], 100.0) == -20.0);

    const array again = merge_thresholds(a, calibration_origin{"P07", 250.0, false}, s, measured);
    CHECK(again.tactors[0].threshold_dbfs == -41.0);
    CHECK(again.tactors[0].thresholds.empty());
    CHECK(again.tactors[1].threshold_dbfs == -21.0);

    const std::vector<tactor_threshold> not_felt{{.tactor = 0}, {.tactor = 2}};
    const array less = merge_thresholds(a, before, s, not_felt);
    CHECK(less.tactors[0].thresholds == points{{100.0, -20.0}});
    CHECK(less.tactors[2].thresholds == points{{60.0, -10.0}});

    // Without other people's, and without thresholds that nobody felt.
    for (const auto& other : {calibration_origin{"P08", 100.0, false}, {"P07", 100.0, true}}) {
        const array fresh = merge_thresholds(a, other, s, measured);
        CHECK(fresh.tactors[0].threshold_dbfs == -41.0);
        CHECK(fresh.tactors[0].thresholds.empty());
        CHECK(fresh.tactors[2].thresholds.empty());
        CHECK_FALSE(fresh.tactors[1].threshold_dbfs); // the tactor was not measured now, either
        CHECK(merge_thresholds(a, other, s, {}).tactors[2].thresholds.empty());
    }
}

TEST_CASE("the tables of a calibration are checked where they are read")
{
    const std::string good = calibration_text(settings(), {{.tactor = 8, .threshold_dbfs = -30.0}});
    const auto complaint = [](const std::string& text) {
        return caught_message(
            [&] { return parse_setup("[array]\npreset = \"palm-3x3\"\n" + text, "me.toml"); });
    };
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        REQUIRE(has(text, from));
        return complaint(text.replace(text.find(from), from.size(), to));
    };
    CHECK(complaint(good).empty());
    has(changed("seed", "sead"), "sead");
    has(changed("tactor = 8", "tactor = 9"), "tactor is 9");
    has(changed("1up3down", "1up4down"), "1up4down");
    has(changed("threshold_dbfs = -30", "threshold_dbfs = 3"), "threshold_dbfs is 3");
    has(changed("trials", "trails"), "trails");
    has(changed("participant = \"P07\"\n", ""), "participant");
    has(complaint(good + "\n[[calibration.tactor]]\ntactor = 8\ntrials = 1\n"), "has another entry");
    CHECK_THROWS_AS(parse_setup(good, "me.toml"), error);
}

TEST_CASE("a bad simulation is refused with the fault")
{
    const auto complaint = [](std::string_view text) {
        return caught_message([&] { parse_observer(text, {2, 0}, 4); });
    };
    CHECK(parse_observer("threshold=-45,-50,spread=1", {2, 0}, 4).thresholds_dbfs ==
          std::vector<double>{-45, -50});
    CHECK(parse_observer("lapse=0.02,threshold=-1,-2,-3,-4", {2, 0}, 4).thresholds_dbfs ==
          std::vector<double>{-3, -1});
    has(complaint(""), "has no =");
    has(complaint("spread=2"), "threshold is missing");
    has(complaint("threshold=-45,spread=-1"), "spread is \"-1\", not a number from 0 to 100");
    has(complaint("threshold=-45,lapse=0.6"), "lapse is \"0.6\", not a number from 0 to 0.5");
    has(complaint("threshold=low"), "threshold is \"low\", not a number from -200 to 1000");
    has(complaint("threshold=-45,threshold=-46"), "occurs twice");
    has(complaint("threshold=1,2,3"), "3 thresholds for 2 tactors");
    has(complaint("sigma=1,threshold=-45"), "the key \"sigma\" is unknown");
}

} // namespace
} // namespace tactor::study::test_calibration
