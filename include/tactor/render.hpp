// SPDX-License-Identifier: MIT
/// \file
/// From plans to frames: scores, samples and WAV files.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/plan.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// What the array may be given at run time, besides each channel's own max_dbfs. Both limits act on the
/// envelopes of the channels, after all strokes are summed. Samples of plans within these limits are not
/// changed in a single bit. The defaults are safe guesses: know your actuators.
struct drive_limits {
    /// Greatest power of all tactors together, in dB above one channel's sine at full scale: the sum of the
    /// squared envelopes in every frame. Where carriers beat on a tactor, the crests of the beat count.
    /// -120 to 60. Default: the power of three such sines. The gain of all tactors falls within some
    /// 10 ms, without a click, and returns with a time constant of 50 ms; a drive that begins abruptly
    /// meanwhile is faded in.
    double power_dbfs = 4.771212547196624;
    /// Longest time that one tactor is driven (above -40 dBFS) within any window. Then its channel fades out,
    /// and stays silent until half of that time has left the window. No window holds more than this and one
    /// fade of 20 ms. Time is counted in steps of 1/256 of the window: a tactor that begins to be driven more
    /// than once in a step may be cut up to one step too early. 0.1 to 3600 s; not below window_s: no limit.
    double max_drive_s = 5.0;
    double window_s = 10.0; ///< 0.1 to 3600 s
};

struct render_options {
    unsigned rate = 48000; ///< Hz, 8000 to 768000
    phase_kind phase = phase_kind::stroke;
    /// Raised-cosine ramp inside each burst, s, from 0. Default: 0 where the carrier crosses zero at the
    /// burst's begin and at its end (both within 1 % of a half cycle), else 2 ms; burst by burst.
    std::optional<double> ramp_s = {};
    double level_dbfs = -12.0;        ///< peak for amplitude 1, <= 0; a tactor's gain_db is added
    std::optional<double> sl_db = {}; ///< instead of level_dbfs: dB above each tactor's threshold_dbfs, which
                                      ///< must be there where it is driven
    unsigned channels = 0;            ///< 0: as many as the array needs
    /// Applied by the renderer; the player has its own. None: the piece as it was designed.
    std::optional<drive_limits> limits = {};
    /// A spare channel on which each stroke's first frames are marked, at full scale and to the frame: the
    /// sync signal that no scheduler can delay.
    std::optional<unsigned> marker_channel = {};
    double marker_s = 0.005; ///< above 0, at most 10 s
    burst_envelope envelope = {};
};

/// Ramp of a burst (or of a continuous stroke, whose onset is 0) in seconds: o.ramp_s, or the default. A
/// burst that is shorter than two ramps has a ramp of half its length at each end.
[[nodiscard]] TACTOR_API double burst_ramp_s(double onset_s, double duration_s, double carrier_hz,
                                             const render_options& o) noexcept;

/// The same for a burst of a plan: its waveform and carrier count; they need not cross zero where a sine
/// does.
[[nodiscard]] TACTOR_API double burst_ramp_s(double onset_s, double duration_s, const plan& p,
                                             const render_options& o) noexcept;

/// A plan and when it starts.
struct placed_plan {
    tactor::plan plan = {};
    /// Seconds from the start of the piece, or from the time that `anchor` says. None: at the end of the plan
    /// before it (the first: 0).
    std::optional<double> start_s = {};
    start_anchor anchor = {}; ///< what start_s counts from
};

/// When each plan starts, in seconds. \throws error (bad_input) for one that would start before the piece.
[[nodiscard]] TACTOR_API std::vector<double> starts_of(std::span<const placed_plan> plans);

/// Plans at a sample rate and at levels: frames and channels. Immutable, cheap to copy; a move is a copy, so
/// a score that was moved from keeps its value.
class TACTOR_API score {
public:
    /// \throws error (bad_input): carrier at or above half the rate, a level that a tactor may not
    ///         have (above full scale or its max_dbfs; with its line in the array file), a tactor
    ///         without a threshold where a sensation level is asked for, too few channels.
    score(const array& a, std::vector<placed_plan> plans, const render_options& o = {});
    /// One plan, from the start of the piece on. Throws as above.
    template <std::same_as<plan> Plan>
    score(const array& a, Plan p, const render_options& o = {}) : score(a, alone(std::move(p)), o)
    {
    }
    score(const score&) noexcept = default;
    score& operator=(const score&) noexcept = default;

    [[nodiscard]] std::uint64_t frames() const noexcept; ///< length of the piece
    [[nodiscard]] unsigned channels() const noexcept;
    [[nodiscard]] unsigned rate() const noexcept; ///< Hz
    /// Start of each plan in frames.
    [[nodiscard]] const std::vector<std::uint64_t>& starts() const noexcept;
    /// The plans without their bursts, which are not kept twice.
    [[nodiscard]] const std::vector<placed_plan>& plans() const noexcept;

    struct impl;

private:
    friend struct detail::access;
    explicit score(std::shared_ptr<const impl> made) noexcept;
    [[nodiscard]] static std::vector<placed_plan> alone(plan p);

    std::shared_ptr<const impl> impl_;
};

/// Makes a score stroke by stroke. A plan that it makes itself is never in memory as a whole: an hour of
/// park2016 takes 4 MB in place of 11. One thread at a time. Where an add() throws, a part of the stroke may
/// be in the score: the builder cannot be used any more.
class TACTOR_API score_builder {
public:
    /// \throws error (bad_input) for impossible render_options or an impossible array.
    score_builder(const array& a, const render_options& o);
    ~score_builder();
    score_builder(const score_builder&) = delete;
    score_builder& operator=(const score_builder&) = delete;

    /// Adds a plan; its start as in placed_plan. \throws error (bad_input) where it cannot be rendered.
    void add(plan p, std::optional<double> start_s = {}, const start_anchor& anchor = {});

    /// Plans a stroke as make_plan() does and adds it at its start. `l` must be the layout of the array. The
    /// bursts of park2016 are handed on as they come, the other algorithms plan as a whole.
    /// \throws error (bad_input) as make_plan() does, and where the plan cannot be rendered.
    void add(const layout& l, const stroke& s, const plan_options& o);

    /// The score of all that was added: its samples are those of a score that is made of the plans. The
    /// builder begins anew, where this throws, too.
    /// \throws error (bad_input) for levels that a tactor may not have.
    [[nodiscard]] score take();

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

/// Renders a score offline, block by block. The same mixer as in the player: same score, same samples,
/// whatever the block sizes. One thread at a time. A renderer that was moved from can be destroyed and
/// assigned to; its other members throw error (bad_input).
class TACTOR_API renderer {
public:
    renderer(const score& s, format_kind f);
    ~renderer();
    renderer(renderer&&) noexcept;
    renderer& operator=(renderer&&) noexcept;

    /// Fills `out` with the next interleaved frames, as many as it has space for, and goes on; silence after
    /// the end. Where a continuous stroke fails, all strokes fade out before that, within 10 ms, and silence
    /// follows. Allocates nothing but the text of failure().
    /// \throws error (bad_input) where `out` is no whole number of frames (channels * bytes_of(format)).
    void process(std::span<std::byte> out);

    /// Next frame to be rendered.
    [[nodiscard]] std::uint64_t position() const;

    /// Why the rest is silence: a continuous stroke could not be followed further, for want of memory for
    /// example, or it asked for more than its levels were checked with. Empty while all is well.
    [[nodiscard]] const std::string& failure() const;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

/// Called between blocks with the frames done and in all; false gives up.
using wav_progress = std::function<bool(std::uint64_t done, std::uint64_t all)>;

/// Renders a score to a WAV file (RF64 above 4 GB) in bounded memory. Writes to a temporary name in
/// the same folder, which becomes `file` when complete; on failure, or when `progress` gives up,
/// nothing is left behind and an existing `file` stays as it was. Blocks on the file system.
/// \returns false when `progress` gave up.
/// \throws error: bad_input for a format that WAV cannot hold (s24_4), a folder that does not exist, and a
///         plan that fails in mid-stroke (renderer::failure()); runtime for what the file system refuses.
TACTOR_API bool write_wav(const score& s, format_kind f, const std::filesystem::path& file,
                          const wav_progress& progress = {});

} // namespace v0
} // namespace tactor
