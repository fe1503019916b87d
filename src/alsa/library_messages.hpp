// SPDX-License-Identifier: MIT
/// \file
/// What libasound has to say, for error messages instead of the user's standard error.
#pragma once

#include <string>

namespace tactor::pcm {

/// Collects libasound's first message of this thread while it lives. The first one makes libasound silent
/// for the whole process and for good: it has one handler only.
class library_messages {
public:
    library_messages();
    ~library_messages();
    library_messages(const library_messages&) = delete;
    library_messages& operator=(const library_messages&) = delete;

    /// The first message since construction, or nothing.
    std::string first() const;
};

} // namespace tactor::pcm
