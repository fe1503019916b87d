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

/// A text that is refused, and how its message begins.
struct refused_text {
    std::string text;
    std::string message;
};

/// Checks the messages about texts.
template <class Rows, class F>
void check_messages(const Rows& rows, F refusal)
{
    for (const refused_text& r : rows) {
        CAPTURE(r.text);
        const std::string got = refusal(r.text);
        CAPTURE(got);
        CHECK(got.substr(0, r.message.size()) == r.message);
    }
}
