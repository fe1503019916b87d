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

/// Exactly one end for each score that was begun. Frames are those of the epoch (the mixer's) unless
/// called stream frames. Audio thread only, nothing allocates.
class score_table {
public:
    /// `reserve`: drives of the mixer that are kept for live strokes.
    score_table(synth::mixer& m, link& l, std::uint32_t fade_frames, std::size_t reserve = 0) noexcept
        : mixer_(m), link_(l), fade_(fade_frames), reserve_(reserve)
    {
    }

    /// Whether this beginning has been cancelled (and reported) before it came; asked once.
    bool called_off(ticket t) noexcept;
    /// `offset`: stream frame at which the epoch began.
    void begin(const command& c, std::uint64_t offset) noexcept;
    /// False when the mixer has no space now; the command must be given again.
    bool add(const command& c) noexcept;
    /// There are more drives than there is space for: what comes too late in the next time does so for that.
    void crowd() noexcept;
    void end(ticket t) noexcept;
    /// There will be no more drives from frame `at` of the score on, for its plan failed.
    void fail(ticket t, std::uint64_t at) noexcept;
    /// A live stroke; silent until its first point comes and fewer than live_voices sound. There must be a
    /// place.
    void begin_live(const request& r) noexcept;
    /// Ends live strokes whose producer wants it, or is silent for too long, and those that last too long.
    void look_at_wishes() noexcept;
    /// Adds the live strokes' drives of the next frames; before each mix. `offset` as in begin(); `clock` may
    /// be unknown.
    void render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Fades out what would break off for want of drives within two periods; before each mix.
    void fade_what_runs_out(std::uint64_t period) noexcept;
    /// Fades out what failed, so that it is silent where its drives end; before each mix.
    void fade_what_failed(std::uint64_t period) noexcept;
    /// Also for a score whose begin() is still to come.
    void cancel(ticket t) noexcept;
    /// Fades everything out; scores not yet begun end at once, as do those that come later.
    void stop(bool closing) noexcept;
    /// The same, with a reason.
    void stop(state_kind s, reason_kind why) noexcept;
    /// The amplifier is off: fades what sounds, returns what has not begun.
    void mute() noexcept;

    /// Notes when the first sample of each was at the DAC, once `played` frames have reached it. `clock` must
    /// be valid, for the epoch that began at stream frame `offset`. Before update() and interrupt().
    void note_starts(std::uint64_t played, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Ends what is over when `played` frames have reached the DAC, and starts fades that had to wait.
    void update(std::uint64_t played) noexcept;

    /// The stream broke: ends what had begun to sound, and with `give_back` returns the rest.
    void interrupt(reason_kind why, int code, std::uint64_t played, bool give_back) noexcept;

    bool empty() const noexcept { return used_ == 0; }
    /// Fills in the newest score that sounds at `played`.
    void describe(std::uint64_t played, stream_status& s) const noexcept;
    /// Whether a score that sounds now still waits for drives.
    bool being_fed() const noexcept;

private:
    /// Base of a live stroke before its first point, and the length of one that is fed.
    static constexpr std::uint64_t never = std::uint64_t{1} << 62;

    /// For so long a mixer or a ring that was full is what makes drives late.
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
    std::uint64_t full_until_ = 0; ///< what comes too late before this frame had to wait for space
    std::uint32_t used_ = 0;
    std::uint32_t top_ = 0; ///< entries from here on were never used
    /// By place: beginnings in the command ring that have been cancelled and reported. Those come first, as a
    /// place is given again only when its ticket has ended.
    std::array<std::uint32_t, voices> called_off_{};
    std::array<entry*, live_places> live_{}; ///< in order of their beginning
    std::size_t live_count_ = 0;
    std::size_t live_sounding_ = 0; ///< until they are over
    bool stopping_ = false;
    state_kind stop_state_ = state_kind::cancelled;
    reason_kind stop_reason_ = reason_kind::none;
};

} // namespace tactor::engine
