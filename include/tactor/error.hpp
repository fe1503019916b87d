// SPDX-License-Identifier: MIT
/// \file
/// The one exception type that set-up code throws, and messages of the library about its own work.
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

/// What kind of failure it was.
enum class error_kind {
    bad_input = 1,     ///< wrong usage or bad input
    runtime = 2,       ///< failed while running (disk full, stream broken)
    not_available = 3, ///< a device is missing, busy or cannot do what is asked
};
TACTOR_KIND(error_kind);

[[nodiscard]] TACTOR_API const std::error_category& error_category() noexcept;
[[nodiscard]] TACTOR_API std::error_code make_error_code(error_kind e) noexcept;

/// A place in a text that the user wrote. Lines and columns count from 1; 0 means unknown.
struct source_place {
    std::string file;
    unsigned line = 0;
    unsigned column = 0;

    /// "file:line:column" with the unknown parts left out.
    [[nodiscard]] TACTOR_API std::string text() const;
};

/// An error that says what failed, why, and what to do about it.
///
/// what() reads "WHAT: WHY (HINT)", or "WHAT: WHY" without a hint.
///
/// Where another failure was the cause, it is nested in this error (std::rethrow_if_nested()): the error of a
/// file that another one names, or what the system said, as a std::system_error with its errno. Where memory
/// runs out, std::bad_alloc comes through; while TOML is read, the process ends (toml++ 3 does so), and while
/// ALSA is asked for PCMs, it may end (alsa-lib 1.2.8). Copies share the texts, and do not throw.
class TACTOR_API error : public std::system_error {
public:
    error(error_kind kind, std::string_view what, std::string_view why, std::string_view hint = {});
    /// About a place: its text is WHAT.
    error(error_kind kind, const source_place& at, std::string_view why, std::string_view hint = {});

    /// The kind of failure.
    [[nodiscard]] error_kind kind() const noexcept;
    [[nodiscard]] const char* what() const noexcept override;
    // The parts of what(), for programs that show them apart; valid while the error or a copy of it lives.
    [[nodiscard]] std::string_view subject() const noexcept; ///< WHAT
    [[nodiscard]] std::string_view why() const noexcept;     ///< WHY
    [[nodiscard]] std::string_view hint() const noexcept;    ///< HINT; may be empty
    /// The option or value that the error is about, under its name in this library or, with a place(), in the
    /// file ("soa_s"). Empty where it is about none, or about several that do not go together.
    [[nodiscard]] std::string_view field() const noexcept;
    /// The place in a file or text; without file and line where the error is about none.
    [[nodiscard]] const source_place& place() const noexcept;
    /// errno of the call that failed; 0 where none did.
    [[nodiscard]] int os_code() const noexcept;

    /// This error with a field, a place or an errno.
    [[nodiscard]] error with_field(std::string_view field) const;
    [[nodiscard]] error with_place(source_place at) const;
    [[nodiscard]] error with_os_code(int code) const;
    /// This error in other words.
    [[nodiscard]] error reworded(std::string_view what, std::string_view why, std::string_view hint) const;

    error(const error&) noexcept = default;
    error& operator=(const error&) noexcept = default;
    ~error() override;

private:
    struct data;
    error(error_kind kind, data d);

    std::shared_ptr<const data> data_; ///< never none: an error is not moved from
};

/// The importance of a message.
enum class log_kind {
    debug,   ///< what was tried
    info,    ///< what was agreed on, begins, goes on or ends in order
    warning, ///< what was felt wrongly, or may be: xruns, mutes, limits that acted
    error,   ///< what ended the stream
};
TACTOR_KIND(log_kind);

/// Takes one line without a line end, UTF-8, for people: its words may change with each version. An empty
/// function turns it off. Called by the thread that opens a device or a player, then by the player's control
/// thread, where no lock is held: it may call the player. The audio thread never calls it, but a slow
/// function keeps drives waiting. Exceptions from it are dropped, and so are lines for which there is no
/// memory.
using log_function = std::function<void(log_kind, std::string_view)>;

} // namespace v0
} // namespace tactor

template <>
struct std::is_error_code_enum<tactor::error_kind> : std::true_type {
};
