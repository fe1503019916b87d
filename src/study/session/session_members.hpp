// SPDX-License-Identifier: MIT
/// \file
/// Facts that both session.json and tactor-experiment/1 contain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/render.hpp>

#include "core/members.hpp"
#include "study/data/definition.hpp"
#include "study/session/experiment_session.hpp"

namespace tactor::study {

/// Level of stimuli. Exactly one of the two members has a value.
struct listed_level {
    std::optional<double> sl_db = {};
    std::optional<double> dbfs = {};
};

/// Noise that hides the sound of the array.
struct listed_noise {
    std::string color = {};
    double level_dbfs = 0.0;
    double fade_s = 0.0;
    std::string duration = {}; ///< "run" or "stimulus"
};

/// A stimulus with the SHA-256 of its plans.
struct listed_stimulus {
    std::string sha256 = {};
    std::string motion = {};
    std::string method = {};
    double weakened_db = 0.0;
    std::optional<double> value = {};
    std::optional<listed_level> level = {};
};

/// Returns the level in render options.
listed_level list_level(const render_options& o);

/// Returns the noise of a definition, if any.
std::optional<listed_noise> list_noise(const masking_definition& m);

/// Returns all stimuli of a session.
std::vector<listed_stimulus> list_stimuli(const prepared_experiment& p);

template <class Io, detail::either<listed_level> Level>
void members(Io& io, Level& v)
{
    constexpr detail::about one{"dB above each threshold, or the carrier's peak; the other is null"};
    io.describe_or_null("sl_db", v.sl_db, one);
    io.describe_or_null("dbfs", v.dbfs, {one.text, detail::up_to_0});
}

template <class Io, detail::either<listed_noise> Noise>
void members(Io& io, Noise& v)
{
    io.one_of("noise", v.color, {"white", "pink"}, {"white or pink"});
    io("level_dbfs", v.level_dbfs, {"root mean square, dBFS", detail::up_to_0});
    io("fade_s", v.fade_s, {"duration of each fade", detail::from_0});
    io.one_of("while", v.duration, {"stimulus", "run"}, {"stimulus or run"});
}

template <class Io, detail::either<listed_stimulus> Stimulus>
void members(Io& io, Stimulus& v)
{
    constexpr detail::about names{"SHA-256 of its plans, and its motion and method"};
    io("sha256", v.sha256, names);
    io("motion", v.motion, names);
    io("method", v.method, names);
    io("weakened_db", v.weakened_db,
       {"how much it is weakened so that no tactor exceeds its level, 0 or below", detail::up_to_0});
    io("value", v.value, {"its value; only for a run that varies one"});
    io("level", v.level, {"its level; only for a method with its own"});
}

} // namespace tactor::study
