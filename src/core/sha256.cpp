// SPDX-License-Identifier: MIT
#include "core/sha256.hpp"

#include <bit>

#include <fmt/format.h>
#include <sha2.h>

namespace tactor::detail {

sha256_digest sha256(std::string_view bytes)
{
    SHA2_CTX context;
    ::SHA256Init(&context);
    ::SHA256Update(&context, std::bit_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    sha256_digest digest{};
    ::SHA256Final(digest.data(), &context);
    return digest;
}

std::string sha256_text(std::string_view bytes)
{
    std::string s;
    for (const std::uint8_t b : sha256(bytes))
        s += fmt::format("{:02x}", b);
    return s;
}

} // namespace tactor::detail
