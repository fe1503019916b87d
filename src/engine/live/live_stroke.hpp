// SPDX-License-Identifier: MIT
/// \file
/// The producer's side of a live stroke: from points, which come in bursts, to an even movement and
/// amplitudes.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/live.hpp>
#include <tactor/phantom.hpp>
#include <tactor/sink.hpp>

#include "engine/live/live_voice.hpp"
#include "synth/score/score.hpp"

namespace tactor::engine {

/// Place of a stroke as the mean of its given places over a window that ends now. So a step becomes an even
/// movement that takes one window, and an even movement is half a window late. At intensity 0 nothing touches
/// the skin: such a place counts only while all places in the window have it.
class smoothing {
public:
    struct place {
        point at;
        double intensity = 1.0;
    };

    /// \param window frames, 1 or more
    explicit smoothing(std::uint64_t window) : window_(window) {}

    /// Puts the stroke at `p` from this frame on. Frames do not go back. For the same frame the newest place
    /// counts. Before the first frame it has always been at the first place.
    void to(std::uint64_t frame, const place& p);
    /// Returns the place of the stroke at a frame after the newest, if no other place comes.
    place at(std::uint64_t frame) const;
    /// Returns the frames from the newest on until the stroke is at its place.
    std::uint64_t settles_in() const noexcept { return places_.size() < 2 ? 0 : window_; }

private:
    struct entry {
        std::uint64_t from;
        place where;
    };

    std::uint64_t window_;
    std::vector<entry> places_; ///< places that still count, the oldest first
};

} // namespace tactor::engine

namespace tactor {
inline namespace v0 {

struct live_stroke::impl {
    /// Prepares the stroke.
    /// \throws error (bad_input) for impossible options.
    impl(stroke_id number, const array& a, const layout& l, const stream_setup& s, const live_options& o);

    bool to(point p, double intensity, std::optional<std::int64_t> at_ns = {});
    /// Writes the amplitudes of a place, by channel. Returns true if a limit held one. If the model gives
    /// more than the intensity, `excess` says so.
    bool amplitudes_at(point p, double intensity, std::span<double> by_channel);
    /// Writes the amplitudes from the current place to another one. The stroke ends if the model fails.
    bool write_course(point p, double intensity);
    /// Writes the amplitudes from the current place to another one into `course`.
    bool compute_course(const engine::smoothing::place& p, engine::live_course& course);

    stroke_id id;
    layout faces;
    std::shared_ptr<const phantom_model> model;
    outside_kind outside;
    intensity_scale scale;
    std::vector<synth::tactor_level> levels; ///< by tactor
    std::vector<double> limits;              ///< by channel
    engine::live_voice voice;

    std::uint64_t window; ///< frames; 0: places are not smoothed

    std::mutex mutex; ///< between producers
    /// Thread that is in the model, which may be the program's: it must not wait for itself there.
    std::atomic<std::thread::id> model_thread{};
    engine::smoothing smooth;
    std::size_t most_knots;
    std::vector<drive> drives;
    std::string excess; ///< reason why the stroke is about to fail
    std::atomic<std::uint64_t> points{0};
    std::atomic<std::uint64_t> limited_points{0};
};

} // namespace v0
} // namespace tactor
