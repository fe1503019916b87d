// SPDX-License-Identifier: MIT
// Texts for people are long; tests check the parts that matter.
#pragma once

#include <string>

#include <doctest/doctest.h>

/// Checks that a text has a part; shows both where it is missing.
inline bool has(const std::string& text, const std::string& part)
{
    INFO(text);
    const bool found = text.find(part) != std::string::npos;
    CHECK_MESSAGE(found, part);
    return found;
}
