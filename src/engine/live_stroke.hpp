// SPDX-License-Identifier: MIT
/// \file
/// The producer's side of a live stroke: from points to amplitudes.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/live.hpp>
#include <tactor/phantom.hpp>
#include <tactor/sink.hpp>

#include "engine/live_voice.hpp"
#include "synth/score.hpp"

namespace tactor {

struct live_stroke::impl {
    /// \throws error (bad_input) for options that cannot be.
    impl(stroke_id number, const array& a, const layout& l, const stream_setup& s, const live_options& o);

    bool to(point p, double intensity);

    stroke_id id;
    layout faces;
    std::shared_ptr<const phantom_model> model;
    outside leave;
    std::vector<synth::tactor_level> levels; ///< by tactor
    std::vector<double> limits;              ///< by channel
    engine::live_voice voice;

    std::mutex mutex; ///< between producers
    std::vector<drive> drives;
    std::atomic<std::uint64_t> points{0};
    std::atomic<std::uint64_t> outside_points{0};
    std::atomic<std::uint64_t> limited_points{0};
};

} // namespace tactor
