// SPDX-License-Identifier: MIT
/// \file
/// Where a peer's messages end in the bytes of its WebSocket, and how it says goodbye (RFC 6455, sections 5.2
/// and 5.5.1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactor::net {

/// Reads heads of frames and the payload of close frames. Beast checks everything but what is asked for here.
class web_frames {
public:
    /// The next bytes that have come.
    void take(std::span<const std::byte> bytes) noexcept;
    /// Whether a message or a control frame has begun and is not there as a whole.
    bool open() const noexcept { return within_ || continued_; }
    /// Messages that were there as a whole: of the open one, its number.
    std::uint64_t whole() const noexcept { return whole_; }
    /// Tests whether the peer has closed with a reason that is no UTF-8.
    bool has_bad_reason() const;

private:
    std::size_t head_length() const noexcept;
    void begin_payload() noexcept;
    void end_frame() noexcept;
    bool is_close() const noexcept;
    void take_farewell(std::span<const std::byte> bytes) noexcept;

    std::array<std::byte, 14> head_{};
    std::size_t have_ = 0;   ///< of the head
    std::uint64_t left_ = 0; ///< of the payload, behind the head
    bool in_payload_ = false;
    bool within_ = false;    ///< a frame
    bool continued_ = false; ///< a message, by the next frame
    std::uint64_t whole_ = 0;
    std::array<char, 125> farewell_{}; ///< payload of the close frame
    std::size_t farewell_size_ = 0;
};

} // namespace tactor::net
