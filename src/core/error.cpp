// SPDX-License-Identifier: MIT
#include <tactor/error.hpp>

#include <utility>

#include <fmt/format.h>

#include <tactor/version.hpp>

#include "core/marks.hpp"

namespace tactor {
inline namespace v0 {
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

struct error::data {
    std::string text = {};    ///< the message without marks
    std::string subject = {}; ///< may contain marks, like reason and advice
    std::string reason = {};
    std::string advice = {};
    std::string field = {};
    source_place place = {};
    int os_code = 0;

    /// Returns a copy with another subject, reason and hint.
    data with_text(std::string_view what, std::string_view why, std::string_view hint) const
    {
        data d = *this;
        d.subject = what;
        d.reason = why;
        d.advice = hint;
        // A file name may contain braces, so only a subject that is a whole mark is replaced.
        const auto m = detail::find_mark(what);
        const bool whole = m && m->text.size() == what.size();
        d.text = fmt::format("{}: {}", whole ? detail::plain(*m) : std::string(what), why);
        if (!hint.empty())
            d.text += fmt::format(" ({})", detail::plain(hint));
        // Escape zero bytes: the string that what() returns ends at the first one.
        for (std::size_t at = d.text.find('\0'); at != std::string::npos; at = d.text.find('\0', at))
            d.text.replace(at, 1, "\\x00");
        return d;
    }
};

error::error(error_kind kind, data d)
    : std::system_error(make_error_code(kind)), data_(std::make_shared<const data>(std::move(d)))
{
}

error::error(error_kind kind, std::string_view what, std::string_view why, std::string_view hint)
    : error(kind, data().with_text(what, why, hint))
{
}

error::error(error_kind kind, const source_place& at, std::string_view why, std::string_view hint)
    : error(kind, data{.place = at}.with_text(at.text(), why, hint))
{
}

error::~error() = default;

error_kind error::kind() const noexcept
{
    return static_cast<error_kind>(code().value());
}

const char* error::what() const noexcept
{
    return data_->text.c_str();
}

std::string_view error::subject() const noexcept
{
    return data_->subject;
}

std::string_view error::why() const noexcept
{
    return data_->reason;
}

std::string_view error::hint() const noexcept
{
    return data_->advice;
}

std::string_view error::field() const noexcept
{
    return data_->field;
}

const source_place& error::place() const noexcept
{
    return data_->place;
}

int error::os_code() const noexcept
{
    return data_->os_code;
}

error error::with_field(std::string_view field) const
{
    data d = *data_;
    d.field = field;
    return {kind(), std::move(d)};
}

error error::with_place(source_place at) const
{
    data d = *data_;
    d.place = std::move(at);
    return {kind(), std::move(d)};
}

error error::with_os_code(int code) const
{
    data d = *data_;
    d.os_code = code;
    return {kind(), std::move(d)};
}

error error::reworded(std::string_view what, std::string_view why, std::string_view hint) const
{
    return {kind(), data_->with_text(what, why, hint)};
}

#define TACTOR_TEXT(x) #x
#define TACTOR_DOTTED(major, minor, patch) TACTOR_TEXT(major) "." TACTOR_TEXT(minor) "." TACTOR_TEXT(patch)

const char* version() noexcept
{
    return TACTOR_DOTTED(TACTOR_VERSION_MAJOR, TACTOR_VERSION_MINOR, TACTOR_VERSION_PATCH);
}

} // namespace v0
} // namespace tactor
