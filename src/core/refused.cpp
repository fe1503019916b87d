// SPDX-License-Identifier: MIT
#include "core/refused.hpp"

#include <cerrno>
#include <exception>
#include <system_error>

namespace tactor::detail {
namespace {

/// Returns the errno of the exception that is being handled, or 0 if it has none.
int current_errno() noexcept
{
    try {
        throw;
    } catch (const error& e) {
        return e.os_code();
    } catch (const std::system_error& e) {
        const std::error_category& c = e.code().category();
        return c == std::generic_category() || c == std::system_category() ? e.code().value() : 0;
    } catch (...) {
        return 0;
    }
}

} // namespace

error bad_field(std::string_view field, std::string_view why, std::string_view hint)
{
    return error(error_kind::bad_input, field, why, hint).with_field(field);
}

void throw_with_cause(const error& e)
{
    if (std::current_exception() == nullptr)
        throw error(e);
    std::throw_with_nested(e.os_code() != 0 ? e : e.with_os_code(current_errno()));
}

void throw_with_cause(const error& e, int code)
{
    if (code == 0)
        throw_with_cause(e);
    try {
        throw std::system_error(code, std::generic_category());
    } catch (...) {
        throw_with_cause(e.with_os_code(code));
    }
}

std::string_view errno_hint(int code) noexcept
{
    switch (code) {
    case EMFILE:
        return "close some of the files that this process has open, or raise the limit: ulimit -n";
    case ENFILE:
        return "close some programs, or raise the system's limit on open files: fs.file-max";
    case EAGAIN:
        return "end some processes, or raise the limit on threads: ulimit -u";
    case ENOMEM:
        return "end some programs: the system is short of memory";
    default:
        return {};
    }
}

void throw_resource_error(std::string_view what, int code, std::string_view why)
{
    throw_with_cause(error(error_kind::runtime, what, why, errno_hint(code)), code);
}

} // namespace tactor::detail
