// SPDX-License-Identifier: MIT
/// \file
/// The definition of an experiment, see tactor-experiment(5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "options/option.hpp"
#include "study/data/drawing.hpp"
#include "study/data/outline.hpp"
#include "study/data/page_words.hpp"
#include "study/data/questionnaire.hpp"
#include "study/masking/masking.hpp"

namespace tactor::study {

/// [masking]: noise from loudspeakers or headphones, so that nobody hears the array.
struct masking_definition {
    std::optional<masking_options> noise = {};
    bool through_run = false; ///< true if the noise plays during the whole run (while = "run")
};

/// [[motion]]: the motion of a target.
struct motion_definition {
    std::string name;
    std::vector<stroke> strokes; ///< at least one; the earliest starts at 0
    bool mirror = false;         ///< true to exchange left and right for left hands
    source_place where = {};
};

/// A key in the definition's spelling.
struct written_key {
    std::string key; ///< name, with or without its unit
    source_place where;
};

/// [[method]]: options for planning and rendering a motion.
struct method_definition {
    std::string name;
    options::option_values options = {}; ///< the method's options, and defaults for the others
    std::vector<stroke> strokes = {};    ///< strokes that replace the strokes of the motion; may be empty
    source_place where = {};             ///< place of the method; for a variant, place of the run's values
    std::map<std::size_t, written_key> keys = {}; ///< keys of the method's table, by option index
    std::optional<std::size_t> made_of = {}; ///< base method of a variant; missing for a method in the file
    std::optional<double> value = {};        ///< value of the varied option or parameter, if any
    std::string vary = {}; ///< stroke parameter that has the value; empty if an option has it
    bool silent = false;   ///< true to play silence of the same duration

    bool is_variant() const noexcept { return made_of.has_value(); }
    /// Returns true if the method has a level (in options.render) that replaces the experiment's level.
    bool has_level() const { return options.gives("level_dbfs") || options.gives("sl"); }
};

/// Variants that a run plays in place of one of its methods, as indices into the definition's methods.
struct method_variants {
    std::vector<std::size_t> values = {}; ///< one per value; empty if the run plays the method itself
    std::optional<std::size_t> standard = {};
    std::optional<std::size_t> silent = {}; ///< variant for trials without a stimulus
    /// Silent variants for intervals without a stimulus: one per value, as long as that value's variant. May
    /// be empty.
    std::vector<std::size_t> silences = {};
};

/// Settings of a run in which participants adjust the value. Values are indices into the run's values.
struct adjustment_options {
    std::size_t coarse = 0;              ///< size of a large move; a small move goes to the next value
    std::vector<std::size_t> start = {}; ///< start values; if empty, drawn from both sides of the standard
};

/// [[run]]. Motions and methods are indices into the definition's lists.
struct run_definition {
    run_outline outline;
    std::string attribute = {};   ///< attribute that the question asks about; may be empty
    std::string simulate_as = {}; ///< similarity or uniformity; empty if no simulated observer can answer
    bool animation = false;
    unsigned practice = 0;                 ///< number of practice trials, which come first
    bool trains = false;                   ///< true if practice trials show whether the answer was right
    bool feedback = false;                 ///< true if all trials show whether the answer was right
    double break_s = 0.0;                  ///< length of the break after the run
    double min_response_s = 0.15;          ///< shortest response time that is not marked early
    std::vector<std::string> choices = {}; ///< labels of the two answers; may be empty
    std::vector<std::size_t> motions = {};
    std::vector<std::size_t> methods = {};
    std::map<std::size_t, method_variants> variants = {}; ///< variants by index of the method
    double catch_share = 0.0; ///< share of trials without a stimulus (task detect)
    std::size_t stimuli = 1;  ///< number of stimuli of a trial
    adjustment_options adjusting = {};
    unsigned max_in_a_row = 3; ///< greatest number of trials of one motion in a row
    std::string blocks = {};   ///< "methods" or "motions" to have one block for each; empty to mix all trials
    source_place where = {};
};

/// Pause before a trial. If the bounds differ, each trial has a random pause.
struct rest_range {
    double least_s = 0.0;
    double most_s = 0.0;

    bool is_random() const noexcept { return most_s > least_s; }
};

struct experiment_definition {
    std::string title;
    std::optional<std::string> array = {};  ///< name of a preset, or a file
    std::optional<double> level_dbfs = {};  ///< level in dBFS; if missing, sl_db applies
    double sl_db = 7.0;                     ///< level above each tactor's threshold
    double gap_s = 1.0;                     ///< time between the two stimuli of a trial
    rest_range rest = {};                   ///< pause before each trial
    std::string order = "williams";         ///< order of runs and of blocks: williams, latin or random
    std::optional<std::uint64_t> seed = {}; ///< if missing, default_seed(code) applies
    std::string consent = {};
    std::vector<std::string> authors = {};
    masking_definition masking = {};
    page_words page = {};
    std::vector<motion_definition> motions = {};
    std::vector<method_definition> methods = {};
    std::vector<run_definition> runs = {};
    std::map<std::string, std::string> group_arrays = {}; ///< arrays of the groups that have their own array
    std::string group = {};          ///< group to which `runs` apply; empty if they apply to everybody
    session_number session = {};     ///< number of the present session
    experiment_outline outline = {}; ///< outline of all runs and groups
    std::string text = {};           ///< text of the whole definition, TOML
};

/// Start and end of a stroke, in seconds from the start of the motion.
struct stroke_span {
    double start_s = 0.0;
    double end_s = 0.0;
};

/// Returns the start and end of each stroke. \throws error (bad_input) if a start is below 0.
std::vector<stroke_span> list_spans(const std::vector<stroke>& strokes);

/// Returns the end of the stroke that ends last, s.
double find_duration_s(const std::vector<stroke>& strokes);

/// Number of equal time steps into which strokes are divided for comparison.
inline constexpr std::size_t path_parts = 100;

/// Samples the position of each stroke at path_parts + 1 equally spaced times.
std::vector<std::vector<point>> sample_strokes(const std::vector<stroke>& strokes);

/// Joins the paths of strokes one after the other, without pauses. `paths`: the result of sample_strokes().
/// Keeps every second point, or fewer if a drawing cannot hold them all.
drawing join_paths(const std::vector<std::vector<point>>& paths, const std::vector<stroke>& strokes);

/// A trial before it is played. Motion and methods are indices into the definition's lists.
struct planned_trial {
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::optional<std::size_t> method_2 = {}; ///< missing if the trial has one stimulus
    std::optional<std::size_t> method_3 = {}; ///< missing if the trial has fewer than three stimuli
    double rest_s = 0.0;                      ///< pause before the trial
    unsigned track = 0;                       ///< number of the track in an adaptive run, from 1; otherwise 0

    /// Lists the methods of the stimuli, in the order in which they play.
    std::vector<std::size_t> list_methods() const;

    friend bool operator==(const planned_trial&, const planned_trial&) = default;
};

/// Sets the value of a trial in an adaptive run. `place`: index into the run's values.
void set_value(planned_trial& t, const run_definition& r, std::size_t place);

/// Returns the place, from 1, of the stimulus that differs from the other two stimuli. Returns nothing if the
/// trial has fewer than three stimuli.
std::optional<unsigned> find_odd_stimulus(const planned_trial& t);

/// Returns the value of a trial's comparison stimulus, or nothing if the run does not vary a value or the
/// trial has no stimulus.
std::optional<double> find_value(const experiment_definition& d, const planned_trial& t);

} // namespace tactor::study
