// SPDX-License-Identifier: MIT
#include "study/session/array_walk.hpp"

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "session/walk.hpp"
#include "study/experiment/definition_words.hpp"

namespace tactor::study {

score walk_score(const experiment_definition& d, const array& a, const render_options& o, unsigned tactor)
{
    const double carrier_hz = d.methods.front().options.carrier_hz;
    try {
        return score(a, session::walk_plan(a, tactor, carrier_hz), o);
    } catch (const error& e) {
        throw e.reworded(e.subject(), fmt::format("in the walk before the runs: {}", e.why()),
                         in_definition_words(e.hint()));
    }
}

void check_walk(const experiment_definition& d, const array& a, const render_options& o)
{
    for (unsigned i = 0; i < a.tactors.size(); ++i)
        static_cast<void>(walk_score(d, a, o, i));
}

} // namespace tactor::study
