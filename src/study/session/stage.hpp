// SPDX-License-Identifier: MIT
/// \file
/// The devices that give stimuli to a person: the array, and the noise that hides its sound.
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

/// Record of a stimulus that was given.
struct given_stimulus {
    std::string flaw = {};                         ///< deviation from the plan; empty: none
    std::optional<std::uint64_t> first_frame = {}; ///< of the stream; none: it never sounded
    std::uint64_t frames = 0;                      ///< of it that were played
    std::int64_t started_ns = 0;                   ///< CLOCK_MONOTONIC of its first frame at the DAC
    std::int64_t ended_ns = 0;                     ///< and of its last
    unsigned xruns = 0;                            ///< since the request
    bool limited = false;                          ///< limits of the array changed it

    /// Returns the reason why it does not count: its flaw, or that it was limited; empty: it counts.
    std::string fault() const;
};

/// A session on the array that a signal ends by an exception. One thread.
class stage : public session::play_session {
public:
    /// Early end of a session.
    struct interruption {
        int signal;                       ///< 0: the session was not interrupted
        std::string_view by = "a signal"; ///< what ended it, for messages
    };

    /// Opens the device. \throws error.
    stage(const alsa_options& device, const session::stream_options& o, const session::environment& e,
          const session::stream_source& source = {});

    using sink_opener = std::function<std::unique_ptr<sink>()>;
    /// Plays noise around each stimulus from now on. \throws error as masker, and what the opener throws.
    void mask(sink_opener open, const masking_options& o);
    /// Plays it on the PCM of this name, in stereo.
    void mask(const std::string& pcm, const masking_options& o);

    /// Returns how long a score that is to begin in `lead_s` has to wait, so that no tactor is driven for
    /// longer than the limits allow, together with the stimuli before.
    double room_s(const score& s, double lead_s) const;
    /// Lets that time pass, as pass().
    bool make_room(const score& s, double lead_s, const std::function<bool(double passed_s)>& watch);

    /// Called some 25 times a second with the stimulus' current frame.
    using watcher = std::function<void(std::uint64_t stimulus_frame)>;
    /// Plays a score. Masking noise, if any, sounds before it and goes on after it. \throws interruption;
    /// error if the noise's device cannot be opened again.
    given_stimulus give(const score& s, double lead_s, const watcher& watch);

    /// Plays a score as give(). If a limit changed it, because earlier runs drove the tactors, lets these
    /// rest completely and plays it once more. `watch`: as of pass().
    given_stimulus give_after_limits(const score& s, const std::function<bool(double passed_s)>& watch);

    /// Begins noise until fade_out(). Returns false if it does not sound. \throws as give().
    bool fade_in();
    void fade_out() noexcept;

    /// Reason for the end of the noise; `ok` while it goes on, and without noise.
    io_kind noise_ended() const noexcept { return masker_ ? masker_->ended() : io_kind::ok; }

    /// Lets so much of the stream's time pass; the watcher gets the time passed and returns false to stop
    /// early. Returns false if the stream has ended meanwhile. \throws interruption.
    bool pass(double seconds, const std::function<bool(double passed_s)>& watch);
    /// Waits for a descriptor. \throws interruption.
    void wait_for(int descriptor);

    /// Waits for the device to come back. Returns false if it did not. \throws interruption.
    bool reopen();
    /// Ends the streams in silence. \throws error if the amplifier may be on.
    void finish();

private:
    void check_signal() const;

    sink_opener open_masker_ = {};
    masking_options masking_ = {};
    std::unique_ptr<masker> masker_; ///< null: no noise
    synth::drive_room room_;
    std::uint64_t before_ = 0; ///< frames of earlier streams; the time between streams does not count
};

/// Guard that ends the noise, however the trial ends.
class noise_around {
public:
    explicit noise_around(stage& s) : stage_(s) {}
    ~noise_around() { stage_.fade_out(); }
    noise_around(const noise_around&) = delete;
    noise_around& operator=(const noise_around&) = delete;

private:
    stage& stage_;
};

/// Calls `held`, which uses the stage, and ends its streams in each case. Returns the early end, if any.
/// \throws what `held` throws, except stage::interruption.
template <typename Held>
[[nodiscard]] stage::interruption until_interrupted(stage& s, const Held& held)
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
