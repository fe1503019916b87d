// SPDX-License-Identifier: MIT
/// \file
/// The devices that present stimuli to a person: the array, and the noise that hides its sound.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "session/environment.hpp"
#include "session/play_session.hpp"
#include "study/masking/masking.hpp"
#include "synth/score/drive_room.hpp"

namespace tactor::study {

/// Record of a presented stimulus.
struct given_stimulus {
    std::string flaw = {};                         ///< deviation from the plan; empty if there is none
    std::optional<std::uint64_t> first_frame = {}; ///< first frame in the stream; missing if nothing sounded
    std::uint64_t frames = 0;                      ///< number of frames that were played
    std::int64_t started_ns = 0;                   ///< CLOCK_MONOTONIC when the first frame is at the DAC
    std::int64_t ended_ns = 0;                     ///< CLOCK_MONOTONIC when the last frame is at the DAC
    unsigned xruns = 0;                            ///< number of xruns since the stimulus was requested
    bool limited = false;                          ///< true if limits of the array changed the stimulus

    /// Returns the reason why the stimulus is not valid: its flaw, or a limit. Returns an empty text if the
    /// stimulus is valid.
    std::string fault() const;
};

/// A session that plays on the array. A signal ends the session with an exception. For use by one thread.
class stage : public session::play_session {
public:
    /// Early end of a session.
    struct interruption {
        int signal;                       ///< signal number; 0 if nothing interrupted the session
        std::string_view by = "a signal"; ///< cause in messages
    };

    /// Opens the device. \throws error.
    stage(const alsa_options& device, const session::stream_options& o, const session::environment& e,
          const session::stream_source& source = {});

    using sink_opener = std::function<std::unique_ptr<sink>()>;
    /// From now on, plays masking noise around each stimulus. Throws the errors of `open` and of masker's
    /// constructor.
    void set_masking(sink_opener open, const masking_options& o);
    /// Plays the noise on the PCM with this name, in stereo.
    void set_masking(const std::string& pcm, const masking_options& o);

    /// Returns the delay, s, that a score starting in `lead_s` needs so that no tactor exceeds the limits of
    /// drive time. Takes earlier stimuli into account. Returns 0 if no delay helps.
    double needed_delay_s(const score& s, double lead_s) const;
    /// Blocks for the delay that needed_delay_s() returns. `watch` and the result are as for
    /// wait_for_seconds().
    bool wait_for_room(const score& s, double lead_s, const std::function<bool(double passed_s)>& watch);

    /// Function that is called about 25 times a second with the current frame of the stimulus.
    using watcher = std::function<void(std::uint64_t stimulus_frame)>;
    /// Plays a score. Masking noise, if any, starts before the score and continues after the score. Blocks
    /// until the score ends. \throws interruption; error if the noise's device cannot be opened again.
    given_stimulus play_score(const score& s, double lead_s, const watcher& watch);

    /// Plays a score as play_score() does. If a limit changed the score because earlier runs drove the
    /// tactors, waits until the tactors have rested, and plays the score once more. `watch`: as for
    /// wait_for_seconds().
    given_stimulus play_with_retry(const score& s, const std::function<bool(double passed_s)>& watch);

    /// Starts the noise, if any, and blocks until the noise has full level. The noise lasts until fade_out().
    /// Returns false if the noise does not play. Throws as play_score().
    bool fade_in();
    void fade_out() noexcept;

    /// Returns the reason why the noise ended; `ok` while it plays, or if there is no noise.
    io_kind noise_end_reason() const noexcept { return masker_ ? masker_->end_reason() : io_kind::ok; }

    /// Blocks until `seconds` of the stream's time have passed. Calls `watch` repeatedly with the time
    /// passed; `watch` returns false to stop early. Returns false if the stream ended meanwhile. \throws
    /// interruption.
    bool wait_for_seconds(double seconds, const std::function<bool(double passed_s)>& watch);
    /// Blocks until a descriptor is readable. \throws interruption.
    void wait_for(int descriptor);

    /// Blocks until the device comes back. Returns false if it does not. \throws interruption.
    bool reopen();
    /// Fades the noise out and ends the streams. \throws error if the amplifier may still be on.
    void finish();

private:
    void check_signal() const;

    sink_opener open_masker_ = {};
    masking_options masking_ = {};
    std::unique_ptr<masker> masker_; ///< null without noise
    synth::drive_room room_;
    std::uint64_t before_ = 0; ///< frames of earlier streams; the time between streams does not count
};

/// Guard that fades the noise out at the end of a trial, even after an exception.
class noise_around {
public:
    explicit noise_around(stage& s) : stage_(s) {}
    ~noise_around() { stage_.fade_out(); }
    noise_around(const noise_around&) = delete;
    noise_around& operator=(const noise_around&) = delete;

private:
    stage& stage_;
};

/// Calls `held`, which uses the stage, and then ends the stage's streams, even after an error. Returns the
/// interruption, with signal 0 if there was none.
/// Throws the exceptions of `held`, except stage::interruption.
template <typename Held>
[[nodiscard]] stage::interruption run_until_interrupted(stage& s, const Held& held)
{
    stage::interruption why{0};
    try {
        held();
    } catch (const stage::interruption& l) {
        why = l;
    } catch (const error&) {
        s.finish();
        throw;
    }
    s.finish();
    return why;
}

} // namespace tactor::study
