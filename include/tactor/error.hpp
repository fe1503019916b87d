// SPDX-License-Identifier: MIT
/// \file
/// The one exception type that set-up code throws.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include <tactor/api.hpp>

namespace tactor {

/// What kind of failure it was.
enum class errc {
    bad_input = 1,     ///< wrong usage or bad input
    runtime = 2,       ///< failed while running (disk full, stream broken)
    not_available = 3, ///< a device is missing, busy or cannot do what is asked
};

TACTOR_API const std::error_category& error_category() noexcept;
TACTOR_API std::error_code make_error_code(errc e) noexcept;

/// A place in a text that the user wrote. Lines and columns count from 1; 0 means unknown.
struct source_place {
    std::string file;
    unsigned line = 0;
    unsigned column = 0;

    /// "file:line:column" with the unknown parts left out.
    TACTOR_API std::string text() const;
};

/// An error that says what failed, why, and what to do about it.
///
/// what() reads "WHAT: WHY (HINT)", or "WHAT: WHY" without a hint.
class TACTOR_API error : public std::system_error {
public:
    error(errc kind, std::string_view what, std::string_view why, std::string_view hint = {});

    /// The kind of failure.
    errc kind() const noexcept;
    const char* what() const noexcept override;
    /// The parts of what(), for programs that set them apart; valid while the error lives.
    std::string_view subject() const noexcept; ///< WHAT
    std::string_view why() const noexcept;     ///< WHY
    std::string_view hint() const noexcept;    ///< HINT; may be empty

private:
    std::string text_;
    std::size_t why_at_;
    std::size_t hint_at_; ///< size of the text where there is none
};

/// The one of `known` that `name` is a slip of, e.g. "chanel" of "channel" or "pitch" of "pitch_mm",
/// for a hint in an error; empty if none is near.
TACTOR_API std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

} // namespace tactor

template <>
struct std::is_error_code_enum<tactor::errc> : std::true_type {
};
