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

/// Limits on the power and on the drive time of the array at run time, in addition to each channel's
/// max_dbfs. Both limits act on the envelopes of the channels, after all strokes are summed. If a score stays
/// within both limits, not a single bit of its samples changes. The defaults are safe guesses: check them for
/// your actuators.
struct drive_limits {
    /// Limit on the power of all tactors together, -120 to 60 dB. The power is the sum of the squared
    /// envelopes in each frame, relative to a sine at full scale on one channel. Where carriers beat on a
    /// tactor, the crests of the beat count. Default: the power of three such sines.
    ///
    /// If the power exceeds the limit, the gain of all tactors falls within some 10 ms, without a click. The
    /// gain returns with a time constant of 50 ms. A drive that begins abruptly while the gain is reduced is
    /// faded in.
    double power_dbfs = 4.771212547196624;
    /// Longest drive of a tactor (above -40 dBFS) without a rest, 0.1 to 3600 s. If it is not below window_s,
    /// there is no limit. Each channel has a drive time. While the tactor is driven, its drive time grows by
    /// 1 s in each second. While the tactor rests, its drive time falls down to 0. In each second it falls by
    ///
    ///     1 s * max_drive_s / (window_s - max_drive_s)
    ///
    /// When the drive time reaches max_drive_s, the channel fades out within 20 ms. When the drive time has
    /// fallen to half of max_drive_s, the channel fades in again. So in the long run a tactor is driven for
    /// max_drive_s of each window_s. In no window is the drive longer than the following time, plus fades:
    ///
    ///     max_drive_s * (2 - max_drive_s / window_s)
    double max_drive_s = 5.0;
    double window_s = 10.0; ///< 0.1 to 3600 s
};

/// Options of a score.
struct render_options {
    unsigned rate = 48000; ///< Hz, 8000 to 768000
    phase_kind phase = phase_kind::stroke;
    /// Length of the raised-cosine ramps inside each burst, s, 0 or more. Default: 0 for a burst if the
    /// carrier crosses zero at its start and at its end (both within 1 % of a half cycle), else 2 ms.
    std::optional<double> ramp_s = {};
    double level_dbfs = -12.0; ///< peak for amplitude 1, <= 0; a tactor's gain_db is added
    /// Level above each tactor's threshold, dB, in place of level_dbfs. Each tactor that plays must have a
    /// threshold.
    std::optional<double> sl_db = {};
    unsigned channels = 0; ///< 0: as many as the array needs
    /// Limits for the renderer; the player has limits of its own. None: the renderer does not limit the
    /// score.
    std::optional<drive_limits> limits = {};
    /// Spare channel with a marker: a pulse at full scale that begins exactly with the first frame of each
    /// stroke. No scheduler can delay this sync signal.
    std::optional<unsigned> marker_channel = {};
    double marker_s = 0.005; ///< above 0, at most 10 s
    burst_envelope envelope = {};
    /// Treatment of strokes that meet on a tactor.
    together_kind together = together_kind::weaken;
};

/// Weakening of a score by together_kind::weaken, and where and when the score would be loudest without it.
struct weakening {
    /// Level that is added to the whole score, dB, 0 or less. If it is 0, the other members have no meaning.
    double weakened_db = 0.0;
    unsigned tactor = 0;
    double at_s = 0.0;                   ///< from the start of the score
    std::vector<std::size_t> plans = {}; ///< numbers of the plans that sound there at that time, ascending
};

/// Returns the ramp of a burst (or of a continuous stroke, whose onset is 0) in s: o.ramp_s, or the default.
/// A burst shorter than two ramps has a ramp of half its length at each end.
[[nodiscard]] TACTOR_API double burst_ramp_s(double onset_s, double duration_s, double carrier_hz,
                                             const render_options& o) noexcept;

/// Returns the same for a burst of a plan. Uses the plan's waveform and carrier, which may cross zero at
/// other times than a sine.
[[nodiscard]] TACTOR_API double burst_ramp_s(double onset_s, double duration_s, const plan& p,
                                             const render_options& o) noexcept;

/// A plan and its start.
struct placed_plan {
    tactor::plan plan = {};
    /// Start in s, counted from the time that `anchor` names. None: the plan starts at the end of the plan
    /// before it; the first plan starts at 0.
    std::optional<double> start_s = {};
    start_anchor anchor = {}; ///< reference time of start_s
};

/// Returns the start of each plan in s.
/// \throws error (bad_input) if a plan would start before the score.
[[nodiscard]] TACTOR_API std::vector<double> start_times_s(std::span<const placed_plan> plans);

/// Plans at a sample rate and at levels, in frames and channels. Immutable and cheap to copy. A move is a
/// copy, so a moved-from score keeps its value.
class TACTOR_API score {
public:
    /// Makes a score of several plans. By default, a score in which a tactor would exceed the requested level
    /// is weakened as a whole. The tactor's gain_db and the boost for its rise_s are added after that.
    /// \throws error (bad_input) for a carrier at or above half the rate, for a level above full scale, for a
    ///         level above a tactor's max_dbfs (the error has its line in the array file), for a sensation
    ///         level on a tactor without a threshold, and for too few channels.
    score(const array& a, std::vector<placed_plan> plans, const render_options& o = {});
    /// Makes a score of one plan that starts with the score. Throws as the constructor above does.
    template <std::same_as<plan> Plan>
    score(const array& a, Plan p, const render_options& o = {}) : score(a, alone(std::move(p)), o)
    {
    }
    /// Makes a score of your own samples, which play exactly as they are, from frame 0 on. gain_db, polarity
    /// and rise_s of the tactors have no effect on the samples. The same is true of phase, ramp and envelope
    /// of `o`. Only limits can change the samples. A format of fewer bits rounds the samples; a negative zero
    /// becomes zero. A channel without a tactor plays, too, up to full scale. The whole score counts as one
    /// stroke.
    ///
    /// For the limits on power and drive time, the envelope of a channel comes from its samples within the 10
    /// to 20 ms before and after. It is their peak or, if that is greater, the amplitude of a sine with their
    /// mean square.
    ///
    /// Any thread. Takes as long as one pass over the samples.
    /// \throws error (bad_input) if `s` has no frame or an incomplete frame, too many bytes, another rate or
    ///         number of channels than `o`, or samples that are not finite.
    /// \throws error (bad_input) if the peak of a tactor's channel is above o.level_dbfs or the tactor's
    ///         max_dbfs, and if `o` has a sensation level, because samples have no carrier.
    [[nodiscard]] static score from_samples(const array& a, own_samples s, const render_options& o = {});
    score(const score&) noexcept = default;
    score& operator=(const score&) noexcept = default;

    [[nodiscard]] std::uint64_t frames() const noexcept; ///< length of the score
    [[nodiscard]] unsigned channels() const noexcept;
    [[nodiscard]] unsigned rate() const noexcept; ///< Hz
    /// Returns the start of each plan in frames.
    [[nodiscard]] const std::vector<std::uint64_t>& starts() const noexcept;
    /// Returns the weakening that keeps every tactor within the requested level.
    [[nodiscard]] const weakening& weakened() const noexcept;
    /// Returns the plans without their bursts: the score stores those in another form.
    [[nodiscard]] const std::vector<placed_plan>& plans() const noexcept;

    struct impl;

private:
    friend struct detail::access;
    explicit score(std::shared_ptr<const impl> made) noexcept : impl_(std::move(made)) {}
    [[nodiscard]] static std::vector<placed_plan> alone(plan p);

    std::shared_ptr<const impl> impl_;
};

/// Builder that makes a score stroke by stroke. It never keeps a whole plan in memory: an hour of park2016
/// takes 4 MB instead of 11 MB. One thread at a time. If an add() throws, a part of the stroke may be in the
/// score, so the builder is no longer usable.
class TACTOR_API score_builder {
public:
    /// Starts an empty score.
    /// \throws error (bad_input) for impossible render_options or an impossible array.
    score_builder(const array& a, const render_options& o);
    ~score_builder();
    score_builder(const score_builder&) = delete;
    score_builder& operator=(const score_builder&) = delete;

    /// Adds a plan, with a start as in placed_plan.
    /// \throws error (bad_input) if it cannot be rendered.
    void add(plan p, std::optional<double> start_s = {}, const start_anchor& anchor = {});

    /// Plans a stroke as make_plan() does and adds it at its start. `l` must be the layout of the array.
    /// Bursts of park2016 go into the score one by one; the other algorithms plan the whole stroke first.
    /// \throws error (bad_input) as make_plan() does, and if the plan cannot be rendered.
    void add(const layout& l, const stroke& s, const plan_options& o);

    /// Returns the score of all added plans. Its samples equal the samples of a score that is made of the
    /// same plans at once. The builder becomes empty, even if this throws.
    /// \throws error (bad_input) for impossible levels, as the constructor of score does.
    [[nodiscard]] score take();

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

/// Offline renderer that computes a score block by block with the mixer of the player. The samples do not
/// depend on the sizes of blocks. One thread at a time. A moved-from renderer can be destroyed and assigned
/// to; its other members throw error (bad_input).
class TACTOR_API renderer {
public:
    renderer(const score& s, format_kind f);
    ~renderer();
    renderer(renderer&&) noexcept;
    renderer& operator=(renderer&&) noexcept;

    /// Fills `out` with the next interleaved frames, as many as fit, and with silence after the end.
    /// Allocates only for samples of continuous strokes.
    /// \throws error (bad_input) unless `out` is a whole number of frames (channels * sample_bytes(format));
    ///         std::bad_alloc if memory runs out. The frames before position() are then complete, and the
    ///         next call continues at position().
    void process(std::span<std::byte> out);

    /// Returns the number of the next frame.
    [[nodiscard]] std::uint64_t position() const;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

/// Function that is called between blocks with the number of finished frames and of all frames. It returns
/// false to give up.
using wav_progress = std::function<bool(std::uint64_t done, std::uint64_t all)>;

/// Renders a score to a WAV file (RF64 above 4 GB) in bounded memory. Writes to a temporary name in the same
/// folder and renames it to `file` when it is complete. On failure, or if `progress` gives up, leaves no new
/// file behind and does not change an existing `file`. Blocks on the file system.
/// \returns false if `progress` gave up.
/// \throws error: bad_input for a format that WAV cannot hold (s24_4) and for a folder that does not exist;
///         runtime for errors of the file system.
TACTOR_API bool write_wav(const score& s, format_kind f, const std::filesystem::path& file,
                          const wav_progress& progress = {});

} // namespace v0
} // namespace tactor
