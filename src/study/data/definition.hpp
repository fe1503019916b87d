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
    bool through_run = false; ///< noise lasts through the run (while = "run")
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
    options::option_values options = {};          ///< the method's options, and defaults for the others
    std::vector<stroke> strokes = {};             ///< strokes that replace the motion's; may be empty
    source_place where = {};                      ///< place of the method; for a variant, of the run's values
    std::map<std::size_t, written_key> keys = {}; ///< keys of the method's table, by option index
    std::optional<std::size_t> made_of = {}; ///< base method of a variant; missing for a method in the file
    std::optional<double> value = {};        ///< value, if the run varies one
    std::string vary = {};                   ///< stroke parameter with the value; empty if an option has it
    bool silent = false;                     ///< true for silence of the same duration

    bool is_variant() const noexcept { return made_of.has_value(); }
    /// Returns true if the method's level, in options.render, replaces the experiment's.
    bool has_level() const { return options.gives("level_dbfs") || options.gives("sl"); }
};

/// Variants that a run plays in place of one of its methods, as indices into the definition's methods.
struct method_variants {
    std::vector<std::size_t> values = {}; ///< one per value; empty if the run plays the method itself
    std::optional<std::size_t> standard = {};
    std::optional<std::size_t> silent = {}; ///< variant for trials without a stimulus
    /// For intervals without a stimulus: silence as long as the variant of each value; may be empty.
    std::vector<std::size_t> silences = {};
};

/// Moves of a run whose participants adjust the value, as indices into the run's values.
struct adjustment_options {
    std::size_t coarse = 0;              ///< size of a large move; a small one goes to the next value
    std::vector<std::size_t> start = {}; ///< first values; empty: drawn from both sides of the standard
};

/// [[run]]. Motions and methods are indices into the definition's lists.
struct run_definition {
    run_outline outline;
    std::string attribute = {};   ///< attribute that the question asks about; may be empty
    std::string simulate_as = {}; ///< similarity or uniformity; empty if no simulated observer can judge it
    bool animation = false;
    unsigned practice = 0;                 ///< number of practice trials, which come first
    bool trains = false;                   ///< true if people are told in practice whether they were right
    bool feedback = false;                 ///< true if they are told in all trials
    double break_s = 0.0;                  ///< length of the break after the run
    double min_response_s = 0.15;          ///< shortest response time that is not marked early
    std::vector<std::string> choices = {}; ///< words of both answers, or the page's usual ones; may be empty
    std::vector<std::size_t> motions = {};
    std::vector<std::size_t> methods = {};
    std::map<std::size_t, method_variants> variants = {}; ///< variants by index of the method
    double catch_share = 0.0;                             ///< detect: share of trials without a stimulus
    std::size_t stimuli = 1;                              ///< number of stimuli of a trial
    adjustment_options adjusting = {};
    unsigned max_in_a_row = 3; ///< greatest number of trials of one motion in a row
    std::string blocks = {};   ///< "methods" or "motions": one block for each; empty if all trials are mixed
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
    std::map<std::string, std::string> group_arrays = {}; ///< arrays of groups that have their own
    std::string group = {};          ///< group that has these `runs`; empty if everybody has them
    session_number session = {};     ///< number of the present session
    experiment_outline outline = {}; ///< outline of all runs and groups
    std::string text = {};           ///< text of the whole definition, TOML
};

/// Start and end of a stroke, s from the start of its motion.
struct stroke_span {
    double start_s = 0.0;
    double end_s = 0.0;
};

/// Returns the start and end of each stroke. \throws error (bad_input) if one would start below 0.
std::vector<stroke_span> list_spans(const std::vector<stroke>& strokes);

/// Returns the end of the stroke that ends last, s.
double find_duration_s(const std::vector<stroke>& strokes);

/// Number of equal parts of time into which movements are divided for comparison.
inline constexpr std::size_t path_parts = 100;

/// Returns the positions of each stroke at path_parts equal parts of its time.
std::vector<std::vector<point>> sample_strokes(const std::vector<stroke>& strokes);

/// Joins the paths of strokes, each at path_parts equal parts of the stroke's time, one after the other
/// without pauses. Keeps every second point, and fewer if a drawing has no room for them.
drawing join_paths(const std::vector<std::vector<point>>& paths, const std::vector<stroke>& strokes);

/// A trial before it is played. Motion and methods are indices into the definition's lists.
struct planned_trial {
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::optional<std::size_t> method_2 = {}; ///< missing if the trial has one stimulus
    std::optional<std::size_t> method_3 = {}; ///< missing if the trial has fewer than three
    double rest_s = 0.0;                      ///< pause before the trial
    unsigned track = 0;                       ///< track of an adaptive run, from 1; see set_value()

    /// Lists the methods of the stimuli, in the order in which they play.
    std::vector<std::size_t> list_methods() const;

    friend bool operator==(const planned_trial&, const planned_trial&) = default;
};

/// Sets the value of a trial in an adaptive run. `place`: index into the run's values.
void set_value(planned_trial& t, const run_definition& r, std::size_t place);

/// Returns the place, from 1, of the stimulus that differs from the two others; nothing unless a trial has
/// three.
std::optional<unsigned> find_odd(const planned_trial& t);

/// Returns the value of a trial's comparison; nothing if the run varies nothing or the trial has no stimulus.
std::optional<double> find_value(const experiment_definition& d, const planned_trial& t);

} // namespace tactor::study
