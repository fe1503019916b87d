// SPDX-License-Identifier: MIT
#include "net/base64.hpp"

#include <utility>

#include <boost/beast/core/detail/base64.hpp>

namespace tactor::net {
namespace {

namespace base64 = boost::beast::detail::base64;

} // namespace

void append_base64(std::string& to, std::string_view bytes)
{
    const std::size_t before = to.size();
    to.resize(before + base64::encoded_size(bytes.size()));
    base64::encode(to.data() + before, bytes.data(), bytes.size());
}

std::optional<std::string> read_base64(std::string_view text)
{
    if (text.size() % 4 != 0) // Beast would write past the end
        return std::nullopt;
    std::string bytes(base64::decoded_size(text.size()), '\0');
    bytes.resize(base64::decode(bytes.data(), text.data(), text.size()).first);
    // Beast ends at the first character that is none of base64, and ignores bits that no byte has.
    std::string again;
    append_base64(again, bytes);
    return again == text ? std::optional(std::move(bytes)) : std::nullopt;
}

} // namespace tactor::net
