// SPDX-License-Identifier: MIT
/// \file
/// Adaptive procedures: each answer in a track determines the value of the track's next trial.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "study/data/definition.hpp"
#include "study/statistics/quest.hpp"
#include "study/statistics/up_down.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// A staircase on a list of values.
class value_staircase {
public:
    /// \pre `t` is a staircase. `top`: greatest index of a value.
    value_staircase(const adaptive_track& t, std::vector<std::size_t> steps, std::size_t top)
        : rule_({.in_row = t.down, .sizes = steps.size(), .mirrored = t.mirrored}),
          steps_(std::move(steps)),
          at_(t.start),
          top_(top)
    {
    }

    std::size_t place() const noexcept { return at_; }
    std::size_t reversals() const noexcept { return rule_.reversals(); }
    void answer(bool positive);

private:
    up_down_rule rule_;
    std::vector<std::size_t> steps_;
    std::size_t at_;
    std::size_t top_;
};

/// Reads the procedures of an adaptive run, in which the answers choose values from a grid over `range`.
/// `two_sided`: true if both answers have equal rank. Every second staircase of the same procedure is then
/// mirrored. If `two_sided` is false, answers are right or wrong, and tracks start at the greatest value by
/// default. \throws error (bad_input) with line and column.
void read_procedure(const detail::toml_table& t, run_definition& r, const detail::bounds& b, bool two_sided);

/// Names of the keys that read_procedure() reads. read_vary() reads further keys.
inline constexpr std::array<std::string_view, 9> procedure_keys{
    "procedure", "start", "steps", "range", "tracks", "slope", "lapse", "stop_sd", "reversals"};

/// Returns `keys` followed by procedure_keys.
std::vector<std::string_view> add_procedure_keys(std::vector<std::string_view> keys);

/// Lists the trials of each motion and method at the first value of each track.
std::vector<planned_trial> list_track_cells(const run_definition& r);

/// Function that returns true if an answer is positive.
using is_positive = bool (*)(const run_outline& o, std::string_view method_1, unsigned response);

/// Returns the chooser of an adaptive run.
std::unique_ptr<value_chooser> make_adaptive_chooser(const run_definition& r, is_positive positive);

/// The tracks of an adaptive run, with the answers so far.
class adaptive_tracks {
public:
    explicit adaptive_tracks(const run_outline& r) : run_(r) {}

    /// Returns the index of the value for a track's next trial. `track` counts from 1.
    std::size_t next(unsigned track);
    /// Takes the answer to the trial of next().
    void answer(unsigned track, bool positive);
    /// Returns true if the answers so far have ended a track. \pre the track has an answer.
    bool has_ended(unsigned track) const;
    /// Sets the members of a track that depend on its answers. \pre the track has an answer.
    void describe(played_track& t) const;

private:
    using procedure = std::variant<value_staircase, quest>;
    procedure& find(unsigned track);

    const run_outline& run_;
    std::map<unsigned, procedure> tracks_ = {};
};

/// Returns the number of tracks of all conditions of an adaptive run.
unsigned count_tracks(const run_outline& o);
/// Computes the tracks of a session from its trials, which must be in the order of the table. Returns an
/// empty list if tracks cannot end early, or if the track of a trial is unknown.
std::vector<played_track> replay_tracks(const run_outline& o, const std::vector<trial>& trials);
/// Returns the keys of a definition that end tracks, such as "stop_sd = 2, reversals = 8". Returns an empty
/// text if tracks cannot end early.
std::string format_stop_rule(const adaptive_options& a);

} // namespace tactor::study
