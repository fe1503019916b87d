// SPDX-License-Identifier: MIT
/// \file
/// The scores that the audio thread plays, and their ends.
#pragma once

#include <array>
#include <cstdint>

#include "engine/link.hpp"
#include "engine/live/live_voice.hpp"
#include "engine/messages.hpp"
#include "synth/mix/mixer.hpp"

namespace tactor::engine {

/// Table in which each score that begins gets exactly one end. Frames are those of the epoch (the mixer's)
/// unless called stream frames. Audio thread only; nothing allocates.
class score_table {
public:
    /// Makes an empty table. `reserve`: drives of the mixer that are kept for live strokes.
    /// `ramp_frames`: in which a gain changes.
    score_table(synth::mixer& m, link& l, std::uint32_t fade_frames, std::size_t reserve,
                std::uint32_t ramp_frames) noexcept
        : mixer_(m), link_(l), fade_(fade_frames), ramp_(ramp_frames), reserve_(reserve)
    {
    }

    /// Returns true if this ticket was cancelled, and reported, before its begin came. Call it once for each
    /// begin.
    bool called_off(ticket t) noexcept;
    /// Begins a score. `offset`: stream frame at which the epoch began.
    void begin(const command& c, std::uint64_t offset) noexcept;
    /// Adds a drive. Returns false if the mixer has no space now; the command must come again.
    bool add(const command& c) noexcept;
    /// Notes that there are more drives than space. If drives come too late within the next crowd_frames,
    /// this is the reason.
    void crowd() noexcept;
    void end(ticket t) noexcept;
    /// Adds a live stroke. It is silent until its first point has come and fewer than live_voices sound.
    /// There must be a free place.
    void begin_live(const request& r) noexcept;
    /// Ends live strokes whose producer requests it or is silent for too long, and those that last too long.
    void handle_live_requests() noexcept;
    /// Leads scores to the gains that the control side asks for. Called before each mix.
    void follow_gains() noexcept;
    /// Adds the live strokes' drives of the next frames. Called before each mix. `offset` as in begin();
    /// `clock` may be unknown.
    void render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Fades out scores that would break off within two periods because their next drives have not come.
    /// Called before each mix.
    void fade_what_runs_out(std::uint64_t period) noexcept;
    /// Fades a score out, or ends it at once if it has not begun. Its begin() may still come.
    void cancel(ticket t) noexcept;
    /// Fades everything out. Scores that have not begun end at once, and so do later ones.
    void stop(state_kind s, reason_kind why) noexcept;
    /// Fades out the scores that sound, because the amplifier is off, and returns those that have not begun.
    void mute() noexcept;

    /// Notes the time when the first sample of each score was at the DAC, as soon as it is among the `played`
    /// frames. `clock` must be valid, for the epoch that began at stream frame `offset`. Called before
    /// update() and interrupt().
    void note_starts(std::uint64_t played, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Ends the scores that are over when `played` frames have reached the DAC, and starts fades that had to
    /// wait.
    void update(std::uint64_t played) noexcept;

    /// Ends the scores that had begun to sound, because the stream broke. Returns the others if `give_back`,
    /// else ends them, too.
    void interrupt(reason_kind why, int code, std::uint64_t played, bool give_back) noexcept;

    bool empty() const noexcept { return used_ == 0; }
    /// Fills in the newest score that sounds at `played`, and the frame at which the last score in the mix is
    /// over. A score that cannot fade yet has no end.
    void describe(std::uint64_t played, stream_status& s) const noexcept;
    /// Returns true if a score that sounds now still waits for drives.
    bool being_fed() const noexcept;

private:
    /// Base of a live stroke before its first point, and length of a live stroke that still gets points.
    static constexpr std::uint64_t never = std::uint64_t{1} << 62;

    /// Frames after the mixer or a ring was full in which late drives are blamed on that.
    static constexpr std::uint64_t crowd_frames = 8192;

    struct entry {
        ticket score = 0;
        stroke_id id = {};
        std::uint64_t base = 0;
        std::uint64_t length = 0;
        std::uint64_t finish = 0;  ///< frame after which it is over, once played
        std::uint64_t covered = 0; ///< end of its drives so far
        std::uint32_t fade = 0;    ///< length of its final fade, frames
        bool open = false;         ///< another drive must follow, because it still sounds at `covered`
        bool ahead = false;        ///< drives came in time before
        bool used = false;
        bool fed = false;
        bool fade_wanted = false;
        bool fading = false;
        bool started = false; ///< its first sample has been at the DAC ...
        std::int64_t started_ns = 0;
        float gain = 1.0F;
        bool sounds = false;               ///< counts against live_voices
        live_voice* live = nullptr;        ///< live strokes that still get points
        const live_voice* voice = nullptr; ///< live strokes, to their end
        state_kind state = state_kind::finished;
        reason_kind why = reason_kind::none;
    };

    entry* find(ticket t) noexcept;
    void handle_live_requests(entry& e) noexcept;
    void render_live(entry& e, std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    void close_live(entry& e) noexcept;
    reason_kind why_late() const noexcept;
    static void cover(entry& e, const synth::drive_event& d) noexcept;
    void follow_gain(entry& e, std::uint32_t ramp) noexcept;
    void forget(entry& e) noexcept;
    void want_fade(entry& e, state_kind s, reason_kind why) noexcept;
    void fade(entry& e) noexcept;
    void over(entry& e, state_kind s, reason_kind why, int code, std::uint64_t frames) noexcept;

    synth::mixer& mixer_;
    link& link_;
    std::uint32_t fade_;
    std::uint32_t ramp_;
    std::size_t reserve_;
    std::array<entry, voices> entries_{};
    std::uint64_t full_until_ = 0; ///< drives that are late before this frame had to wait for space
    std::uint32_t used_ = 0;
    std::uint32_t top_ = 0; ///< entries from here on were never used
    /// Number, by place, of begins in the command ring that have been cancelled and reported. They come
    /// before any other begin of this place, because a place is reused only when its ticket has ended.
    std::array<std::uint32_t, voices> called_off_{};
    std::array<entry*, live_places> live_{}; ///< in the order in which they began
    std::size_t live_count_ = 0;
    std::size_t live_sounding_ = 0; ///< live strokes that sound, until they are over
    bool stopping_ = false;
    state_kind stop_state_ = state_kind::cancelled;
    reason_kind stop_reason_ = reason_kind::none;
};

} // namespace tactor::engine
