// SPDX-License-Identifier: MIT
/// \file
/// When a stroke starts.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor::detail {

/// Types that can count frames or nanoseconds. Seconds in a double would be taken for a count of 0 or 1.
template <typename T>
concept whole_number = std::integral<T> && !std::same_as<T, bool>;
template <typename T>
concept no_count = std::floating_point<T> || std::same_as<T, bool>;

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

/// What a stroke's start waits for.
enum class start_kind { frame, time, trigger };
TACTOR_KIND(start_kind);

/// When a stroke starts. A plain value.
class start_at {
public:
    start_at(const auto& frame_or_seconds) = delete; ///< say which: frame(), time()

    /// With the next period that is written.
    [[nodiscard]] static constexpr start_at now() noexcept { return {}; }
    /// From a frame of the stream on. A frame that has been written already means as soon as possible; a
    /// stroke whose frame never comes waits until it is cancelled. The count of frames goes on over an xrun.
    /// \throws error (bad_input) for a negative frame.
    template <detail::whole_number T>
    [[nodiscard]] static constexpr start_at frame(T stream_frame)
    {
        if constexpr (std::signed_integral<T>)
            if (stream_frame < 0)
                refuse_frame(stream_frame);
        start_at s;
        s.frame_ = static_cast<std::uint64_t>(stream_frame);
        return s;
    }
    template <detail::no_count T>
    static start_at frame(T seconds) = delete;
    /// The first sample is at the DAC at this time, CLOCK_MONOTONIC in ns: within half a frame and the error
    /// of the DAC clock. A time that has passed means as soon as possible; see stroke_report::late_s. Any
    /// number may be given.
    template <detail::no_count T>
    static start_at time(T seconds) = delete;
    [[nodiscard]] static constexpr start_at time(std::int64_t monotonic_ns) noexcept
    {
        start_at s;
        s.kind_ = start_kind::time;
        s.time_ns_ = monotonic_ns;
        return s;
    }
    /// Armed: waits, silent, for an edge at player_lines::trigger or for player::fire(), whichever is first.
    [[nodiscard]] static constexpr start_at trigger() noexcept
    {
        start_at s;
        s.kind_ = start_kind::trigger;
        return s;
    }

    [[nodiscard]] constexpr start_kind what() const noexcept { return kind_; }
    [[nodiscard]] constexpr std::uint64_t stream_frame() const noexcept { return frame_; }
    [[nodiscard]] constexpr std::int64_t time_ns() const noexcept { return time_ns_; }

private:
    constexpr start_at() noexcept = default;
    [[noreturn]] TACTOR_API static void refuse_frame(long long stream_frame);

    start_kind kind_ = start_kind::frame;
    std::uint64_t frame_ = 0;
    std::int64_t time_ns_ = 0;
};

} // namespace v0
} // namespace tactor
