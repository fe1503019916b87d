// SPDX-License-Identifier: MIT
/// \file
/// An experiment on an array, for a participant: all that can be settled and checked before anybody sits
/// down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/render.hpp>

#include "session/environment.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/sequence.hpp"
#include "study/experiment/stimuli.hpp"

namespace tactor::study {

/// Who feels what a session plays.
enum class audience {
    person,
    observer, ///< a simulated one
    nobody,   ///< a dry run
};

/// A session that is asked for.
struct session_request {
    std::string definition;                 ///< a name that is built in, or a file
    std::string participant = {};           ///< empty only of a dry run
    std::optional<std::uint64_t> seed = {}; ///< else that of the definition, else one of the participant's
    audience who = audience::person;
};

/// Between the program and its cards; empty: none.
struct sound_servers {
    std::string array = {};
    std::string masker = {};
};

struct prepared_experiment {
    experiment_definition definition;
    std::string participant;
    std::uint64_t seed = 0;
    session::environment where; ///< its array has thresholds where the level is a sensation level
    std::string pcm;            ///< "null" where nothing names one
    render_options render;
    bool assumed = false; ///< thresholds that nobody measured
    std::vector<run_sequence> runs;
    stimulus_set stimuli;
    std::vector<std::string> warnings;
    std::vector<std::string> calibration_doubts; ///< of the warnings, those about the thresholds' origin
};

/// The threshold that is taken where nobody measured one, and nobody feels anything.
inline constexpr double assumed_threshold_dbfs = -40.0;

/// Settles a session. \throws error (bad_input): the definition, array or configuration is wrong, a stimulus
/// cannot be planned
///         or played; there are no thresholds and somebody is to feel it.
prepared_experiment prepare(const session_request& r, session::settings& s);

/// A tactor by itself, at the carrier of the definition's first method. \throws error (bad_input) where its
/// level is too high, in the definition's words.
score walk_score(const experiment_definition& d, const array& a, const render_options& o, unsigned tactor);

/// Tries all of them. Throws as above.
void check_walk(const experiment_definition& d, const array& a, const render_options& o);

/// Each trial that there is, practice too, must sound as planned on an array that has rested.
/// \throws error (bad_input) with the motion's line for one that a limit would change: it would be void
///         whenever it comes.
void check_limits(const experiment_definition& d, const std::vector<run_sequence>& runs,
                  const stimulus_set& stimuli, const drive_limits& l);

/// Time from what was shown before to the first frame of a stimulus, so that nobody is surprised, s.
inline constexpr double stimulus_lead_s = 0.5;

struct run_time {
    double total_s = 0.0;  ///< practice included, the break after the run not
    double waits_s = 0.0;  ///< of total_s: waiting until no tactor would be driven for too long
    std::size_t waits = 0; ///< trials that wait
};

/// Returns the time of each run in the session's order. Each answer takes `answer_s`, the device adds no
/// latency, and the array has rested before.
std::vector<run_time> session_times(const prepared_experiment& p, double answer_s);

} // namespace tactor::study
