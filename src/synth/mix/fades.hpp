// SPDX-License-Identifier: MIT
/// \file
/// Scores that fade out.
#pragma once

#include <array>
#include <cstdint>

#include "synth/mix/window.hpp"

namespace tactor::synth {

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
