// SPDX-License-Identifier: MIT
/// \file
/// A run that plays strokes on a device, one after the other. It blocks until its strokes or a signal end it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

#include "session/device.hpp"
#include "session/device_stream.hpp"
#include "session/log.hpp"
#include "session/process.hpp"

namespace tactor::session {

/// Facts about a run, without its strokes, for the report at its end.
struct run_facts {
    stream_setup device = {};
    player_stats stats = {}; ///< counters of all players of the run together
    unsigned reopened = 0;
    bool locked_memory = false;

    /// \throws error if the amplifier may be on.
    void check_amplifier() const;
};

/// Time between two updates of a drawing while a stroke plays, ms.
inline constexpr int frame_ms = 40;

/// Function that changes the parts of a stream, so that tests can simulate a device.
using stream_source = std::function<void(stream_parts&)>;

/// Time of the next call of the function that follow() calls.
struct look {
    int most_ms = 1000;  ///< maximum time until the next call
    int descriptor = -1; ///< descriptor that causes an earlier call when it is readable
};

class play_session {
public:
    /// Opens lines and device, sets up real time and starts the stream.
    /// \throws error.
    play_session(const alsa_options& device, const stream_options& o, const environment& e,
                 const stream_source& adapt = {});
    play_session(const play_session&) = delete;
    play_session& operator=(const play_session&) = delete;

    const stream_setup& setup() const noexcept { return stream_.setup(); }
    /// Returns the options of the constructor.
    const stream_options& run_options() const noexcept { return options_; }

    /// Hands a score to the stream. With stream_options::arm the score waits for the trigger instead of
    /// `start`. Returns a report if the stream has ended, else nothing. \throws error.
    std::optional<stroke_report> submit(const score& s, start_at start = start_at::now());
    /// Sets the score that follows the next submitted score, `frames` after the first frame of that score.
    /// follow() hands it to the stream once that frame is known, and the next submit() then takes it. `s`
    /// must live until it has been handed over; null if no score follows.
    void queue_next(const score* s, std::uint64_t frames) noexcept;
    /// Begins a live stroke.
    /// \throws error.
    live_stroke begin(const live_options& o);
    /// Follows the stroke to its end, or until a signal comes; see signal(). Calls `each`, if there is one,
    /// repeatedly.
    /// \throws exceptions of `each`.
    stroke_report follow(const std::function<look()>& each = {});
    /// Returns the stroke's frame at the DAC; nothing while it does not sound.
    std::optional<std::uint64_t> stroke_frame() const;
    /// Fades out the stroke.
    void cancel();
    /// Logs the end of a stroke.
    void log_end(std::string_view name, const stroke_report& r);

    /// Returns true if the device is gone or has failed; nothing plays until reopen().
    bool lost() const { return stream_.current() == nullptr || stream_.current()->ended().has_value(); }
    /// Returns true if the session waits for lost devices.
    bool waits() const noexcept { return options_.reopen_s > 0.0; }
    /// Waits for the device, up to stream_options::reopen_s. Returns false if the device did not come back, a
    /// signal came, or the amplifier may be on. \throws error (bad_input) for a device that cannot be opened.
    bool reopen();

    /// Waits until `descriptor` or `also` can be read (-1: no descriptor), or the time is over (-1: no
    /// limit). Returns false if a signal has come.
    bool wait_for(int descriptor, int timeout_ms = -1, int also = -1);

    /// Returns the position of the stream in frames, from 0 after each opening.
    player_position position() const;
    /// Returns player::drive_levels_s() of the stream that runs.
    std::vector<double> drive_levels_s() const;
    /// Returns the counters of all streams up to now.
    player_stats stats() const { return stream_.stats(); }
    bool locked_memory() const noexcept { return locked_; }

    /// Returns the signal that requested the end, or 0.
    int signal() const noexcept { return signal_; }

    /// Ends the stream in silence, warns if limits cut drives short, and returns facts for the report.
    run_facts finish();

private:
    stream_parts make_parts(alsa_options device, const stream_source& adapt);
    /// Logs the failure to open the device, if any.
    /// \throws error (bad_input) if the device can never be opened.
    void check_failure();
    /// Submits a score. Returns nothing if the stream has ended. \throws error.
    std::optional<stroke_id> hand_over(const score& s, start_at start);
    /// Hands the score of queue_next() to the stream if `first`, the first frame of the current stroke, is
    /// known.
    void submit_follower(std::optional<std::uint64_t> first);

    stream_options options_;
    const environment& environment_;
    std::string pcm_;
    interrupt stop_;
    session_log log_;
    bool locked_ = false;
    device_stream stream_;
    stroke_id playing_ = {};
    const score* follower_ = nullptr; ///< score of queue_next(), not handed to the stream yet
    std::uint64_t follows_after_ = 0; ///< frames from the first frame of the stroke to that of the follower
    std::optional<stroke_id> followed_by_ = {}; ///< follower that the running stream has
    unsigned reopened_ = 0;
    int signal_ = 0;
};

} // namespace tactor::session
