// SPDX-License-Identifier: MIT
/// \file
/// The definition of an experiment: tactor-experiment(5) as values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "options/option.hpp"
#include "study/data/dataset.hpp"
#include "study/experiment/page_words.hpp"
#include "study/experiment/questionnaire.hpp"
#include "study/masking/masking.hpp"

namespace tactor::study {

/// [masking]: noise from loudspeakers or headphones, so that nobody hears the array.
struct masking_definition {
    std::optional<masking_options> noise = {};
    bool through_run = false; ///< while = "run": not only around each stimulus
};

/// [[motion]]: a target.
struct motion_definition {
    std::string name;
    stroke drawn;
    bool mirror = false; ///< left and right are exchanged for left hands
    source_place where = {};
};

/// A key as the definition writes it.
struct written_key {
    std::string key; ///< with its unit or without
    source_place where;
};

/// [[method]]: how a motion is planned, and how it sounds.
struct method_definition {
    std::string name;
    options::option_values options = {};          ///< options that it gives, and defaults
    std::optional<stroke> drawn = {};             ///< stroke in place of the motion's
    source_place where = {};                      ///< of a variant with a value: that of the run's values
    std::map<std::size_t, written_key> keys = {}; ///< options that its table gives, by row
    std::optional<std::size_t> made_of =
        {};                           ///< method of which a run made it: variation.hpp; none: it stands there
    std::optional<double> value = {}; ///< of a run that varies one
    std::string vary = {};            ///< stroke parameter that has it; empty: an option has
    bool silent = false;              ///< nothing is played, for as long

    bool is_variant() const noexcept { return made_of.has_value(); }
    /// Returns true if its level, in options.render, replaces the experiment's.
    bool has_level() const { return options.gives("level_dbfs") || options.gives("sl"); }
};

/// Methods that a run plays in place of one of its own, as places in those of the definition.
struct method_variants {
    std::vector<std::size_t> values = {}; ///< by value; empty: the method as it is
    std::optional<std::size_t> standard = {};
    std::optional<std::size_t> silent = {}; ///< of trials without a stimulus
};

/// Procedure of an adaptive run. Values are places in those of the run.
struct adaptive_options {
    unsigned down = 0;   ///< positive answers in a row after which a staircase goes down; 0: QUEST+
    unsigned tracks = 1; ///< the staircase of every second one is mirrored
    std::vector<std::size_t> start = {}; ///< by track
    std::vector<std::size_t> steps = {}; ///< of a staircase; the next from every second reversal on
    std::vector<double> slopes = {};     ///< of QUEST+: standard deviations of the normal
    std::vector<double> lapses = {};
};

/// [[run]]. Motions and methods are places in those of the definition.
struct run_definition {
    run_outline outline;
    std::string attribute = {};   ///< what is asked about, in any words; may be empty for identify
    std::string simulate_as = {}; ///< similarity, uniformity; empty: nothing that an observer can judge
    bool animation = false;
    unsigned practice = 0;                 ///< trials before that do not count
    double break_s = 0.0;                  ///< after the run
    double min_response_s = 0.15;          ///< an earlier answer is marked early
    std::vector<std::string> choices = {}; ///< the outline's, or the usual ones of the page; may be empty
    std::vector<std::size_t> motions = {};
    std::vector<std::size_t> methods = {};
    std::map<std::size_t, method_variants> variants = {}; ///< by method
    double catch_share = 0.0;                             ///< detect: share of trials without a stimulus
    bool pairs = false;                                   ///< a trial has two stimuli
    adaptive_options adaptive = {};
    unsigned max_in_a_row = 3; ///< trials of one motion, where a block has several
    std::string blocks = {}; ///< methods or motions: the trials of each stand together; empty: all are mixed
    source_place where = {};
};

/// Pause before a trial. Drawn for each trial if its bounds differ.
struct rest_range {
    double least_s = 0.0;
    double most_s = 0.0;

    bool is_random() const noexcept { return most_s > least_s; }
};

struct experiment_definition {
    std::string title;
    std::optional<std::string> array = {};  ///< a preset's name, or a file
    std::optional<double> level_dbfs = {};  ///< none: sl_db
    double sl_db = 7.0;                     ///< above each tactor's threshold
    double gap_s = 1.0;                     ///< choose: from the first stimulus' end to the second's begin
    rest_range rest = {};                   ///< before each trial
    std::string order = "williams";         ///< or latin, random: of the runs, and of the blocks in a run
    std::optional<std::uint64_t> seed = {}; ///< none: default_seed(code)
    std::string consent = {};
    std::vector<std::string> authors = {};
    masking_definition masking = {};
    page_words page = {};
    std::vector<motion_definition> motions = {};
    std::vector<method_definition> methods = {};
    std::vector<run_definition> runs = {};
    std::map<std::string, std::string> group_arrays = {}; ///< by group, of those that have their own
    std::string group = {};          ///< group whose runs `runs` are; empty: those of everybody
    session_number session = {};     ///< session that is held
    experiment_outline outline = {}; ///< of all runs and groups
    std::string text = {};           ///< all of it, TOML
};

/// Reads a definition. `name` stands for the text in messages, and names of files in it are relative to
/// `folder`.
/// \throws error (bad_input) with line and column: no TOML, keys that are missing, not known, of another type
///         or out of range, names that are there twice or not known, a motion that cannot be read.
experiment_definition read_definition(std::string_view toml, const std::string& name,
                                      const std::filesystem::path& folder);

/// Reads the text that a session keeps: without the array, and with the names of the motions only, because
/// their files may be elsewhere by now. \throws error (bad_input).
experiment_definition read_design(std::string_view toml, const std::string& name);

/// Reads only what the analysis needs, with the same bounds; passes over all else, which other programs may
/// write differently. \throws error (bad_input).
experiment_outline read_outline(std::string_view toml, const std::string& name);

/// Returns true if a level, the experiment's or a method's, is above the thresholds.
bool uses_thresholds(const experiment_definition& d);

/// Name of the definition that is built in.
inline constexpr const char* shipped_experiment = "park2016";
/// Returns its text, as it stands among the examples.
std::string_view park2016_text() noexcept;

/// Loads the definition that is built in, or a file. \throws error (bad_input).
experiment_definition load_definition(const std::string& name_or_file);

/// Returns a hint of the library with a definition's keys in place of fields, without options that a
/// definition cannot set. `own_level`: the level is the method's.
std::string spell_for_definition(std::string_view hint, bool own_level = false);

} // namespace tactor::study
