// SPDX-License-Identifier: MIT
#include "net/web_frames.hpp"

#include <algorithm>
#include <string_view>

#include "net/rpc.hpp"

namespace tactor::net {
namespace {

constexpr std::byte final_bit{0x80};
constexpr std::byte control_bit{0x08};
constexpr std::byte mask_bit{0x80};
constexpr std::byte length_bits{0x7f};
constexpr std::byte kind_bits{0x0f};
constexpr std::byte close_kind{0x08};

// Returns the bytes of the length after the two bytes that each head has.
std::size_t more_length(std::byte second) noexcept
{
    const auto length = std::to_integer<unsigned>(second & length_bits);
    return length == 127 ? 8 : length == 126 ? 2 : 0;
}

} // namespace

void web_frames::take(std::span<const std::byte> bytes) noexcept
{
    while (!bytes.empty()) {
        if (in_payload_) {
            const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(left_, bytes.size()));
            take_farewell(bytes.first(n));
            left_ -= n;
            bytes = bytes.subspan(n);
        } else {
            within_ = true;
            head_[have_++] = bytes.front();
            bytes = bytes.subspan(1);
            if (have_ < head_length())
                continue;
            begin_payload();
        }
        if (left_ == 0)
            end_frame();
    }
}

std::size_t web_frames::head_length() const noexcept
{
    if (have_ < 2)
        return 2;
    return 2 + more_length(head_[1]) + ((head_[1] & mask_bit) != std::byte{} ? 4 : 0);
}

void web_frames::begin_payload() noexcept
{
    const std::size_t more = more_length(head_[1]);
    left_ = more == 0 ? std::to_integer<std::uint64_t>(head_[1] & length_bits) : 0;
    for (std::size_t i = 2; i < 2 + more; ++i)
        left_ = left_ << 8 | std::to_integer<std::uint64_t>(head_[i]);
    in_payload_ = true;
}

// Counts the message at its last frame. Control frames may come between the frames of a message.
void web_frames::end_frame() noexcept
{
    if ((head_[0] & control_bit) == std::byte{}) {
        continued_ = (head_[0] & final_bit) == std::byte{};
        whole_ += continued_ ? 0 : 1;
    }
    within_ = in_payload_ = false;
    have_ = 0;
}

bool web_frames::is_close() const noexcept
{
    return (head_[0] & kind_bits) == close_kind;
}

// Stores the payload of a close frame. Beast refuses a longer one.
void web_frames::take_farewell(std::span<const std::byte> bytes) noexcept
{
    if (!is_close())
        return;
    const bool masked = (head_[1] & mask_bit) != std::byte{};
    for (const std::byte b : bytes.first(std::min(bytes.size(), farewell_.size() - farewell_size_))) {
        const std::byte mask = masked ? head_[have_ - 4 + farewell_size_ % 4] : std::byte{};
        farewell_[farewell_size_++] = static_cast<char>(b ^ mask);
    }
}

bool web_frames::has_bad_reason() const
{
    constexpr std::size_t code_bytes = 2;
    if (farewell_size_ <= code_bytes)
        return false;
    try {
        const std::string_view all(farewell_.data(), farewell_size_);
        static_cast<void>(json(all.substr(code_bytes)).dump());
        return false;
    } catch (const json::exception&) {
        return true;
    }
}

} // namespace tactor::net
