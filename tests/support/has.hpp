// SPDX-License-Identifier: MIT
// Texts for people are long; tests hold what matters in them.
#pragma once

#include <string>

#include <doctest/doctest.h>

/// Checks that a text has a part; shows both when it has not.
inline bool has(const std::string& text, const std::string& part)
{
    INFO(text);
    const bool found = text.find(part) != std::string::npos;
    CHECK_MESSAGE(found, part);
    return found;
}
