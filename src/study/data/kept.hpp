// SPDX-License-Identifier: MIT
/// \file
/// What is said where a disk does not take what somebody answered.
#pragma once

#include <cerrno>

namespace tactor::study {

/// What is kept, and what to do, for an errno.
constexpr const char* what_is_kept(int code) noexcept
{
    if (code == ENOSPC || code == EDQUOT)
        return "what was answered before is kept; free some space, and --resume goes on";
    if (code == EROFS)
        return "what was answered before is kept; make the disk writable again, and --resume goes on";
    return "what was answered before is kept; --resume goes on";
}

} // namespace tactor::study
