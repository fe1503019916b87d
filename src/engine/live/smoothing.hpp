// SPDX-License-Identifier: MIT
/// \file
/// Points that come in bursts, as an even movement.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/geometry.hpp>

namespace tactor::engine {

/// A place is the mean, over a window that ends now, of where the stroke was told to be: a step becomes an
/// even movement that takes the window, and what moves evenly is half of it behind.
class smoothing {
public:
    struct place {
        point at;
        double intensity = 1.0;
    };

    /// \param window frames, 1 or more
    explicit smoothing(std::uint64_t window) : window_(window) {}

    /// From this frame on it is to be there. Frames do not go back; of the same frame the newest counts, and
    /// before the first it has always been there.
    void to(std::uint64_t frame, const place& p);
    /// Where it is at a frame after the newest, if nothing more comes.
    place at(std::uint64_t frame) const;
    /// Frames from the newest on until it is there.
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
