// SPDX-License-Identifier: MIT
/// \file
/// Where stimuli are given to somebody: the array, and the noise that hides its sound.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "session/environment.hpp"
#include "session/play_session.hpp"
#include "study/masking/masker.hpp"
#include "synth/score/drive_room.hpp"

namespace tactor::study {

/// How a stimulus was given.
struct given_stimulus {
    std::string flaw = {};                         ///< why it was not as planned; empty: it was
    std::optional<std::uint64_t> first_frame = {}; ///< of the stream; none: it never sounded
    std::uint64_t frames = 0;                      ///< of it that were played
    std::int64_t started_ns = 0;                   ///< CLOCK_MONOTONIC of its first frame at the DAC
    std::int64_t ended_ns = 0;                     ///< and of its last
    unsigned xruns = 0;                            ///< since it was asked for
    bool limited = false;                          ///< limits of the array changed it

    /// Why it does not count: its flaw, or that it was limited; empty: it does.
    std::string fault() const;
};

/// A session, whose signals end it by exceptions. One thread.
class stage : public session::play_session {
public:
    /// The reason for leaving a session.
    struct left {
        int signal;                       ///< 0: nobody left
        std::string_view by = "a signal"; ///< for messages: who ended it
    };

    /// Opens the device. \throws error.
    stage(const alsa_options& device, const session::stream_options& o, const session::environment& e,
          const session::stream_source& source = {});

    using sink_opener = std::function<std::unique_ptr<sink>()>;
    /// Noise around each stimulus from now on. \throws error as masker, and what the opener throws.
    void mask(sink_opener open, const masking_options& o);
    /// On the PCM of this name, in stereo.
    void mask(const std::string& pcm, const masking_options& o);

    /// How long a score that is to begin so long from now has to wait, so that no tactor is driven for longer
    /// than the limits allow, with what was given here before.
    double room_s(const score& s, double lead_s) const;
    /// Lets so much of the stream's time pass. As pass().
    bool make_room(const score& s, double lead_s, const std::function<bool(double passed_s)>& watch);

    /// Told some 25 times a second at which of its frames the stimulus is.
    using watcher = std::function<void(std::uint64_t stimulus_frame)>;
    /// Plays a score, under noise where there is to be some, which goes on after it; the noise's begin is not
    /// waited for where it is there already. \throws left; error where the noise's device cannot be opened
    /// again.
    given_stimulus give(const score& s, double lead_s, const watcher& watch);

    /// Noise until fade_out(). False where it does not sound. \throws as give().
    bool fade_in();
    void fade_out() noexcept;

    /// Why the noise has ended; `ok` while it goes on, and where there is none.
    io_kind noise_ended() const noexcept { return masker_ ? masker_->ended() : io_kind::ok; }

    /// Lets so much of the stream's time pass; the watcher is told how much has, and returns false to end it
    /// before. False where the stream has ended meanwhile. \throws left.
    bool pass(double seconds, const std::function<bool(double passed_s)>& watch);
    /// Waits for a descriptor. \throws left.
    void wait_for(int descriptor);

    /// Waits for it. False where it did not come back. \throws left.
    bool reopen();
    /// Ends the streams in silence. \throws error where the amplifier may be on.
    void finish();

private:
    void check_signal() const;

    sink_opener open_masker_ = {};
    masking_options masking_ = {};
    std::unique_ptr<masker> masker_; ///< null: no noise
    synth::drive_room room_;
    std::uint64_t before_ = 0; ///< frames of the streams before this one; what lay between them did not pass
};

/// Ends the noise, whatever ends the trial.
class noise_around {
public:
    explicit noise_around(stage& s) : stage_(s) {}
    ~noise_around() { stage_.fade_out(); }
    noise_around(const noise_around&) = delete;
    noise_around& operator=(const noise_around&) = delete;

private:
    stage& stage_;
};

/// Runs what is held on a stage (or on somebody who has one) and ends its streams, whatever ends it. Returns
/// why it was left. \throws what `held` throws, but stage::left.
template <typename Stage, typename Held>
[[nodiscard]] stage::left until_left(Stage& s, const Held& held)
{
    stage::left why{0};
    try {
        held();
    } catch (const stage::left& l) {
        why = l;
    } catch (const error&) {
        s.finish();
        throw;
    }
    s.finish();
    return why;
}

} // namespace tactor::study
