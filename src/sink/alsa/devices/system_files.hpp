// SPDX-License-Identifier: MIT
/// \file
/// Reads small text files of /proc. A file that cannot be read counts as empty.
#pragma once

#include <charconv>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace tactor::pcm {

/// Returns the whole text as a number, or nothing.
template <typename T>
std::optional<T> number(std::string_view text)
{
    T v{};
    const auto r = std::from_chars(text.data(), text.data() + text.size(), v);
    if (r.ec != std::errc() || r.ptr != text.data() + text.size())
        return {};
    return v;
}

/// Returns the text without blanks at both ends.
std::string trimmed(std::string_view s);

/// Returns the lines of a file; empty if it cannot be read.
/// \throws error (runtime), here and below, without a descriptor.
std::vector<std::string> lines_of(const std::filesystem::path& file);

/// Returns the value after "key:" in a file of such lines.
std::string field(const std::filesystem::path& file, std::string_view key);

/// Returns the entries of a folder, in no order.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

} // namespace tactor::pcm
