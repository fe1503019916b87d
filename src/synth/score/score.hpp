// SPDX-License-Identifier: MIT
/// \file
/// The contents of a score: its plans in frames and channels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactor/render.hpp>

#include "synth/limits/guard.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// The channel of a tactor, and its gain.
struct tactor_level {
    std::uint32_t channel = 0;
    double gain = 0.0; ///< linear peak for amplitude 1, polarity included
};

/// A burst in a group of bursts that overlap on one tactor.
struct item_member {
    std::uint64_t start = 0;
    std::uint64_t length = 0;
    std::uint32_t ramp = 0;
    std::uint32_t release = 0;
    double amplitude = 0.0;
    double intensity = 0.0; ///< A_v
    std::uint64_t end() const noexcept { return start + length; }
};

enum class item_kind : std::uint8_t {
    burst,      ///< drives that share one carrier and one window
    joined,     ///< several bursts on one tactor that share one carrier
    continuous, ///< a whole continuous stroke
    marker,     ///< mark of a stroke's beginning or bit of a code, on a channel without a tactor
    own,        ///< a channel of the user's own samples
};

/// A stretch of one carrier, in frames of the score. Ten hours have half a million items, so an item is
/// compact.
struct item {
    std::uint64_t start = 0;
    std::uint64_t length = 0;
    std::uint64_t first =
        0; ///< index of the first drive (burst) or of the first member (joined); own samples: of the sound
    std::uint32_t count = 0;
    std::uint32_t plan = 0;
    std::uint32_t ramp = 0;
    std::uint16_t tactor = 0; ///< joined: the tactor; marker and own samples: the channel
    item_kind kind = item_kind::burst;
    std::uint64_t end() const noexcept { return start + length; }
};
static_assert(sizeof(item) == 40);

/// Items of a score in order of start, with their drives and members.
struct item_list {
    // Deques grow without being copied: a copy would take half as much memory again.
    std::deque<item> items;
    // The drives of bursts: amplitude 1 is the requested intensity. One deque of pairs would be padded.
    std::deque<std::uint16_t> drive_tactors;
    std::deque<double> drive_amplitudes;
    std::vector<item_member> members;
};

/// A part of a joined score, and the frame at which it begins.
struct score_part {
    std::shared_ptr<const score::impl> made;
    std::uint64_t start = 0;
};

} // namespace tactor::synth

namespace tactor {
inline namespace v0 {

struct score::impl {
    std::vector<placed_plan> plans; ///< without their bursts, which became the items
    /// Timbre of each plan (null for a sine), then of each channel of own samples.
    std::vector<std::shared_ptr<const synth::timbre>> sounds;
    std::vector<std::uint64_t> starts;
    std::vector<std::uint64_t> ends;          ///< end of each plan
    std::vector<synth::tactor_level> tactors; ///< by index of the tactor
    std::vector<std::size_t> unmeasured;      ///< see synth::unmeasured_tactors()
    std::vector<tactor_spec> measured;        ///< thresholds by frequency; empty if they are not used
    std::vector<double> limits;               ///< by channel
    /// Greatest level of each tactor, linear; 0 if it is not driven. A continuous stroke counts for all
    /// tactors. Boosts for slow actuators are not included.
    std::vector<double> peaks;
    weakening weakened;             ///< included in the gains of the tactors
    bool boosted = false;           ///< there are boosts for slow actuators
    std::optional<unsigned> marker; ///< channel of the markers, if any
    double marker_level = 1.0;      ///< level of markers, relative to full scale
    synth::item_list list;
    std::vector<synth::score_part> parts; ///< parts of a joined score, by start; it has no items itself
    std::uint64_t frames = 0;
    unsigned channels = 0;
    unsigned rate = 0;
    phase_kind phase = phase_kind::stroke;
    burst_envelope envelope = {};
    synth::guard_settings guards;    ///< for the renderer
    std::size_t open_items = 0;      ///< maximum number of items that have started and not ended
    std::size_t open_continuous = 0; ///< maximum number of continuous items that have started and not ended
    std::size_t open_events = 0;     ///< maximum number of events that sound in one frame

    /// Returns the factor on a tactor's gain at a frame of the score. It accounts for the tactor's threshold
    /// at the carrier of that frame.
    double equalising_factor(std::size_t tactor, std::uint32_t plan, std::uint64_t frame) const;
    /// Returns the greatest value of equalising_factor() in a plan.
    double max_equalising_factor(std::size_t tactor, std::uint32_t plan) const;
};

} // namespace v0
} // namespace tactor

namespace tactor::synth {

/// Begins a score without plans.
/// \throws error (bad_input) for impossible render_options or an impossible array.
std::shared_ptr<score::impl> begin_score(const array& a, const render_options& o);

/// Adds markers, and puts all items in order.
void end_items(score::impl& s, const render_options& o);

/// Appends the items of bursts of plan number `plan`, which starts at frame `start`. Bursts that overlap on
/// one tactor are joined; bursts that only touch are not. `bursts` may be a part of the plan's bursts, from
/// number `first` on, if nothing sounds just before and after this part. Uses only the carrier of the plan,
/// and rate, phase and ramp of the options. Returns the frame at which the bursts end.
/// \throws error (bad_input) for times or amplitudes that are not finite, or for tactors that are not in the
///         array.
std::uint64_t place_bursts(std::span<const burst> bursts, std::size_t first, const plan& p,
                           std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                           const render_options& o, item_list& out);

/// Appends the item of a continuous plan, and returns the frame at which the plan ends. `bursts_end`: frame
/// at which the bursts of the plan end.
/// \throws error (bad_input) for a duration that cannot be rendered.
std::uint64_t append_continuous_item(const plan& p, std::uint32_t plan, std::uint64_t start,
                                     std::uint64_t bursts_end, const render_options& o, item_list& out);

} // namespace tactor::synth
