// SPDX-License-Identifier: MIT
/// \file
/// The exception type that set-up code throws, and the library's log messages about its own work.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// Kind of a failure.
enum class error_kind {
    bad_input = 1,     ///< wrong usage or bad input
    runtime = 2,       ///< failed while running (disk full, stream broken)
    not_available = 3, ///< a device is missing, busy or cannot do what was requested
};
TACTOR_KIND(error_kind);

/// Returns the category of error codes made from error_kind.
[[nodiscard]] TACTOR_API const std::error_category& error_category() noexcept;
[[nodiscard]] TACTOR_API std::error_code make_error_code(error_kind e) noexcept;

/// A place in a text that the user wrote. Lines and columns count from 1; 0 means unknown.
struct source_place {
    std::string file;
    unsigned line = 0;
    unsigned column = 0;

    /// Returns "file:line:column" without the unknown parts.
    [[nodiscard]] TACTOR_API std::string text() const;
};

/// An error that says what failed, why, and what to do about it.
///
/// what() reads "WHAT: WHY (HINT)", or "WHAT: WHY" without a hint.
///
/// If another failure caused this error, that failure is nested in it, see std::rethrow_if_nested(). It is
/// either the error of a file that another file names, or a std::system_error with the errno of a system
/// call.
///
/// When memory runs out, std::bad_alloc passes through, with two exceptions. toml++ 3 ends the process if
/// this happens while it reads TOML. alsa-lib 1.2.8 may end the process if this happens while it looks up
/// PCMs.
///
/// Copies share the texts and do not throw.
class TACTOR_API error : public std::system_error {
public:
    error(error_kind kind, std::string_view what, std::string_view why, std::string_view hint = {});
    /// Makes an error about a place. The text() of the place becomes WHAT.
    error(error_kind kind, const source_place& at, std::string_view why, std::string_view hint = {});

    /// Returns the kind of failure.
    [[nodiscard]] error_kind kind() const noexcept;
    [[nodiscard]] const char* what() const noexcept override;
    // Parts of what(), for programs that show them separately. They are valid while this error or a copy of
    // it lives.
    [[nodiscard]] std::string_view subject() const noexcept; ///< WHAT
    [[nodiscard]] std::string_view why() const noexcept;     ///< WHY
    [[nodiscard]] std::string_view hint() const noexcept; ///< HINT; "{soa_s}" marks an option; may be empty
    /// Returns the name of the option or value at fault, such as "soa_s". This is its name in the file if the
    /// error has a place(), else its name in this library. Returns an empty text if the error concerns no
    /// value, or several values that do not belong together.
    [[nodiscard]] std::string_view field() const noexcept;
    /// Returns the place in a file or text. If the error is not about a place, file and line are not set.
    [[nodiscard]] const source_place& place() const noexcept;
    /// Returns the errno of the failed call, or 0.
    [[nodiscard]] int os_code() const noexcept;

    /// Returns a copy with this field, place or errno.
    [[nodiscard]] error with_field(std::string_view field) const;
    [[nodiscard]] error with_place(source_place at) const;
    [[nodiscard]] error with_os_code(int code) const;
    /// Returns a copy with other texts.
    [[nodiscard]] error reworded(std::string_view what, std::string_view why, std::string_view hint) const;

    error(const error&) noexcept = default;
    error& operator=(const error&) noexcept = default;
    ~error() override;

private:
    struct data;
    error(error_kind kind, data d);

    std::shared_ptr<const data> data_; ///< never null: an error is never moved from
};

/// Importance of a message.
enum class log_kind {
    debug,   ///< attempts that failed, and details of devices
    info,    ///< what devices accepted; start, progress and orderly end of a stream
    warning, ///< faults that are or may be felt: xruns, mutes, limits that acted
    error,   ///< causes of the end of a stream
};
TACTOR_KIND(log_kind);

/// Function that receives one line of text for people, in UTF-8 and without a line end. The wording may
/// change with each version. An empty function turns messages off.
///
/// The thread that opens a device or a player calls the function, and later the player's control thread does.
/// The caller holds no lock, so the function may call the player. The audio thread never calls it, but a slow
/// function delays drives. The caller ignores exceptions from the function, and drops a line if memory runs
/// out.
using log_function = std::function<void(log_kind, std::string_view)>;

} // namespace v0
} // namespace tactor

template <>
struct std::is_error_code_enum<tactor::error_kind> : std::true_type {
};
