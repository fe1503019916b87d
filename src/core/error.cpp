// SPDX-License-Identifier: MIT
#include <tactor/error.hpp>

#include <fmt/format.h>

#include <tactor/version.hpp>

namespace tactor {
namespace {

class category final : public std::error_category {
public:
    const char* name() const noexcept override { return "tactor"; }

    std::string message(int e) const override
    {
        switch (static_cast<error_kind>(e)) {
        case error_kind::bad_input:
            return "bad input";
        case error_kind::runtime:
            return "failed while running";
        case error_kind::not_available:
            return "device not available";
        }
        return "unknown error";
    }
};

} // namespace

const std::error_category& error_category() noexcept
{
    static const category c;
    return c;
}

std::error_code make_error_code(error_kind e) noexcept
{
    return {static_cast<int>(e), error_category()};
}

std::string source_place::text() const
{
    std::string t = file;
    if (line != 0)
        t += fmt::format("{}{}", t.empty() ? "line " : ":", line);
    if (column != 0)
        t += fmt::format(":{}", column);
    return t;
}

error::error(error_kind kind, std::string_view what, std::string_view why, std::string_view hint)
    : std::system_error(make_error_code(kind)),
      text_(hint.empty() ? fmt::format("{}: {}", what, why) : fmt::format("{}: {} ({})", what, why, hint)),
      why_at_(what.size() + 2),
      hint_at_(hint.empty() ? text_.size() : why_at_ + why.size() + 2)
{
}

error_kind error::kind() const noexcept
{
    return static_cast<error_kind>(code().value());
}

const char* error::what() const noexcept
{
    return text_.c_str();
}

// The text is empty where the error was moved from.
std::string_view error::subject() const noexcept
{
    return std::string_view(text_).substr(0, why_at_ - 2);
}

std::string_view error::why() const noexcept
{
    if (why_at_ > text_.size())
        return {};
    const std::size_t end = hint_at_ == text_.size() ? hint_at_ : hint_at_ - 2;
    return std::string_view(text_).substr(why_at_, end - why_at_);
}

std::string_view error::hint() const noexcept
{
    if (hint_at_ > text_.size())
        return {};
    const std::string_view rest = std::string_view(text_).substr(hint_at_);
    return rest.substr(0, rest.empty() ? 0 : rest.size() - 1);
}

#define TACTOR_TEXT(x) #x
#define TACTOR_DOTTED(major, minor, patch) TACTOR_TEXT(major) "." TACTOR_TEXT(minor) "." TACTOR_TEXT(patch)

const char* version() noexcept
{
    return TACTOR_DOTTED(TACTOR_VERSION_MAJOR, TACTOR_VERSION_MINOR, TACTOR_VERSION_PATCH);
}

} // namespace tactor
