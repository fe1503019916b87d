// SPDX-License-Identifier: MIT
/// \file
/// Ends of messages in the bytes of a WebSocket, and the peer's close frame (RFC 6455, sections 5.2 and
/// 5.5.1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactor::net {

/// Parser of frame heads and the payload of close frames. Beast checks everything else.
class web_frames {
public:
    /// Parses the next bytes.
    void take(std::span<const std::byte> bytes) noexcept;
    /// Returns true if a message or a control frame has begun and is incomplete.
    bool open() const noexcept { return within_ || continued_; }
    /// Returns the number of complete messages, which is also the number of the open one.
    std::uint64_t whole() const noexcept { return whole_; }
    /// Returns true if the peer has closed with a reason that is not UTF-8.
    bool has_bad_reason() const;

private:
    std::size_t head_length() const noexcept;
    void begin_payload() noexcept;
    void end_frame() noexcept;
    bool is_close() const noexcept;
    void take_farewell(std::span<const std::byte> bytes) noexcept;

    std::array<std::byte, 14> head_{};
    std::size_t have_ = 0;   ///< bytes of the head
    std::uint64_t left_ = 0; ///< bytes of the payload, after the head
    bool in_payload_ = false;
    bool within_ = false;    ///< within a frame
    bool continued_ = false; ///< the next frame continues a message
    std::uint64_t whole_ = 0;
    std::array<char, 125> farewell_{}; ///< payload of the close frame
    std::size_t farewell_size_ = 0;
};

} // namespace tactor::net
