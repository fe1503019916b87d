// SPDX-License-Identifier: MIT
/// \file
/// Smoothing of points that come in bursts into an even movement.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/path.hpp>

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
    std::uint64_t settles_in() const noexcept { return given_.size() < 2 ? 0 : window_; }

private:
    struct given {
        std::uint64_t from;
        place where;
    };

    std::uint64_t window_;
    std::vector<given> given_; ///< places that still count, the oldest first
};

} // namespace tactor::engine
