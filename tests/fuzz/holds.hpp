// SPDX-License-Identifier: MIT
// Rules for anything that a reader or a planner accepts, whatever the input. The only exception they may
// throw is tactor::error; any other, and a HOLDS that fails, is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/stroke.hpp>

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): it names the line and the condition.
#define HOLDS(condition)                                                                                     \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);              \
            std::abort();                                                                                    \
        }                                                                                                    \
    } while (false)

namespace tactor::fuzz {

/// A reader's answer; nothing where it refused in the one way that is allowed, with a message.
template <typename Read>
auto accepted(Read read) -> decltype(read())
{
    try {
        return read();
    } catch (const error& e) {
        HOLDS(!std::string_view(e.what()).empty());
        HOLDS(e.kind() == error_kind::bad_input);
        return {};
    }
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size)
{
    return {reinterpret_cast<const char*>(data), size}; // NOLINT(*-reinterpret-cast): libFuzzer gives bytes
}

/// An array that a reader accepted is valid, and its layout, where one can be made, serves every phantom
/// model.
void check_array(const array& a);

/// Everything that can be asked of a path or a movement is finite and in its bounds.
void check_path(const path& p);
void check_stroke(const stroke& s);

/// The first 2048 frames are within full scale, and numbers.
void check_samples(const score& s);

/// Finite, in order, within the array, and no louder than the stroke.
void check_plan(const array& a, const stroke& s, const plan_options& o, const plan& p);

} // namespace tactor::fuzz
