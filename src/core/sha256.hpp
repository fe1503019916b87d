// SPDX-License-Identifier: MIT
/// \file
/// SHA-256 (FIPS 180-4), for seeds from text and for identifiers of plans.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace tactor::detail {

using sha256_digest = std::array<std::uint8_t, 32>;

sha256_digest sha256(std::string_view bytes);

/// Returns the digest as 64 lower-case hexadecimal digits.
std::string sha256_text(std::string_view bytes);

/// A SHA-256 digest of data that is added in parts.
class sha256_sum {
public:
    sha256_sum();
    ~sha256_sum();

    void add(std::string_view bytes);
    /// Returns the digest in the format of sha256_text(). Call it once, after the last add().
    std::string text();

private:
    struct context;
    std::unique_ptr<context> context_;
};

} // namespace tactor::detail
