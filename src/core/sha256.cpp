// SPDX-License-Identifier: MIT
#include "core/sha256.hpp"

#include <bit>

#include <fmt/format.h>
#include <sha2.h>

namespace tactor::detail {

namespace {

void add_bytes(SHA2_CTX& context, std::string_view bytes)
{
    ::SHA256Update(&context, std::bit_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

sha256_digest finish(SHA2_CTX& context)
{
    sha256_digest digest{};
    ::SHA256Final(digest.data(), &context);
    return digest;
}

std::string digits(const sha256_digest& digest)
{
    std::string s;
    for (const std::uint8_t b : digest)
        s += fmt::format("{:02x}", b);
    return s;
}

} // namespace

sha256_digest sha256(std::string_view bytes)
{
    SHA2_CTX context;
    ::SHA256Init(&context);
    add_bytes(context, bytes);
    return finish(context);
}

std::string sha256_text(std::string_view bytes)
{
    return digits(sha256(bytes));
}

struct sha256_sum::context {
    SHA2_CTX of_library;
};

sha256_sum::sha256_sum() : context_(std::make_unique<context>())
{
    ::SHA256Init(&context_->of_library);
}

sha256_sum::~sha256_sum() = default;

void sha256_sum::add(std::string_view bytes)
{
    add_bytes(context_->of_library, bytes);
}

std::string sha256_sum::text()
{
    return digits(finish(context_->of_library));
}

} // namespace tactor::detail
