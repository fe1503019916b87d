// SPDX-License-Identifier: MIT
#include "cli/experiment/array_walk.hpp"

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/check/walk.hpp"
#include "study/experiment/definition_words.hpp"

namespace tactor::cli {

score walk_score(const study::experiment_definition& d, const array& a, const render_options& o,
                 unsigned tactor)
{
    const double carrier_hz = d.methods.front().options.carrier_hz;
    try {
        return score(a, walk_one(a, tactor, carrier_hz).plans.front().schedule, o);
    } catch (const error& e) {
        throw e.reworded(e.subject(), fmt::format("in the walk before the runs: {}", e.why()),
                         study::in_definition_words(e.hint()));
    }
}

void check_walk(const study::experiment_definition& d, const array& a, const render_options& o)
{
    for (unsigned i = 0; i < a.tactors.size(); ++i)
        static_cast<void>(walk_score(d, a, o, i));
}

} // namespace tactor::cli
