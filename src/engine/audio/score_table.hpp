// SPDX-License-Identifier: MIT
/// \file
/// The scores that the audio thread plays, and how each of them ends.
#pragma once

#include <array>
#include <cstdint>

#include "engine/link.hpp"
#include "engine/live/live_voice.hpp"
#include "engine/messages.hpp"
#include "synth/mix/mixer.hpp"

namespace tactor::engine {

/// Each score that was begun gets exactly one end. Frames are those of the epoch (the mixer's) unless called
/// stream frames. Audio thread only, nothing allocates.
class score_table {
public:
    /// `reserve`: drives of the mixer that are kept for live strokes.
    score_table(synth::mixer& m, link& l, std::uint32_t fade_frames, std::size_t reserve = 0) noexcept
        : mixer_(m), link_(l), fade_(fade_frames), reserve_(reserve)
    {
    }

    /// Whether this ticket was cancelled, and reported, before its begin came. Called once for each begin.
    bool called_off(ticket t) noexcept;
    /// `offset`: stream frame at which the epoch began.
    void begin(const command& c, std::uint64_t offset) noexcept;
    /// False when the mixer has no space now; the command must be given again.
    bool add(const command& c) noexcept;
    /// There are more drives than space: if drives come too late within the next crowd_frames, this is the
    /// reason.
    void crowd() noexcept;
    void end(ticket t) noexcept;
    /// The plan failed: from frame `at` of the score on there are no more drives.
    void fail(ticket t, std::uint64_t at) noexcept;
    /// Adds a live stroke. It is silent until its first point has come and fewer than live_voices sound.
    /// There must be a free place.
    void begin_live(const request& r) noexcept;
    /// Ends live strokes whose producer has asked for it, or is silent for too long, and those that last too
    /// long.
    void look_at_wishes() noexcept;
    /// Adds the live strokes' drives of the next frames; called before each mix. `offset` as in begin();
    /// `clock` may be unknown.
    void render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Fades out scores that will break off within two periods because their next drives have not come.
    /// Called before each mix.
    void fade_what_runs_out(std::uint64_t period) noexcept;
    /// Fades out scores whose plan failed, so that they are silent where their drives end. Called before each
    /// mix.
    void fade_what_failed(std::uint64_t period) noexcept;
    /// Fades a score out, or ends it at once if it has not begun. Its begin() may still be to come.
    void cancel(ticket t) noexcept;
    /// Fades everything out. Scores that have not begun end at once, and so do those that come later.
    void stop(bool closing) noexcept;
    /// The same, with a reason.
    void stop(state_kind s, reason_kind why) noexcept;
    /// The amplifier is off: fades out the scores that sound, and returns those that have not begun.
    void mute() noexcept;

    /// Notes when the first sample of each score was at the DAC, as soon as it is among the `played` frames.
    /// `clock` must be valid, for the epoch that began at stream frame `offset`. Called before update() and
    /// interrupt().
    void note_starts(std::uint64_t played, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Ends the scores that are over when `played` frames have reached the DAC, and starts fades that had to
    /// wait.
    void update(std::uint64_t played) noexcept;

    /// The stream broke: ends the scores that had begun to sound. With `give_back` it returns the others,
    /// else it ends them, too.
    void interrupt(reason_kind why, int code, std::uint64_t played, bool give_back) noexcept;

    bool empty() const noexcept { return used_ == 0; }
    /// Fills in the newest score that sounds at `played`, and where the last of those that have begun to be
    /// mixed is over; one that cannot fade yet has no end.
    void describe(std::uint64_t played, stream_status& s) const noexcept;
    /// Whether a score that sounds now still waits for drives.
    bool being_fed() const noexcept;

private:
    /// Base of a live stroke before its first point, and length of a live stroke that is still fed.
    static constexpr std::uint64_t never = std::uint64_t{1} << 62;

    /// If drives come too late within so many frames after the mixer or a ring was full, this is the reason.
    static constexpr std::uint64_t crowd_frames = 8192;

    struct entry {
        ticket score = 0;
        stroke_id id = {};
        std::uint64_t base = 0;
        std::uint64_t length = 0;
        std::uint64_t finish = 0;     ///< over when this frame has been played
        std::uint64_t covered = 0;    ///< end of its drives so far
        std::uint64_t broken = never; ///< where its drives end for ever, after fail()
        std::uint32_t fade = 0;       ///< frames that its end takes
        bool open = false;            ///< it would still sound at `covered`: another drive is to follow
        bool ahead = false;           ///< drives have been there in time
        bool used = false;
        bool fed = false;
        bool fade_wanted = false;
        bool fading = false;
        bool started = false; ///< its first sample has been at the DAC ...
        std::int64_t started_ns = 0;
        bool sounds = false;               ///< one of live_voices
        live_voice* live = nullptr;        ///< while it is fed
        const live_voice* voice = nullptr; ///< of a live stroke, to its end
        state_kind state = state_kind::finished;
        reason_kind why = reason_kind::none;
    };

    entry* find(ticket t) noexcept;
    void look_at_wishes(entry& e) noexcept;
    void render_live(entry& e, std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    void close_live(entry& e) noexcept;
    reason_kind why_late() const noexcept;
    static void cover(entry& e, const synth::drive_event& d) noexcept;
    void want_fade(entry& e, state_kind s, reason_kind why) noexcept;
    void fade(entry& e) noexcept;
    void over(entry& e, state_kind s, reason_kind why, int code, std::uint64_t frames) noexcept;

    synth::mixer& mixer_;
    link& link_;
    std::uint32_t fade_;
    std::size_t reserve_;
    std::array<entry, voices> entries_{};
    std::uint64_t full_until_ = 0; ///< drives that come too late before this frame had to wait for space
    std::uint32_t used_ = 0;
    std::uint32_t top_ = 0; ///< entries from here on were never used
    /// By place: how many begins in the command ring have been cancelled and reported. They come before any
    /// other begin of this place: a place is given again only when its ticket has ended.
    std::array<std::uint32_t, voices> called_off_{};
    std::array<entry*, live_places> live_{}; ///< in order of their beginning
    std::size_t live_count_ = 0;
    std::size_t live_sounding_ = 0; ///< until they are over
    bool stopping_ = false;
    state_kind stop_state_ = state_kind::cancelled;
    reason_kind stop_reason_ = reason_kind::none;
};

} // namespace tactor::engine
