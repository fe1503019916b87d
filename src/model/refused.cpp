// SPDX-License-Identifier: MIT
#include "model/refused.hpp"

#include <cerrno>

#include <tactor/error.hpp>

namespace tactor::detail {

std::string_view advice_for(int code) noexcept
{
    switch (code) {
    case EMFILE:
        return "this process has too many files open: close some, or raise the limit (ulimit -n)";
    case ENFILE:
        return "the whole system has too many files open: see fs.file-max";
    case EAGAIN:
        return "the limit on threads may be reached: ulimit -u";
    case ENOMEM:
        return "the system is short of memory";
    default:
        return {};
    }
}

void refused_by_system(std::string_view what, int code, std::string_view why)
{
    throw error(errc::runtime, what, why, advice_for(code));
}

} // namespace tactor::detail
