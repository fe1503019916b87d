// SPDX-License-Identifier: MIT
#include "net/base64.hpp"

#include <array>
#include <cstdint>

namespace tactor::net {
namespace {

constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr unsigned digit_bits = 6;
constexpr unsigned digit_mask = 63;
constexpr std::uint8_t no_digit = 255;

constexpr std::array<std::uint8_t, 256> values = [] {
    std::array<std::uint8_t, 256> v{};
    v.fill(no_digit);
    for (std::size_t i = 0; i < digits.size(); ++i)
        v[static_cast<unsigned char>(digits[i])] = static_cast<std::uint8_t>(i);
    return v;
}();

std::uint32_t byte_at(std::string_view bytes, std::size_t i)
{
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
}

} // namespace

void append_base64(std::string& to, std::string_view bytes)
{
    to.reserve(to.size() + base64_size(bytes.size()));
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::uint32_t three =
            byte_at(bytes, i) << 16U | byte_at(bytes, i + 1) << 8U | byte_at(bytes, i + 2);
        for (unsigned k = 0; k < 4; ++k)
            to += i + k > bytes.size() ? '=' : digits[three >> (digit_bits * (3 - k)) & digit_mask];
    }
}

std::optional<std::string> read_base64(std::string_view text)
{
    if (text.size() % 4 != 0)
        return std::nullopt;
    const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
    text.remove_suffix(padding);
    std::string bytes;
    bytes.reserve(text.size() * 3 / 4);
    std::uint32_t kept = 0;
    unsigned bits = 0;
    for (const char c : text) {
        const std::uint8_t value = values[static_cast<unsigned char>(c)];
        if (value == no_digit)
            return std::nullopt;
        kept = (kept << digit_bits | value) & 0xFFFFU;
        bits += digit_bits;
        if (bits < 8)
            continue;
        bits -= 8;
        bytes += static_cast<char>(kept >> bits & 0xFFU);
    }
    if ((kept & ((1U << bits) - 1U)) != 0) // bits that no byte has
        return std::nullopt;
    return bytes;
}

} // namespace tactor::net
