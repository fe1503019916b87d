// SPDX-License-Identifier: MIT
/// \file
/// Points that come in bursts, as an even movement.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/path.hpp>

namespace tactor::engine {

/// The place of a stroke is the mean of the places that it was told, over a window that ends now. So a step
/// becomes an even movement that takes one window, and an even movement is half a window late. Where the
/// intensity is 0 nothing touches: such a place counts only while all places in the window are such.
class smoothing {
public:
    struct place {
        point at;
        double intensity = 1.0;
    };

    /// \param window frames, 1 or more
    explicit smoothing(std::uint64_t window) : window_(window) {}

    /// From this frame on the stroke is told to be at `p`. Frames do not go back. For the same frame the
    /// newest place counts; before the first frame it has always been at the first place.
    void to(std::uint64_t frame, const place& p);
    /// Where the stroke is at a frame after the newest, if no other place comes.
    place at(std::uint64_t frame) const;
    /// Frames from the newest on until the stroke is at its place.
    std::uint64_t settles_in() const noexcept { return given_.size() < 2 ? 0 : window_; }

private:
    struct given {
        std::uint64_t from;
        place where;
    };

    std::uint64_t window_;
    std::vector<given> given_; ///< those that still count, the oldest first
};

} // namespace tactor::engine
