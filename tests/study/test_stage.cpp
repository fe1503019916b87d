// SPDX-License-Identifier: MIT
// Stimuli on devices whose clock the test has: frames, and what makes a trial void. What a session that goes
// on takes from its table.
#include "study/session/stage.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <thread>
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
#include "sink/alsa/pcm_sink.hpp"
#include "study/bids/session_store.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/serial_port.hpp"
#include "study/session/sync_codes.hpp"
#include "synth/score/joined.hpp"

namespace stage_test {

using namespace tactor;
using session::environment;
using namespace tactor::test;

namespace {

constexpr std::size_t frame = 36; // bytes: nine channels of s32
constexpr double lead_s = 0.1;

const char* pairs = R"(
[experiment]
name = "pairs"
level = { dbfs = -20 }
gap_s = 0.0321
[[motion]]
name = "east"
path = "M0 20H40"
duration = 0.2
[[method]]
name = "a"
algorithm = "tactile-brush"
[[method]]
name = "b"
waveform = "triangle"
level_dbfs = -26
[[run]]
name = "r"
task = "choose"
attribute = "uniformity"
trials = 2
)";

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

environment nine_tactors(double longest_drive_s, double window_s, std::optional<double> power_dbfs = {})
{
    environment e;
    e.tactors = palm();
    e.config.limits.emplace();
    e.config.limits->power_dbfs = power_dbfs;
    e.config.limits->max_drive_s = longest_drive_s;
    e.config.limits->window_s = window_s;
    return e;
}

// A stage on a DAC that runs as fast as it can.
struct set_up {
    fake_dac dac;
    environment where;
    study::stage there;
    std::optional<running_clock> clock; // after the stage, which blocks the signals of threads to come

    explicit set_up(double longest_drive_s = 5.0, double window_s = 10.0,
                    std::optional<double> power_dbfs = {})
        : where(nine_tactors(longest_drive_s, window_s, power_dbfs)), there(nine(), {}, where, source(dac))
    {
        clock.emplace(dac, running_clock::capture_kind::kept);
    }

    static session::stream_source source(fake_dac& d)
    {
        return [&d](session::stream_parts& p) {
            p.open = [&d] { return alsa::adopt(d.pcm(), nine()); };
            p.player = patient(p.player.limits);
            p.player.realtime = false;
        };
    }
};

bool sounds(const std::vector<std::byte>& bytes)
{
    return std::any_of(bytes.begin(), bytes.end(), [](std::byte b) { return b != std::byte{0}; });
}

// Does something when the stimulus has sounded for a while. Until then the DAC goes on step by step, so that
// it is not over before, however late this thread gets its turn.
class meanwhile {
public:
    meanwhile(set_up& s, std::function<void()> act)
    {
        s.clock.reset();
        thread_ = std::thread([&s, act = std::move(act)] {
            const auto step = [&s] {
                if (s.dac.queued() >= 192)
                    s.dac.advance_queued(96);
                std::this_thread::yield();
            };
            while (!s.there.position().stroke)
                step();
            const std::size_t heard = s.dac.captured_frames();
            while (s.dac.captured_frames() <= heard + 960)
                step();
            act();
            s.clock.emplace(s.dac, running_clock::capture_kind::kept);
        });
    }
    ~meanwhile() { thread_.join(); }

private:
    std::thread thread_;
};

const study::stage::watcher nobody = [](std::uint64_t) {};

} // namespace

TEST_CASE("both stimuli of a pair are at their reported frames, the gap between them exact to the frame")
{
    set_up s;
    const auto d = study::read_definition(pairs, "pairs.toml", {});
    render_options o{.rate = rate, .level_dbfs = *d.level_dbfs};
    const study::stimulus_set stimuli(d, palm(), o);
    const auto gap = static_cast<std::size_t>(std::llround(0.0321 * rate));
    for (const study::planned_trial t : {study::planned_trial{0, 0, 1}, study::planned_trial{0, 1, 0}}) {
        const study::given_stimulus g = s.there.give(stimuli.make_score(t), lead_s, nobody);
        REQUIRE(g.flaw.empty());
        REQUIRE(g.first_frame);
        CHECK(g.xruns == 0);
        const study::stimulus& first = stimuli.at(0, t.method_1);
        const study::stimulus& second = stimuli.at(0, *t.method_2);
        CHECK(g.frames == first.frames + gap + second.frames);
        CHECK(stimuli.second(t) == first.frames + gap);
        const std::vector<std::byte> all = s.dac.captured();
        const auto piece = [&](std::size_t from, std::size_t n) {
            return part(all, from * frame, n * frame);
        };
        const auto alone = [&](const study::stimulus& x) {
            return rendered(score(palm(), x.plan, x.render), format_kind::s32);
        };
        CHECK(piece(*g.first_frame, first.frames) == alone(first));
        CHECK_FALSE(sounds(piece(*g.first_frame + first.frames, gap)));
        CHECK(piece(*g.first_frame + stimuli.second(t), second.frames) == alone(second));
        CHECK_FALSE(sounds(piece(*g.first_frame - rate / 10, rate / 10))); // the lead
    }
    s.there.finish();
}

TEST_CASE("a reported frame is right even without time for it")
{
    set_up s;
    const score music = random_score(3, 4);
    for (int i = 0; i < 5; ++i) {
        const study::given_stimulus g = s.there.give(music, 0.0, nobody);
        REQUIRE(g.flaw.empty());
        REQUIRE(g.first_frame);
        CHECK(part(s.dac.captured(), *g.first_frame * frame, music.frames() * frame) ==
              rendered(music, format_kind::s32));
    }
    s.there.finish();
}

TEST_CASE("an xrun makes it void, and the next is whole again")
{
    set_up s;
    {
        const meanwhile x(s, [&] { s.dac.advance(1'000'000); });
        const study::given_stimulus g = s.there.give(tone(0.5), lead_s, nobody);
        CHECK_FALSE(g.flaw.empty());
        CHECK(g.xruns == 1);
        REQUIRE(g.first_frame);
        CHECK(g.frames > 0);
        CHECK(g.frames < rate / 2);
    }
    CHECK_FALSE(s.there.lost());
    const study::given_stimulus next = s.there.give(tone(0.1), lead_s, nobody);
    CHECK(next.flaw.empty());
    CHECK(next.xruns == 0);
    s.there.finish();
}

TEST_CASE("a device that is lost makes it void, in the stimulus and while time passes")
{
    set_up s;
    {
        const meanwhile x(s, [&] { s.dac.disconnect(); });
        const study::given_stimulus g = s.there.give(tone(0.5), lead_s, nobody);
        CHECK(g.flaw == "the device is gone");
    }
    while (!s.there.lost())
        std::this_thread::yield();
    CHECK_FALSE(s.there.pass(1.0, [](double) { return true; }));
    CHECK(s.there.give(tone(0.1), lead_s, nobody).flaw == "the device is gone");
    s.there.finish();
}

TEST_CASE("a stimulus that a limit changed says so")
{
    set_up s(0.3); // for so long one tactor may be driven in ten seconds
    CHECK_FALSE(s.there.give(tone(0.1), 0.0, nobody).limited);
    const study::given_stimulus g = s.there.give(tone(0.5), 0.0, nobody);
    CHECK(g.flaw.empty());
    CHECK(g.limited);
    s.there.finish();
    set_up quiet(5.0, 10.0, -20.0); // of all tactors together, below the usual -12 dBFS of one
    CHECK_FALSE(quiet.there.give(tone(0.1, 0, {.level_dbfs = -30.0}), 0.0, nobody).limited);
    CHECK(quiet.there.give(tone(0.1), 0.0, nobody).limited);
    quiet.there.finish();
}

TEST_CASE("a stimulus that falls silent because of those before says so")
{
    set_up s(0.3, 3600.0); // an hour, on a DAC that does not wait for the test
    CHECK_FALSE(s.there.give(tone(0.25), 0.0, nobody).limited);
    // Its tactor is closed in the midst of this one, and still for the next.
    CHECK(s.there.give(tone(0.2), 0.0, nobody).limited);
    CHECK(s.there.give(tone(0.2), 0.0, nobody).limited);
    CHECK(s.there.give(tone(0.01), 0.0, nobody).limited);
    CHECK_FALSE(s.there.give(tone(0.2, 4), 0.0, nobody).limited);
    CHECK(s.there.make_room(tone(0.2), 0.1, [](double) { return false; })); // somebody ends it
    CHECK(s.there.give(tone(0.2), 0.1, nobody).limited);
    s.there.finish();
}

TEST_CASE("after a stimulus that a limit cut, the next one waits until it is whole")
{
    set_up s(0.3, 60.0);
    CHECK(s.there.give(tone(0.5), 0.0, nobody).limited);
    CHECK(s.there.make_room(tone(0.05), 0.1, [](double) { return true; }));
    CHECK_FALSE(s.there.give(tone(0.05), 0.1, nobody).limited);
    s.there.finish();
}

TEST_CASE("a stimulus that has waited for room is whole")
{
    set_up s(0.3, 60.0);
    for (int i = 0; i < 4; ++i) {
        CHECK(s.there.make_room(tone(0.25), 0.1, [](double) { return true; }));
        const study::given_stimulus g = s.there.give(tone(0.25), 0.1, nobody);
        CHECK(g.flaw.empty());
        CHECK_FALSE(g.limited);
    }
    s.there.finish();
}

TEST_CASE("a tactor that has rested before its device was lost needs no rest when it is back")
{
    std::vector<std::unique_ptr<fake_dac>> cards;
    std::unique_ptr<running_clock> clock;
    session::stream_options o;
    o.reopen_s = 3600.0;
    const environment where = nine_tactors(0.3, 6.0);
    study::stage there(nine(), o, where, [&](session::stream_parts& p) {
        p.open = [&] {
            clock.reset();
            cards.push_back(std::make_unique<fake_dac>());
            auto card = alsa::adopt(cards.back()->pcm(), nine());
            clock = std::make_unique<running_clock>(*cards.back());
            return card;
        };
        p.player = patient(p.player.limits);
        p.player.realtime = false;
        p.times.retry_s = p.times.proof_s = 0.001;
    });
    const auto waits = [&](double seconds) {
        bool waited = false;
        CHECK(there.make_room(tone(seconds), lead_s, [&](double) { return waited = true; }));
        return waited;
    };
    CHECK_FALSE(there.give(tone(0.25), lead_s, nobody).limited);
    CHECK(waits(0.25));
    CHECK(there.pass(6.0, [](double) { return true; }));
    CHECK_FALSE(waits(0.25));
    cards.back()->disconnect();
    while (!there.lost())
        std::this_thread::yield();
    REQUIRE(there.reopen());
    CHECK(cards.size() == 2);
    CHECK_FALSE(waits(0.25));
    there.finish();
    clock.reset();
}

TEST_CASE("a tactor of the walk that a limit silenced is driven again when it has rested")
{
    set_up s(0.3, 60.0);
    CHECK_FALSE(s.there.give(tone(0.25), 0.0, nobody).limited);
    bool waited = false;
    const study::given_stimulus g =
        s.there.give_after_limits(tone(0.2), [&](double) { return waited = true; });
    CHECK(g.fault().empty());
    CHECK(waited);
    // Nobody waits where no limit acts.
    CHECK(s.there.give_after_limits(tone(0.05), [&](double) -> bool { throw 1; }).fault().empty());
    s.there.finish();
}

TEST_CASE("what the experimenter cuts off says so")
{
    set_up s;
    const study::given_stimulus g =
        s.there.give(tone(100'000.0), 0.0, [&](std::uint64_t) { s.there.cancel(); });
    CHECK(g.flaw == "it was cut off");
    s.there.finish();
}

TEST_CASE("time passes by the stream alone")
{
    set_up s;
    const std::uint64_t before = s.there.position().played;
    double last = -1.0;
    CHECK(s.there.pass(0.5, [&](double t) {
        CHECK(t >= last);
        CHECK(t < 0.5);
        last = t;
        return true;
    }));
    CHECK(s.there.position().played >= before + rate / 2);
    CHECK(s.there.pass(1e9, [](double) { return false; })); // somebody ends it
    s.there.finish();
}

TEST_CASE("noise that stands still makes it void; noise whose device is gone is opened again")
{
    std::vector<std::unique_ptr<fake_dac>> headphones;
    std::vector<std::unique_ptr<running_clock>> clocks;
    set_up s;
    const auto open = [&] {
        headphones.push_back(std::make_unique<fake_dac>());
        fake_dac& d = *headphones.back();
        auto sink = alsa::adopt(d.pcm(), {.channels = 2, .period_frames = 480, .periods = 4});
        clocks.push_back(std::make_unique<running_clock>(d, running_clock::capture_kind::kept));
        return sink;
    };
    s.there.mask(open, {.level_dbfs = -20.0, .patience_s = 600.0});
    const auto give = [&] {
        const study::noise_around noise(s.there);
        return s.there.give(tone(0.5), lead_s, nobody);
    };
    CHECK(give().flaw.empty());
    CHECK(sounds(headphones[0]->captured()));
    {
        const meanwhile x(s, [&] {
            fake_dac& d = *headphones[0];
            d.advance(1'000'000);
            d.await([&] { return d.starts() == 2; });
            const std::size_t again = d.captured_frames();
            d.await([&] { return d.captured_frames() > again + 4800; });
        });
        CHECK(give().flaw == "the masking noise stopped");
    }
    {
        const meanwhile x(s, [&] {
            headphones[0]->disconnect();
            while (s.there.noise_ended() == io_kind::ok)
                std::this_thread::yield();
        });
        CHECK_FALSE(give().flaw.empty());
    }
    CHECK(headphones.size() == 1);
    CHECK(give().flaw.empty());
    CHECK(headphones.size() == 2);
    s.there.finish();
    clocks.clear();
}

namespace {

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
          store(study_files, {&p.definition.runs[0]}, study::describe_session(p, {}, ""), false)
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
    CHECK(codes.give(c.p.stimuli.make_score(t), practice, t, nobody).frames == c.p.stimuli.frames(t));
    codes.send(study::code_event::answer, practice, t, "1");
    std::uint64_t latest = 0;
    const study::given_stimulus g =
        codes.give(c.p.stimuli.make_score(t), step, t, [&](std::uint64_t frame) { latest = frame; });
    codes.send(study::code_event::answer, step, t, "1");
    codes.send(study::code_event::made_void, step, t);
    codes.finish();
    REQUIRE(g.flaw.empty());
    CHECK(latest <= c.p.stimuli.frames(t));
    CHECK(g.frames == c.p.stimuli.frames(t));

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
    CHECK(heard[1] == std::pair{42U, first + c.p.stimuli.second(t) - 9 * bit});
    CHECK(heard[2].first == 45);
    CHECK(heard[3].first == 47);
    for (const std::size_t method : {t.method_1, *t.method_2}) {
        const study::stimulus& s = c.p.stimuli.at(0, method);
        const std::uint64_t from = first + (method == t.method_1 ? 0 : c.p.stimuli.second(t));
        CHECK(part(all, from * frame, s.frames * frame) ==
              rendered(score(c.p.where.tactors, s.plan, s.render), format_kind::s32));
    }

    study::run_table table(c.store, c.p.definition.runs[0], false);
    study::trial_row row = study::planned_row(c.p, t, {1, 1});
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
        const study::given_stimulus g = codes.give(c.p.stimuli.make_score(t), step, t, nobody);
        CHECK_FALSE(g.flaw.empty());
        CHECK_FALSE(g.first_frame);
    }
    study::run_table table(c.store, c.p.definition.runs[0], false);
    study::trial_row row = study::planned_row(c.p, t, {1, 1});
    row.is_void = true;
    table.add(row, 0, rate);
    codes.write(c.p.definition.runs[0], row, table);
    const study::text_table events(c.files / "study/sub-01/beh/sub-01_task-r_events.tsv");
    REQUIRE(events.rows() == 1);
    CHECK(events.need(0, "event") == "broken");
    CHECK(events.need(0, "code") == "43");
    s.there.finish();
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
        pulse.expect(7, 9, std::numeric_limits<std::int64_t>::max());
        CHECK(pulse.set(true));
        CHECK(pulse.set(false));
        pulse.expect(7, 9, 0);
        CHECK(pulse.set(true));
    }
    CHECK(shown == std::vector<int>{0, -1, 7, -1, 0, -2, 9, -1, 0, -2});
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
        pulse.expect(7, 9, std::numeric_limits<std::int64_t>::max());
        CHECK(pulse.set(true));
        CHECK(pulse.set(false));
        pulse.expect(7, 9, 0);
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
        study::with_codes(how, c.p.where, lines)(p);
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
    CHECK(study::code_facts(*study::find_codes(c.p.where), c.p.codes)["serial"]["baud"] == 115200);
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
        CHECK(why(path) ==
              "a.toml:3: serial: " + path +
                  ": it is not a serial port (list the ports by ls /dev/serial/by-id /dev/ttyS*)");
    CHECK(files.bytes("file") == "as it was");
    CHECK(why("/dev/ttyNONE") ==
          "another kind: a.toml:3: serial: /dev/ttyNONE: No such file or directory (list the "
          "ports by ls /dev/serial/by-id /dev/ttyS*)");
}

TEST_CASE("codes that cannot be sent are refused by name before the session")
{
    CHECK(refusal("stimulus = 41", "stimulus = 255") ==
          "array.toml:6:8: code: there are 7 events, up to number 261 (void), but 255 is the largest "
          "(combine some under [sync.codes]: stimulus = { by = [\"motion\", \"method\"] })");
    CHECK(refusal("channel = 8, bit_ms = 1.5", "chip = \"c\", offsets = [1, 2, 3, 4, 5]") ==
          "array.toml:6:8: code: there are 7 events, up to number 47 (void), but 31 is the largest (use more "
          "lines, or combine some under [sync.codes]: stimulus = { by = [\"motion\", \"method\"] })");
    CHECK(
        refusal("channel = 8, bit_ms = 1.5", "chip = \"c\", offsets = [1, 2, 3, 4, 5, 6], pulse_ms = 250") ==
        "array.toml:6:8: code: pulse_ms is 250, but the answer's number may come 200 ms after the stimulus "
        "of motion \"east\" with method \"a\" begins (use a shorter pulse_ms, or longer stimuli)");
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
    study::trial_row row = study::planned_row(c.p, run.trials[0], {1, 1});
    row.response = "1";
    CHECK_FALSE(study::replay(c.p, run, {row}).done());
    for (std::string study::trial_row::*plan : {&study::trial_row::plan_1, &study::trial_row::plan_2}) {
        study::trial_row other = row;
        std::swap((other.*plan).front(), (other.*plan).back());
        REQUIRE(other.*plan != row.*plan);
        CHECK(caught_message([&] { study::replay(c.p, run, {other}); }).find("run r: line 2: trial 1") == 0);
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
        study::trial_row row = study::planned_row(c.p, t, {trial, attempt});
        // The value under test, not its standard, was the stronger one.
        study::set_response(row, r, row.method_1 == "a" ? 1 : 2, 0.5);
        row.is_void = is_void;
        held.add(step(trial, attempt), row, 0);
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

} // namespace stage_test
