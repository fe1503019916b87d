// SPDX-License-Identifier: MIT
/// Calls of the library that may throw, to be tried without descriptors and without memory.
/// tests/exhaustion.py checks that none is missing: each overload stands under its name once, a member's with
/// that of its class. Other ways to call it have more after a comma.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

#include "folder.hpp"
#include "scores.hpp"

namespace tactor::test {

/// Effect of a call that matters here.
enum class call_kind {
    plain,
    opens, ///< needs a descriptor
    /// Call that is not tried without memory, because other people's code would end the process: reads TOML
    /// (toml++ 3 is noexcept where it allocates), or ALSA's configuration (alsa-lib 1.2.8 does not check its
    /// allocations).
    ends,
    opens_ends, ///< both
};

struct exhausted_call {
    template <typename Call>
    exhausted_call(std::string n, Call c, call_kind k = call_kind::plain, std::function<void()> b = {})
        : name(std::move(n)), call([c = std::move(c)] { return c(); }), kind(k), before(std::move(b))
    {
    }

    bool opens() const { return kind == call_kind::opens || kind == call_kind::opens_ends; }
    bool ends() const { return kind == call_kind::ends || kind == call_kind::opens_ends; }

    std::string name;
    std::function<void()> call;
    call_kind kind;
    std::function<void()> before; ///< makes what the call needs anew each time, with all memory there is
};

/// Arguments of the calls. Outlives them.
struct call_things {
    folder here = {};
    array a = palm();
    layout l{a};
    stroke s = preset_stroke("park2016-1");
    plan p = make_plan(a, s);
};

using call_table = std::vector<exhausted_call>;

call_table value_calls(const call_things& t);
call_table file_calls(const call_things& t);
call_table plan_calls(const call_things& t);
call_table sound_calls(const call_things& t);
call_table device_calls();

/// A player on a DAC whose clock runs, and one that is made anew where a call needs it.
struct player_things;
std::shared_ptr<player_things> make_player_things();
call_table player_calls(player_things& t);

} // namespace tactor::test
