// SPDX-License-Identifier: MIT
#include "study/session/sync_codes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <dlfcn.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "rt/clock.hpp"
#include "rt/system_files.hpp"
#include "session/piece.hpp"
#include "session/say.hpp"
#include "study/session/serial_port.hpp"
#include "synth/score/joined.hpp"

namespace tactor::study {
namespace {

// Name of the event in which a code was cut short.
constexpr std::string_view broken = "broken";

std::uint64_t bit_frames(const code_settings& c, unsigned rate)
{
    return static_cast<std::uint64_t>(std::max(1LL, std::llround(c.bit_s * rate)));
}

// Returns the length of a code on the channel, in frames; 0 without a channel.
std::uint64_t code_frames(const code_settings& c, unsigned rate)
{
    return c.channel ? synth::code_bits * bit_frames(c, rate) : 0;
}

} // namespace

const code_settings* find_codes(const session::environment& e)
{
    return e.config.sync && e.config.sync->code ? &*e.config.sync->code : nullptr;
}

std::string_view name_outputs(const code_settings& c) noexcept
{
    if (c.offsets.empty())
        return c.serial.empty() ? "" : "serial port";
    return c.serial.empty() ? "lines" : "lines and serial port";
}

std::string shared_number_warning(const code_numbers& all)
{
    for (const auto& [number, meanings] : all.meanings())
        if (meanings.size() > 1)
            return fmt::format("[sync.codes]: number {} marks several events: {}", number,
                               fmt::join(meanings, "; "));
    return {};
}

void check_pulses(const session::environment& e, const experiment_definition& d, const stimulus_set& all,
                  unsigned rate)
{
    if (!e.config.sync)
        return;
    const sync_settings& sync = *e.config.sync;
    const code_settings* const c = find_codes(e);
    const bool are_pairs = std::ranges::any_of(d.runs, [](const auto& r) { return r.stimuli > 1; });
    const std::uint64_t lead = c != nullptr ? code_frames(*c, rate) : 0;
    if (are_pairs && d.gap_s * rate < static_cast<double>(lead))
        throw error(error_kind::bad_input, c->where,
                    fmt::format("code: it takes {:.4g} s, but the gap between two stimuli is {} s",
                                static_cast<double>(lead) / rate, d.gap_s),
                    "use a longer gap_s in the definition, or a shorter bit_ms");
    const stimulus& shortest = *std::ranges::min_element(all.all(), {}, &stimulus::frames);
    const double shortest_s = static_cast<double>(shortest.frames) / rate;
    const auto check = [&](double pulse_s, double most_s, std::string_view next, const auto& where,
                           std::string_view what) {
        if (pulse_s > most_s)
            throw error(error_kind::bad_input, where,
                        fmt::format("{}pulse_ms is {:.4g}, but {} may come {:.4g} ms after the start of "
                                    "motion \"{}\" with method \"{}\"",
                                    what, pulse_s * 1e3, next, most_s * 1e3, d.motions[shortest.motion].name,
                                    d.methods[shortest.method].name),
                        "use a shorter pulse_ms, or longer stimuli");
    };
    const bool has_outputs = c != nullptr && !name_outputs(*c).empty();
    if (has_outputs)
        check(c->pulse_s, shortest_s, "the answer's number", c->where, "code: ");
    constexpr double bits = 10.0; // bits of a byte, including start and stop
    if (c != nullptr && !c->serial.empty() && c->pulse_s < bits / c->baud)
        throw error(error_kind::bad_input, c->where,
                    fmt::format("code: pulse_ms is {:.4g}, but a byte takes {:.4g} ms at {} baud",
                                c->pulse_s * 1e3, bits / c->baud * 1e3, c->baud),
                    "use a longer pulse_ms, or a greater baud");
    const double rest_s = are_pairs ? std::min(d.gap_s, stimulus_lead_s) : stimulus_lead_s;
    if (sync.channel || (sync.out && !has_outputs))
        check(sync.pulse_s, shortest_s + rest_s, "the next pulse", "[sync] out", "");
}

nlohmann::ordered_json describe_events(const prepared_experiment& p)
{
    nlohmann::ordered_json j;
    const code_settings* const c = find_codes(p.where);
    if (c == nullptr)
        return j;
    const auto column = [&](const char* name, const char* text) { j[name]["Description"] = text; };
    column("onset", "Time of the event since the run's first sample at the DAC; for an answer, the time when "
                    "the program received it");
    j["onset"]["Units"] = j["duration"]["Units"] = "s";
    column("duration", "Duration of the stimulus; 0 for other events");
    column("trial", "Trial of the run's table");
    column("attempt", "Attempt of the run's table");
    column("event", "What happened");
    j["event"]["Levels"] = {{"stimulus", "a stimulus began"},
                            {"standard", "a stimulus with the standard's value began"},
                            {"catch", "a trial without a stimulus began"},
                            {"answer", "the participant answered"},
                            {"void", "the trial was made void"},
                            {broken, "a code was cut short: the recorder may have another number"}};
    column("code", "Number that was sent");
    for (const auto& [number, meanings] : p.codes.meanings())
        j["code"]["Levels"][fmt::format("{}", number)] = fmt::format("{}", fmt::join(meanings, "; "));
    column("frame", c->channel ? "Frame of the stream at which the start bit begins; the code ends where the "
                                 "stimulus begins, frame_1 or frame_2 of the run's table"
                               : "Frame of the stream at which the lines switch, or the byte is sent");
    return j;
}

void coded_pulse::set_next_numbers(std::span<const due_number> numbers) noexcept
{
    for (std::size_t i = 0; i < most_stimuli; ++i) {
        const due_number& n = numbers[std::min(i, numbers.size() - 1)];
        due_[i].number = n.number;
        due_[i].from_ns = n.from_ns;
    }
}

bool coded_pulse::set(bool on) noexcept
{
    const std::int64_t now_ns = rt::monotonic_ns();
    unsigned due = 0;
    for (const due_code& one : due_)
        if (one.from_ns <= now_ns)
            due = one.number;
    const bool done = show(on ? due : 0);
    return (!out_ || out_->set(on)) && done;
}

bool coded_pulse::show(unsigned number) noexcept
{
    bool done = true;
    for (const auto& one : outputs_)
        done = one->set(number) && done;
    return done;
}

session::stream_source make_code_source(const session::stream_options& o, const session::environment& e,
                                        coded_pulse*& lines)
{
    return [&o, &e, &lines](session::stream_parts& p) {
        const code_settings* const c = find_codes(e);
        std::vector<std::unique_ptr<amplifier::code_lines>> own;
        if (c != nullptr && !c->offsets.empty() && !o.no_gpio)
            own.push_back(amplifier::open_code_lines(c->chip, c->offsets, c->where));
        if (c != nullptr && !c->serial.empty())
            own.push_back(open_serial_port(c->serial, c->baud, c->where));
        if (own.empty())
            return;
        p.lines.change_sync(
            [&](std::unique_ptr<enable_line> out) {
                auto pulse = std::make_unique<coded_pulse>(std::move(own), std::move(out));
                lines = pulse.get();
                return pulse;
            },
            c->pulse_s);
    };
}

lsl_markers::lsl_markers(const std::string& source_id)
{
    const std::string named = rt::variable("PYLSL_LIB");
    const std::string file = named.empty() ? "liblsl.so.2" : named;
    void* const library = ::dlopen(file.c_str(), RTLD_NOW);
    const auto find = [&]<class F>(F*& function, const char* name) {
        function = library != nullptr ? reinterpret_cast<F*>(::dlsym(library, name)) : nullptr;
        return function != nullptr;
    };
    void* (*make_info)(const char*, const char*, std::int32_t, double, int, const char*) = nullptr;
    void* (*make_outlet)(void*, std::int32_t, std::int32_t) = nullptr;
    const bool found = find(clock_, "lsl_local_clock") && find(push_, "lsl_push_sample_itp") &&
                       find(make_info, "lsl_create_streaminfo") && find(make_outlet, "lsl_create_outlet");
    const char* const cause = found ? nullptr : ::dlerror();
    constexpr int int32 = 4;        // cft_int32 of liblsl
    constexpr int buffered_s = 360; // usual value for liblsl
    if (found)
        outlet_ =
            make_outlet(make_info("tactor", "Markers", 1, 0.0, int32, source_id.c_str()), 0, buffered_s);
    if (outlet_ == nullptr)
        throw error(
            error_kind::not_available, "[sync] code lsl",
            cause != nullptr ? cause : file + " cannot make a stream",
            "install liblsl from the Lab Streaming Layer's releases, or leave out lsl in [sync] code");
}

void lsl_markers::push(unsigned number, std::int64_t at_ns) const
{
    const auto sample = static_cast<std::int32_t>(number);
    const double ago_s = static_cast<double>(rt::unix_ns() - at_ns) * 1e-9;
    push_(outlet_, &sample, clock_() - ago_s, 1);
}

sync_codes::sync_codes(const prepared_experiment& p, session_store& store, stage* there, coded_pulse* lines)
    : p_(p), store_(store), there_(there), lines_(lines), code_(find_codes(p.where))
{
    if (code_ == nullptr)
        return;
    lead_ = code_frames(*code_, p.render.rate);
    if (const stimulus& any = p.stimuli.all().front(); code_->channel && there != nullptr)
        like_ = session::make_score(any.made, p.where.tactors, any.render);
    if (code_->lsl && there != nullptr)
        lsl_.emplace("tactor-" + p.participant);
    if (there != nullptr && !code_->channel && lines == nullptr && !lsl_)
        code_ = nullptr; // the only outputs are lines, which are not open
}

coded_event sync_codes::find_stimulus_event(const session_step& s, const planned_trial& t,
                                            unsigned place) const
{
    const std::size_t method = t.list_methods().at(place - 1);
    return {find_event(p_.definition.methods[method]), &p_.run_at(s.run), t.motion, method, place};
}

score sync_codes::make(unsigned number) const
{
    return synth::make_code(*like_, *code_->channel, bit_frames(*code_, p_.render.rate), number);
}

void sync_codes::count_pulses(const player_stats& before, const player_stats& now)
{
    const auto sum_s = [](const player_stats& s) {
        return s.sync_mean_late_s * static_cast<double>(s.sync_pulses);
    };
    const std::uint64_t more = now.sync_pulses - before.sync_pulses;
    const double late_s = sum_s(now) - sum_s(before);
    for (listed_pulses* const p : {&in_stream_, &in_session_}) {
        p->missed += now.sync_missed - before.sync_missed;
        if (more == 0)
            continue;
        const auto n = static_cast<double>(more);
        p->sent += more;
        p->mean_late_s += (late_s - n * p->mean_late_s) / static_cast<double>(p->sent);
        p->worst_late_s = std::max(p->worst_late_s, late_s / n);
    }
}

given_stimulus sync_codes::play_stimuli(const score& stimuli, const session_step& s, const planned_trial& t,
                                        const stage::watcher& watch)
{
    const std::uint64_t lead = this->count_lead_frames(s);
    const bool sends = code_ != nullptr && !s.practice;
    const std::vector<std::uint64_t> begin = p_.stimuli.starts(t);
    std::vector<unsigned> numbers;
    for (unsigned place = 1; place <= begin.size(); ++place)
        numbers.push_back(sends ? p_.codes.find_number(p_.definition, find_stimulus_event(s, t, place)) : 0);
    std::vector<synth::placed_score> parts{{stimuli, lead}};
    for (std::size_t i = 0; lead > 0 && i < begin.size(); ++i)
        parts.push_back({make(numbers[i]), begin[i]});
    const double rate = p_.render.rate;
    if (lines_ != nullptr) {
        there_->fade_in(); // first, because a fade takes an unknown time
        // Changes the number halfway between the starts of two stimuli, so that a late pulse still shows the
        // right number.
        const double first_s = stimulus_lead_s + there_->setup().buffer_frames / rate;
        std::vector<due_number> due{{numbers[0], 0}};
        for (std::size_t i = 1; i < begin.size(); ++i) {
            const double from_s = first_s + static_cast<double>(begin[i - 1] + begin[i]) / 2.0 / rate;
            due.push_back({numbers[i], rt::monotonic_ns() + std::llround(from_s * 1e9)});
        }
        lines_->set_next_numbers(due);
    }
    // Counts often enough to tell the pulses of a trial apart, so that the worst one is known.
    const std::uint64_t missed = in_session_.missed;
    player_stats counted = there_->stats();
    const auto count = [&] {
        player_stats now = there_->stats();
        if (sends && lines_ != nullptr)
            count_pulses(counted, now);
        counted = std::move(now);
    };
    given_stimulus g =
        there_->play_score(lead > 0 ? synth::join_scores(parts) : stimuli,
                           stimulus_lead_s - static_cast<double>(lead) / rate, [&](std::uint64_t frame) {
                               watch(frame - std::min(frame, lead));
                               count();
                           });
    count();
    // A code comes before its stimulus, and the first code delays all stimuli by `lead`. So each code begins
    // at the frame at which its stimulus would begin without codes.
    const std::uint64_t played = g.frames;
    const auto find_cut = [&](std::uint64_t begins, unsigned number) {
        if (!g.first_frame || played <= begins || played >= begins + lead)
            return;
        const std::uint64_t at = *g.first_frame + begins;
        const std::int64_t ns = g.started_ns + std::llround(static_cast<double>(begins) / rate * 1e9);
        report_broken_code(s, {broken, number, at, at, rt::unix_ns() - (rt::monotonic_ns() - ns), 0});
    };
    for (std::size_t i = 0; i < begin.size(); ++i)
        find_cut(begin[i], numbers[i]);
    g.frames -= std::min(g.frames, lead);
    g.started_ns += std::llround(static_cast<double>(lead) / rate * 1e9);
    if (g.first_frame)
        g.first_frame = g.frames > 0 || lead == 0 ? std::optional(*g.first_frame + lead) : std::nullopt;
    if (sends && g.first_frame)
        note_stimuli(s, t, *g.first_frame, g.frames, rt::unix_ns() - (rt::monotonic_ns() - g.started_ns));
    if (in_session_.missed != missed)
        session::say(stderr, "tactor: {}: trial {}: the {} failed or were too late for a code\n",
                     p_.run_at(s.run).outline.name, s.which.trial, name_outputs(*code_));
    return g;
}

void sync_codes::send(code_event e, const session_step& s, const planned_trial& t, std::string_view response)
{
    if (code_ == nullptr || s.practice || there_->lost())
        return;
    finish();
    const unsigned n =
        p_.codes.find_number(p_.definition, {e, &p_.run_at(s.run), t.motion, t.method_1, 1, response});
    const std::uint64_t now = there_->position().played;
    sending_ = sending{sent{to_string(e), n, now, now, rt::unix_ns(), 0}};
    sending_->of = s;
    sending_->lines_until =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                               std::chrono::duration<double>(code_->pulse_s));
    if (lines_ != nullptr && !lines_->show(n))
        session::say(stderr, "tactor: the {} did not accept a code\n", name_outputs(*code_));
    if (code_->channel) {
        sending_->code.frame += there_->setup().buffer_frames;
        sending_->refused = there_->submit(make(n), start_at::frame(sending_->code.frame));
    }
}

void sync_codes::finish()
{
    if (!sending_)
        return;
    sent code = sending_->code;
    const session_step of = sending_->of;
    bool is_sent = true;
    bool is_broken = false;
    if (code_->channel) {
        const stroke_report r = sending_->refused ? *sending_->refused : there_->follow();
        is_sent = r.state == state_kind::finished;
        is_broken = !is_sent && r.frames > 0;
        code.frame += static_cast<std::uint64_t>(std::llround(r.late_s * p_.render.rate));
    }
    if (lines_ != nullptr) {
        std::this_thread::sleep_until(sending_->lines_until);
        lines_->show(0);
    }
    sending_.reset();
    if (is_sent)
        note(code);
    code.event = broken;
    if (is_broken)
        report_broken_code(of, code);
}

void sync_codes::report_broken_code(const session_step& s, const sent& code)
{
    session::say(stderr,
                 "tactor: {}: trial {}: the code {} was cut short: the recorder may have another number\n",
                 p_.run_at(s.run).outline.name, s.which.trial, code.number);
    noted_.push_back(code);
}

void sync_codes::note_stimuli(const session_step& s, const planned_trial& t, std::uint64_t frame_1,
                              std::uint64_t frames, std::int64_t ns)
{
    if (code_ == nullptr)
        return;
    const stimulus_set& all = p_.stimuli;
    unsigned place = 0;
    for (const std::uint64_t begins : all.starts(t)) {
        if (++place > 1 && frames <= begins)
            return;
        const coded_event e = find_stimulus_event(s, t, place);
        const std::uint64_t frame = frame_1 + begins;
        const auto later = std::llround(static_cast<double>(begins) / p_.render.rate * 1e9);
        note({to_string(e.event), p_.codes.find_number(p_.definition, e), frame - lead_, frame, ns + later,
              all.at(e.motion, e.method).frames});
    }
}

void sync_codes::note(code_event e, const session_step& s, const planned_trial& t, std::string_view response,
                      std::uint64_t frame, std::int64_t ns)
{
    if (code_ != nullptr)
        note({to_string(e),
              p_.codes.find_number(p_.definition, {e, &p_.run_at(s.run), t.motion, t.method_1, 1, response}),
              frame, frame, ns, 0});
}

void sync_codes::note(const sent& s)
{
    if (lsl_)
        lsl_->push(s.number, s.at_ns);
    noted_.push_back(s);
}

void sync_codes::write(const run_definition& r, const trial_row& trial, const run_table& table)
{
    finish();
    for (const sent& s : std::exchange(noted_, {}))
        store_.append_event(
            r, {{"onset",
                 fmt::format("{:.6f}", table.onset_s(trial.stream, s.at_frame, s.at_ns, p_.render.rate))},
                {"duration", fmt::format("{:.6f}", static_cast<double>(s.frames) / p_.render.rate)},
                {"trial", fmt::format("{}", trial.trial)},
                {"attempt", fmt::format("{}", trial.attempt)},
                {"event", std::string(s.event)},
                {"code", fmt::format("{}", s.number)},
                {"frame", fmt::format("{}", s.frame)}});
}

} // namespace tactor::study
