// SPDX-License-Identifier: MIT
/// \file
/// Numbers that mark the stimuli, answers and void trials of a session for an EEG amplifier: as pulse codes
/// on a spare channel, on GPIO lines, as bytes to a serial trigger box, in the Lab Streaming Layer; and as
/// lines of the events of a run.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/lines.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>

#include "amplifier/line.hpp"
#include "session/environment.hpp"
#include "study/bids/session_store.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/code_numbers.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

/// Returns the configuration's [sync] code; null: there is none.
const code_settings* find_codes(const session::environment& e);

/// Returns a warning if two events that are told apart have one number, because [sync.codes] says so; else
/// empty.
std::string find_shared_number(const code_numbers& all);

/// Returns the name, in messages, of the outputs that show numbers: "lines", "serial port" or both; empty if
/// there are none.
std::string_view name_outputs(const code_settings& c) noexcept;

/// Checks before a session that each code and each pulse is over before the next may come: a code on the
/// channel in the gap between two stimuli, a number on the lines or at a serial box within the shortest
/// stimulus, at whose end somebody may answer, a byte within its pulse, and a pulse or marker of [sync]
/// before the next stimulus. \throws error (bad_input).
void check_pulses(const session::environment& e, const experiment_definition& d, const stimulus_set& all,
                  unsigned rate);

/// Returns what session.json has of the codes.
nlohmann::ordered_json code_facts(const code_settings& c, const code_numbers& all);
/// Returns the description of the tables of events, with each number and its meaning; null without codes.
nlohmann::ordered_json describe_events(const prepared_experiment& p);

/// The outputs of the codes, GPIO lines and a serial box, as a line of sync pulses: each pulse shows the
/// number that is due, and switches another line along, if any.
class coded_pulse final : public enable_line {
public:
    coded_pulse(std::vector<std::unique_ptr<amplifier::code_lines>> outputs, std::unique_ptr<enable_line> out)
        : outputs_(std::move(outputs)), out_(std::move(out))
    {
    }
    ~coded_pulse() override { static_cast<void>(coded_pulse::set(false)); }

    /// Sets the number of the next pulses, and another one from a time of CLOCK_MONOTONIC on; 0: none.
    void expect(unsigned first, unsigned second, std::int64_t second_from_ns) noexcept;
    bool set(bool on) noexcept override;
    /// Shows a number at once, or none.
    bool show(unsigned number) noexcept;

private:
    std::vector<std::unique_ptr<amplifier::code_lines>> outputs_;
    std::unique_ptr<enable_line> out_;
    std::atomic<unsigned> first_{0};
    std::atomic<unsigned> second_{0};
    std::atomic<std::int64_t> second_from_ns_{0};
};

/// Returns a source that opens the outputs of the codes beside those of the stream, and sets `lines` to them;
/// they live as long as the stream. `o` and `e` must live until it is called.
session::stream_source with_codes(const session::stream_options& o, const session::environment& e,
                                  coded_pulse*& lines);

/// A stream of numbers to the Lab Streaming Layer, of its type "Markers", up to the end of the process; by
/// liblsl, which is loaded when it is asked for.
class lsl_markers {
public:
    /// Loads $PYLSL_LIB, or liblsl.so.2. \throws error (not_available) if it makes no stream.
    explicit lsl_markers(const std::string& source_id);

    /// Sends a number with a time of CLOCK_REALTIME.
    void push(unsigned number, std::int64_t at_ns) const;

private:
    double (*clock_)() = nullptr;
    int (*push_)(void*, const std::int32_t*, double, std::int32_t) = nullptr;
    void* outlet_ = nullptr;
};

/// The codes of one session; those of practice are not sent. Does nothing without [sync] code.
class sync_codes {
public:
    /// Without a stage nothing is sent, and the caller says when. `lines` may be null. All must live as long.
    sync_codes(const prepared_experiment& p, session_store& store, stage* there, coded_pulse* lines);

    /// Returns the frames that the code before a stimulus takes.
    std::uint64_t lead(const session_step& s) const { return code_ && !s.practice ? lead_ : 0; }

    /// Plays a trial's stimuli as stage::give() does, with their codes before them. The record is that of the
    /// stimuli alone. Throws as that.
    given_stimulus give(const score& stimuli, const session_step& s, const planned_trial& t,
                        const stage::watcher& watch);
    /// Begins to send the code of an event that is now: on the lines at once, on the channel after the
    /// buffer. finish() ends it.
    /// `response`: of an answer, as in the table.
    void send(code_event e, const session_step& s, const planned_trial& t, std::string_view response = {});

    /// Waits for the end of a code that send() began, if any, and notes it.
    void finish();

    /// Notes the codes of stimuli that began at a frame, of which so many frames were played.
    void note_stimuli(const session_step& s, const planned_trial& t, std::uint64_t frame_1,
                      std::uint64_t frames, std::int64_t ns);
    /// Notes the code of an answer or a void trial at a frame. `ns`: its CLOCK_REALTIME.
    void note(code_event e, const session_step& s, const planned_trial& t, std::string_view response,
              std::uint64_t frame, std::int64_t ns);
    /// Calls finish(); then writes what was noted as events of the trial.
    /// \throws error (runtime).
    void write(const run_definition& r, const trial_row& trial, const run_table& table);

private:
    struct sent {
        std::string_view event;
        unsigned number;
        std::uint64_t frame;    ///< at which the code begins
        std::uint64_t at_frame; ///< of the event itself
        std::int64_t at_ns;     ///< CLOCK_REALTIME
        std::uint64_t frames;   ///< length of the event
    };
    /// A code on its way.
    struct sending {
        sent code;
        std::chrono::steady_clock::time_point lines_until = {};
        std::optional<stroke_report> refused = {}; ///< by the stream
        session_step of = {};
    };
    /// Returns the stimulus in an interval, 1 or 2.
    coded_event find_stimulus(const session_step& s, const planned_trial& t, unsigned interval) const;
    unsigned number(const coded_event& e) const;
    /// Notes and says that a code was cut, so that the recorder may have another number.
    void note_broken(const session_step& s, const sent& code);
    score make(unsigned number) const;
    void note(const sent& s);

    const prepared_experiment& p_;
    session_store& store_;
    stage* there_;
    coded_pulse* lines_;
    const code_settings* code_;
    std::uint64_t lead_ = 0;
    std::optional<lsl_markers> lsl_ = {};
    std::optional<score> like_ = {}; ///< score that codes on the channel are like
    std::optional<sending> sending_ = {};
    std::vector<sent> noted_ = {};
};

} // namespace tactor::study
