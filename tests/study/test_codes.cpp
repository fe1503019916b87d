// SPDX-License-Identifier: MIT
// Codes of stimuli and answers, as a recorder gets them. What a session that goes on takes from its table.
#include "study/session/session_record.hpp"
#include "study/session/sync_codes.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "caught.hpp"
#include "clock_runner.hpp"
#include "core/owned.hpp"
#include "fake_dac.hpp"
#include "folder.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "stage_support.hpp"
#include "study/bids/session_store.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/definition.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/serial_port.hpp"
#include "synth/score/joined.hpp"

namespace codes_test {

using namespace stage_test;

namespace {

const char* climb = R"(
[experiment]
name = "climb"
level = { dbfs = -20 }
gap_s = 0.1
[[motion]]
name = "east"
path = "M0 20H40"
duration = 0.2
[[method]]
name = "a"
algorithm = "tactile-brush"
[[run]]
name = "r"
task = "adaptive"
question = "Which was stronger?"
vary = "level_dbfs"
procedure = "1up1down"
range = [-40, -8]
steps = [4]
start = -16
standard = -24
trials = 8
)";

// The array's eight tactors leave a channel for the codes.
const char* coded_array = R"(
[array]
name = "eight"
grid = { rows = 2, columns = 4, pitch_mm = 20.0 }
[sync]
code = { channel = 8, bit_ms = 1.5 }
[sync.codes]
stimulus = 41
)";

// A session of `pairs` on an array file's text, without a device.
struct coded_session {
    folder files;
    study::prepared_experiment p;
    study::study_folder study_files;
    study::session_store store;

    explicit coded_session(const std::string& array_text, const std::string& definition = pairs)
        : p(prepare(array_text, definition)),
          study_files(files / "study", p.definition, "01", true),
          store(study_files, {&p.definition.runs[0]}, study::describe_session(p, {}, ""),
                study::start_kind::begin)
    {
        store.begin(p.stimuli.all(), study::describe_events(p));
    }

    study::prepared_experiment prepare(const std::string& array_text, const std::string& definition)
    {
        session::settings s;
        s.config_file = files.write("none.toml", "").string();
        s.array_name = files.write("array.toml", array_text).string();
        return study::prepare(
            {files.write("pairs.toml", definition).string(), "01", 1, study::audience::nobody}, s);
    }
};

std::string refusal(const std::string& from, const std::string& to)
{
    std::string text = coded_array;
    text.replace(text.find(from), from.size(), to);
    const std::string why = caught_message([&] { coded_session{text}; });
    return why.substr(why.find("array.toml"));
}

} // namespace

TEST_CASE("codes on a spare channel end where each stimulus begins, and hold its number")
{
    coded_session c(coded_array);
    fake_dac dac;
    study::stage there(nine(), {}, c.p.where, set_up::source(dac));
    const running_clock clock(dac, running_clock::capture_kind::kept);
    study::sync_codes codes(c.p, c.store, &there, nullptr);
    const study::planned_trial t{0, 1, 0};
    const study::session_step step{study::step_kind::trial, 0, 0, false, {1, 1}};
    const study::session_step practice{study::step_kind::trial, 0, 0, true, {1, 1}}; // has no codes
    CHECK(codes.play_stimuli(c.p.stimuli.make_score(t), practice, t, nobody).frames ==
          c.p.stimuli.count_frames(t));
    codes.send(study::code_event::answer, practice, t, "1");
    std::uint64_t latest = 0;
    const study::given_stimulus g =
        codes.play_stimuli(c.p.stimuli.make_score(t), step, t, [&](std::uint64_t frame) { latest = frame; });
    codes.send(study::code_event::answer, step, t, "1");
    codes.send(study::code_event::made_void, step, t);
    codes.finish();
    REQUIRE(g.flaw.empty());
    CHECK(latest <= c.p.stimuli.count_frames(t));
    CHECK(g.frames == c.p.stimuli.count_frames(t));

    const std::vector<std::byte> all = dac.captured();
    const auto sample = [&](std::uint64_t at, std::size_t channel) {
        std::int32_t v = 0;
        std::memcpy(&v, all.data() + at * frame + channel * 4, 4);
        return v;
    };
    // Decodes as an amplifier would: after a rise, each bit in its middle.
    std::vector<std::pair<unsigned, std::uint64_t>> heard;
    constexpr std::uint64_t bit = 72;
    for (std::uint64_t at = 0; at + 9 * bit < all.size() / frame; ++at) {
        if (sample(at, 8) == 0)
            continue;
        CHECK(sample(at, 8) == 1 << 30);
        unsigned number = 0;
        for (unsigned i = 0; i < 8; ++i)
            number |= sample(at + (i + 1) * bit + bit / 2, 8) > 0 ? 1U << i : 0U;
        heard.emplace_back(number, at);
        at += 9 * bit;
    }
    REQUIRE(heard.size() == 4);
    CHECK(synth::make_code(c.p.stimuli.make_score(t), 8, bit, 1).starts().empty()); // no sync pulse
    const std::uint64_t first = *g.first_frame;
    // From 41: a in both intervals, b in both, the answers 1 and 2, void.
    CHECK(heard[0] == std::pair{43U, first - 9 * bit});
    CHECK(heard[1] == std::pair{42U, first + c.p.stimuli.starts(t)[1] - 9 * bit});
    CHECK(heard[2].first == 45);
    CHECK(heard[3].first == 47);
    for (const std::size_t method : {t.method_1, *t.method_2}) {
        const study::stimulus& s = c.p.stimuli.at(0, method);
        const std::uint64_t from = first + (method == t.method_1 ? 0 : c.p.stimuli.starts(t)[1]);
        CHECK(part(all, from * frame, s.frames * frame) ==
              rendered(score(c.p.where.tactors, s.made.plans, s.render), format_kind::s32));
    }

    study::run_table table(c.store, c.p.definition.runs[0], false);
    study::trial_row row = study::planned_row(c.p, c.p.definition.runs[0], t, {1, 1});
    row.stream = 1;
    row.frame_1 = first;
    table.add(row, 0, rate);
    codes.write(c.p.definition.runs[0], row, table);
    const study::text_table events(c.files / "study/sub-01/beh/sub-01_task-r_events.tsv");
    REQUIRE(events.rows() == heard.size());
    for (std::size_t i = 0; i < heard.size(); ++i) {
        CHECK(events.need(i, "code") == std::to_string(heard[i].first));
        CHECK(events.need(i, "frame") == std::to_string(heard[i].second));
    }
    CHECK(events.need(0, "onset") == "0.000000");
    there.finish();
}

TEST_CASE("a code that an xrun cuts has an event, because the recorder may have another number")
{
    std::string array_text = coded_array;
    array_text.replace(array_text.find("1.5"), 3, "20"); // nine bits take 8640 frames
    std::string definition = pairs;
    definition.replace(definition.find("0.0321"), 6, "0.3");
    coded_session c(array_text, definition);
    set_up s;
    study::sync_codes codes(c.p, c.store, &s.there, nullptr);
    const study::planned_trial t{0, 1, 0};
    const study::session_step step{study::step_kind::trial, 0, 0, false, {1, 1}};
    {
        const meanwhile x(s, [&] { s.dac.advance(1'000'000); });
        const study::given_stimulus g = codes.play_stimuli(c.p.stimuli.make_score(t), step, t, nobody);
        CHECK_FALSE(g.flaw.empty());
        CHECK_FALSE(g.first_frame);
    }
    study::run_table table(c.store, c.p.definition.runs[0], false);
    study::trial_row row = study::planned_row(c.p, c.p.definition.runs[0], t, {1, 1});
    row.is_void = true;
    table.add(row, 0, rate);
    codes.write(c.p.definition.runs[0], row, table);
    const study::text_table events(c.files / "study/sub-01/beh/sub-01_task-r_events.tsv");
    REQUIRE(events.rows() == 1);
    CHECK(events.need(0, "event") == "broken");
    CHECK(events.need(0, "code") == "43");
    s.there.finish();
}

// Returns the numbers of three stimuli, of which so many have begun.
std::array<study::due_number, 3> list_due(std::size_t begun)
{
    std::array<study::due_number, 3> all{{{7}, {9}, {8}}};
    for (std::size_t i = begun; i < all.size(); ++i)
        all[i].from_ns = std::numeric_limits<std::int64_t>::max();
    return all;
}

TEST_CASE("lines show the number of each pulse, another line along with it")
{
    std::vector<int> shown;
    struct fake_lines : amplifier::code_lines {
        explicit fake_lines(std::vector<int>& s) : shown(s) {}
        bool set(unsigned n) noexcept override
        {
            shown.push_back(static_cast<int>(n));
            return true;
        }
        std::vector<int>& shown;
    };
    struct fake_out : enable_line {
        explicit fake_out(std::vector<int>& s) : shown(s) {}
        bool set(bool on) noexcept override
        {
            shown.push_back(on ? -1 : -2);
            return true;
        }
        std::vector<int>& shown;
    };
    {
        std::vector<std::unique_ptr<amplifier::code_lines>> lines;
        lines.push_back(std::make_unique<fake_lines>(shown));
        study::coded_pulse pulse(std::move(lines), std::make_unique<fake_out>(shown));
        CHECK(pulse.set(true));
        pulse.set_next_numbers(list_due(1));
        CHECK(pulse.set(true));
        CHECK(pulse.set(false));
        for (const std::size_t begun : {2U, 3U}) {
            pulse.set_next_numbers(list_due(begun));
            CHECK(pulse.set(true));
        }
    }
    CHECK(shown == std::vector<int>{0, -1, 7, -1, 0, -2, 9, -1, 8, -1, 0, -2});
}

// A terminal that stands for a trigger box. The kernel hands its bytes over a while after they were written.
struct fake_box {
    tactor::detail::owned_fd box{::posix_openpt(O_RDWR | O_NOCTTY)};
    std::string path;

    fake_box()
    {
        REQUIRE((::grantpt(box.get()) == 0 && ::unlockpt(box.get()) == 0));
        path = ::ptsname(box.get());
    }
    // Waits for so many bytes. There must be no more.
    std::vector<unsigned> read(std::size_t count)
    {
        std::vector<unsigned> all;
        constexpr int patience_ms = 120'000;
        pollfd p{box.get(), POLLIN, 0};
        unsigned char byte = 0;
        while (all.size() < count && ::poll(&p, 1, patience_ms) == 1 && ::read(box.get(), &byte, 1) == 1)
            all.push_back(byte);
        CHECK(::poll(&p, 1, 0) == 0);
        return all;
    }
};

TEST_CASE("a serial box gets each number as a byte, and a 0 when its time is over")
{
    fake_box b;
    std::vector<std::unique_ptr<amplifier::code_lines>> port;
    port.push_back(study::open_serial_port(b.path, 9600, {}));
    termios t{};
    REQUIRE(::tcgetattr(b.box.get(), &t) == 0); // those of the other end
    CHECK(::cfgetospeed(&t) == B9600);
    CHECK((t.c_cflag & (CSIZE | PARENB | CSTOPB | CRTSCTS)) == CS8);
    CHECK((t.c_lflag & (ICANON | ECHO | ISIG)) == 0);
    {
        study::coded_pulse pulse(std::move(port), nullptr);
        CHECK(pulse.set(true)); // has no number: of the walk, of practice
        CHECK(pulse.set(false));
        pulse.set_next_numbers(std::vector<study::due_number>{{7}});
        CHECK(pulse.set(true));
        CHECK(pulse.set(false));
        pulse.set_next_numbers(list_due(2));
        CHECK(pulse.set(true));
        CHECK(b.read(4) == std::vector<unsigned>{0, 7, 0, 9});
        // The bytes that a terminal changes or takes for itself, and all others.
        std::vector<unsigned> all;
        for (unsigned n = 1; n < 256; ++n) {
            CHECK(pulse.show(n));
            all.push_back(n);
        }
        CHECK(b.read(255) == all);
        // No byte is kept for a port that has gone.
        b.box.close();
        CHECK_FALSE(pulse.show(1));
        CHECK_FALSE(pulse.set(true));
    }
}

TEST_CASE("an answer's number goes to a serial box until its time is over, and is recorded")
{
    fake_box b;
    const std::string on_channel = "channel = 8, bit_ms = 1.5";
    std::string array_text = coded_array;
    array_text.replace(array_text.find(on_channel), on_channel.size(),
                       "pulse_ms = 2, serial = \"" + b.path + "\"");
    coded_session c(array_text);
    fake_dac dac;
    study::coded_pulse* lines = nullptr;
    const session::stream_options how;
    study::stage there(nine(), {}, c.p.where, [&](session::stream_parts& p) {
        set_up::source(dac)(p);
        study::make_code_source(how, c.p.where, lines)(p);
    });
    const running_clock clock(dac, running_clock::capture_kind::kept);
    REQUIRE(lines != nullptr);
    study::sync_codes codes(c.p, c.store, &there, lines);
    const study::planned_trial t{0, 1, 0};
    const study::session_step step{study::step_kind::trial, 0, 0, false, {1, 1}};
    codes.send(study::code_event::answer, step, t, "2");
    codes.send(study::code_event::made_void, step, t);
    codes.finish();
    CHECK(b.read(5) == std::vector<unsigned>{0, 46, 0, 47, 0}); // from 41: four stimuli, two answers, void
    CHECK(study::describe_session(c.p, {}, "")["codes"]["serial"]["baud"] == 115200);
    there.finish();
}

TEST_CASE("nothing but a terminal is opened as a serial port")
{
    const folder files;
    const std::string fifo = (files / "fifo").string();
    const std::string file = files.write("file", "as it was").string();
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    const auto why = [](const std::string& path) {
        return caught_message([&] { study::open_serial_port(path, 9600, {"a.toml", 3}); });
    };
    for (const std::string& path :
         {std::string("/dev/null"), std::string("/dev/zero"), fifo, file, std::string("/dev")})
        CHECK(why(path) == "a.toml:3: serial: " + path +
                               ": it is not a serial port (list the ports: ls /dev/serial/by-id /dev/ttyS*)");
    CHECK(files.bytes("file") == "as it was");
    CHECK(why("/dev/ttyNONE") == "another kind: a.toml:3: serial: /dev/ttyNONE: No such file or directory "
                                 "(list the ports: ls /dev/serial/by-id /dev/ttyS*)");
}

TEST_CASE("codes that cannot be sent are refused by name before the session")
{
    CHECK(refusal("stimulus = 41", "stimulus = 255") ==
          "array.toml:6:8: code: 7 events need numbers up to 261 (void), but 255 is the largest "
          "(combine events under [sync.codes]: stimulus = { by = [\"motion\", \"method\"] })");
    CHECK(refusal("channel = 8, bit_ms = 1.5", "chip = \"c\", offsets = [1, 2, 3, 4, 5]") ==
          "array.toml:6:8: code: 7 events need numbers up to 47 (void), but 31 is the largest (use more "
          "lines, or combine events under [sync.codes]: stimulus = { by = [\"motion\", \"method\"] })");
    CHECK(
        refusal("channel = 8, bit_ms = 1.5", "chip = \"c\", offsets = [1, 2, 3, 4, 5, 6], pulse_ms = 250") ==
        "array.toml:6:8: code: pulse_ms is 250, but the answer's number may come 200 ms after the start "
        "of motion \"east\" with method \"a\" (use a shorter pulse_ms, or longer stimuli)");
    CHECK(refusal("channel = 8, bit_ms = 1.5", "serial = \"/dev/ttyS0\", pulse_ms = 250")
              .starts_with(
                  "array.toml:6:8: code: pulse_ms is 250, but the answer's number may come 200 ms after"));
    CHECK(
        refusal("channel = 8, bit_ms = 1.5", "serial = \"/dev/ttyS0\", baud = 4800, pulse_ms = 2") ==
        "array.toml:6:8: code: pulse_ms is 2, but a byte takes 2.083 ms at 4800 baud (use a longer pulse_ms, "
        "or a greater baud)");
    CHECK(refusal("bit_ms = 1.5", "bit_ms = 4") ==
          "array.toml:6:8: code: it takes 0.036 s, but the gap between two stimuli is 0.0321 s (use a longer "
          "gap_s in the definition, or a shorter bit_ms)");
    const auto warnings = coded_session(std::string(coded_array) + "answer = 44\n").p.warnings;
    REQUIRE(!warnings.empty());
    CHECK(
        warnings.back() ==
        "[sync.codes]: number 44 marks several events: stimulus, motion \"east\", method \"b\", interval 2; "
        "answer, run \"r\", answer 1");
}

TEST_CASE("a session goes on with the stimuli that its table names, the second of a pair too")
{
    const coded_session c(coded_array);
    const study::run_sequence& run = c.p.runs[0];
    study::trial_row row = study::planned_row(c.p, c.p.definition.runs[0], run.trials[0], {1, 1});
    row.response = "1";
    const std::filesystem::path table = c.files.write("t.tsv", "trial\n\n1\n"); // a blank line is no row
    CHECK_FALSE(study::replay(c.p, run, {row}, table).done());
    for (std::string study::trial_row::*plan : {&study::trial_row::plan_1, &study::trial_row::plan_2}) {
        study::trial_row other = row;
        std::swap((other.*plan).front(), (other.*plan).back());
        REQUIRE(other.*plan != row.*plan);
        CHECK(caught_message([&] {
                  study::replay(c.p, run, {other}, table);
              }).starts_with(table.string() + ":3: trial 1"));
    }
}

TEST_CASE("a trial that became void does not move its track, and its answer counts when it comes again")
{
    coded_session c(coded_array, climb);
    const study::run_definition& r = c.p.definition.runs[0];
    study::held_run held(c.p, 0, c.store);
    const auto step = [](unsigned trial, unsigned attempt) {
        return study::session_step{study::step_kind::trial, 0, 0, false, {trial, attempt}};
    };
    const auto next = [&](unsigned trial, unsigned attempt) { return held.find_trial(step(trial, attempt)); };
    const auto add = [&](unsigned trial, unsigned attempt, bool is_void) {
        const study::planned_trial t = next(trial, attempt);
        study::trial_row row = study::planned_row(c.p, c.p.definition.runs[0], t, {trial, attempt});
        // The value under test, not its standard, was the stronger one.
        study::set_response(row, r, row.method_1 == "a" ? 1 : 2, 0.5);
        row.is_void = is_void;
        static_cast<void>(held.add(step(trial, attempt), row, 0));
        return *study::find_value(c.p.definition, t);
    };
    CHECK(add(1, 1, true) == -16.0);
    CHECK(add(2, 1, false) == -16.0);
    CHECK(add(1, 2, true) == -20.0);
    CHECK(add(1, 3, false) == -20.0);
    CHECK(*study::find_value(c.p.definition, next(3, 1)) == -24.0);
    const study::held_run resumed(c.p, 0, c.store);
    CHECK(*study::find_value(c.p.definition, resumed.find_trial(step(3, 1))) == -24.0);
}

} // namespace codes_test