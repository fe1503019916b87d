// SPDX-License-Identifier: MIT
/// \file
/// Codes: numbers that mark the stimuli, answers and void trials of a session for an EEG amplifier. They are
/// sent as pulse codes on a spare channel, on GPIO lines, as bytes to a serial trigger box, and to the Lab
/// Streaming Layer. The table of events of a run contains them, too.
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
#include "study/session/session_record.hpp"
#include "study/session/stage.hpp"

namespace tactor::study {

/// Returns the configuration's [sync] code; null if there is none.
const code_settings* find_codes(const session::environment& e);

/// Returns a warning if [sync.codes] gives two different events the same number, else an empty text.
std::string shared_number_warning(const code_numbers& all);

/// Returns the name of the outputs that show numbers, for messages: "lines", "serial port" or both; empty if
/// there are none.
std::string_view name_outputs(const code_settings& c) noexcept;

/// Checks before a session that each code and each pulse ends before the next one. A code on the channel must
/// fit into the gap between two stimuli. A number on the lines or at a serial box must fit into the shortest
/// stimulus, because an answer may come when the stimulus ends. A byte must fit into a pulse. A pulse or
/// marker of [sync] must end before the next stimulus. \throws error (bad_input).
void check_pulses(const session::environment& e, const experiment_definition& d, const stimulus_set& all,
                  unsigned rate);

/// Returns the description of the tables of events, with each number and its meaning; null without codes.
nlohmann::ordered_json describe_events(const prepared_experiment& p);

/// Number that pulses show from a given time on.
struct due_number {
    unsigned number = 0;      ///< 0 for none
    std::int64_t from_ns = 0; ///< CLOCK_MONOTONIC
};

/// Outputs of the codes (GPIO lines, a serial box), which replace the line of sync pulses. Each pulse shows
/// the number that is due. It also switches the line `out`, if any.
class coded_pulse final : public enable_line {
public:
    coded_pulse(std::vector<std::unique_ptr<amplifier::code_lines>> outputs, std::unique_ptr<enable_line> out)
        : outputs_(std::move(outputs)), out_(std::move(out))
    {
    }
    ~coded_pulse() override { static_cast<void>(coded_pulse::set(false)); }

    /// Sets the numbers for the next pulses, in the order of their times. \pre one to most_stimuli numbers
    void set_next_numbers(std::span<const due_number> numbers) noexcept;
    bool set(bool on) noexcept override;
    /// Sets the outputs to a number at once; 0 clears them.
    bool show(unsigned number) noexcept;

private:
    std::vector<std::unique_ptr<amplifier::code_lines>> outputs_;
    std::unique_ptr<enable_line> out_;
    struct due_code {
        std::atomic<unsigned> number{0};
        std::atomic<std::int64_t> from_ns{0};
    };
    std::array<due_code, most_stimuli> due_ = {};
};

/// Returns a stream source that opens the outputs of the codes and adds them to the stream's lines. Sets
/// `lines` to these outputs, if any; they exist as long as the stream. All arguments must live until the
/// source is called.
session::stream_source make_code_source(const session::stream_options& o, const session::environment& e,
                                        coded_pulse*& lines);

/// A stream of numbers in the Lab Streaming Layer, with type "Markers". It lasts until the process ends. Only
/// the constructor loads liblsl, so that sessions without such a stream do not need the library.
class lsl_markers {
public:
    /// Loads the library $PYLSL_LIB, or liblsl.so.2, and opens the stream. \throws error (not_available) if
    /// that fails.
    explicit lsl_markers(const std::string& source_id);

    /// Sends a number with its time, CLOCK_REALTIME.
    void push(unsigned number, std::int64_t at_ns) const;

private:
    double (*clock_)() = nullptr;
    int (*push_)(void*, const std::int32_t*, double, std::int32_t) = nullptr;
    void* outlet_ = nullptr;
};

/// The codes of one session. Practice trials have no codes. Without [sync] code this class does nothing.
class sync_codes {
public:
    /// Prepares the codes. Without a stage (`there` is null) this class sends nothing, and the caller must
    /// note each code with its time. `lines` may be null. All arguments must outlive this object.
    sync_codes(const prepared_experiment& p, session_store& store, stage* there, coded_pulse* lines);

    /// Returns the length of the code before a stimulus, in frames; 0 without a code on the channel.
    std::uint64_t count_lead_frames(const session_step& s) const { return code_ && !s.practice ? lead_ : 0; }

    /// Plays a trial's stimuli as stage::play_score() does, and sends the code of each stimulus. The returned
    /// record covers only the stimuli, not the codes. Throws as stage::play_score().
    given_stimulus play_stimuli(const score& stimuli, const session_step& s, const planned_trial& t,
                                const stage::watcher& watch);
    /// Starts to send the code of an event that happens now. Lines show the code at once; on the channel the
    /// code plays after the frames in the device's buffer. Call finish() to complete the code. `response`:
    /// for an answer, the response as in the run's table.
    void send(code_event e, const session_step& s, const planned_trial& t, std::string_view response = {});

    /// Completes the code that send() started, if any: blocks until the code ends, and notes the code.
    void finish();

    /// Starts to count the pulses of a new stream.
    void begin_stream() { in_stream_ = {}; }
    /// Return the pulses that showed numbers of stimuli: those of the stream, and those of all streams.
    const listed_pulses& stream_pulses() const noexcept { return in_stream_; }
    const listed_pulses& pulses() const noexcept { return in_session_; }

    /// Notes the code of each stimulus of a trial, if the stimulus began to play. `frame_1`: first frame of
    /// the first stimulus. `frames`: number of frames of the trial that were played. `ns`: CLOCK_REALTIME of
    /// `frame_1`.
    void note_stimuli(const session_step& s, const planned_trial& t, std::uint64_t frame_1,
                      std::uint64_t frames, std::int64_t ns);
    /// Notes the code of an answer or a void trial at a frame. `ns`: CLOCK_REALTIME of the frame.
    void note(code_event e, const session_step& s, const planned_trial& t, std::string_view response,
              std::uint64_t frame, std::int64_t ns);
    /// Calls finish(), then writes the noted codes as events of the trial.
    /// \throws error (runtime).
    void write(const run_definition& r, const trial_row& trial, const run_table& table);

private:
    struct sent {
        std::string_view event;
        unsigned number;
        std::uint64_t frame;    ///< first frame of the code
        std::uint64_t at_frame; ///< frame of the event
        std::int64_t at_ns;     ///< time of the event, CLOCK_REALTIME
        std::uint64_t frames;   ///< length of the event
    };
    /// A code that is being sent.
    struct sending {
        sent code;
        std::chrono::steady_clock::time_point lines_until = {};
        std::optional<stroke_report> refused = {}; ///< report, if the stream refused the code
        session_step of = {};
    };
    /// Returns the event of a stimulus. `place`: place of the stimulus in the trial, from 1.
    coded_event find_stimulus_event(const session_step& s, const planned_trial& t, unsigned place) const;
    /// Notes and reports a code that was cut short: the recorder may have read another number.
    void report_broken_code(const session_step& s, const sent& code);
    score make(unsigned number) const;
    /// Counts the pulses between two times.
    void count_pulses(const player_stats& before, const player_stats& now);
    void note(const sent& s);

    const prepared_experiment& p_;
    session_store& store_;
    stage* there_;
    coded_pulse* lines_;
    const code_settings* code_;
    std::uint64_t lead_ = 0;
    std::optional<lsl_markers> lsl_ = {};
    std::optional<score> like_ = {}; ///< template for the scores of codes on the channel
    std::optional<sending> sending_ = {};
    std::vector<sent> noted_ = {};
    listed_pulses in_stream_ = {};
    listed_pulses in_session_ = {};
};

} // namespace tactor::study
