// SPDX-License-Identifier: MIT
/// \file
/// Gains and fades of scores.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "synth/mix/window.hpp"

namespace tactor::synth {

/// Factor of a score: `from` until frame `start`, then linear to `to`, which it reaches `length` frames
/// later.
struct score_gain {
    std::uint32_t score = 0;
    double from = 1.0;
    double to = 1.0;
    std::uint64_t start = 0;
    std::uint64_t length = 0;

    /// Returns true if `to` is reached at a frame.
    bool is_over(std::uint64_t frame) const noexcept { return frame >= start && frame - start >= length; }
    double at(std::uint64_t frame) const noexcept
    {
        if (frame < start)
            return from;
        if (is_over(frame))
            return to;
        return from + (to - from) * static_cast<double>(frame - start) / static_cast<double>(length);
    }
    /// Multiplies the n samples from a frame on.
    void apply(std::uint64_t frame, unsigned n, double* samples) const noexcept;
    bool operator==(const score_gain&) const = default;
};

/// A fixed number of factors. Scores without one have the factor 1.
class score_gains {
public:
    /// Returns the factor of a score that is not 1 for ever after a frame; null: it is.
    const score_gain* find(std::uint32_t score, std::uint64_t frame) const noexcept;
    /// Leads the factor of a score to `to`, from frame `at` on. Returns false if all are in use.
    bool set(std::uint32_t score, double to, std::uint64_t at, std::uint64_t length) noexcept;
    void forget(std::uint32_t score) noexcept;
    /// Ends all ramps: each factor takes its final value.
    void settle() noexcept;

private:
    /// Returns the place of a score's factor, or used_.
    std::size_t place(std::uint32_t score) const noexcept
    {
        const auto end = gains_.begin() + static_cast<std::ptrdiff_t>(used_);
        return static_cast<std::size_t>(
            std::find_if(gains_.begin(), end, [score](const score_gain& g) { return g.score == score; }) -
            gains_.begin());
    }

    std::array<score_gain, 512> gains_{};
    std::size_t used_ = 0; ///< the first so many
};

struct fade {
    bool used = false;
    std::uint32_t score = 0;
    std::uint64_t start = 0;
    std::uint64_t length = 0;
    std::uint64_t end() const noexcept { return start + length; }
};

/// A fixed number of fades.
class fades {
public:
    static constexpr std::int32_t none = -1;

    bool any() const noexcept { return used_ != 0; }
    /// Returns the number of a score's fade, or none.
    std::int32_t find(std::uint32_t score) const noexcept;
    /// Begins a fade. Returns its number, or none if all are in use.
    std::int32_t begin(std::uint32_t score, std::uint64_t start, std::uint64_t length) noexcept;
    void end(std::int32_t i) noexcept;
    void clear() noexcept;
    const fade& operator[](std::int32_t i) const noexcept { return fades_[static_cast<std::size_t>(i)]; }
    bool any_ended(std::uint64_t by) const noexcept;
    /// Frees the fades that have ended by a frame.
    void end_all(std::uint64_t by) noexcept;

private:
    std::array<fade, 256> fades_{};
    std::uint32_t used_ = 0;
};

} // namespace tactor::synth
