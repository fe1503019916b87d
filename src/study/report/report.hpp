// SPDX-License-Identifier: MIT
/// \file
/// The methods section of a paper about a study, as Markdown: the template methods.md, filled in with facts.
/// read_facts() reads the facts about sessions and participants; the results come from the analysis.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/json/json_value.hpp"
#include "options/option.hpp"
#include "study/bids/dataset.hpp"
#include "study/data/definition.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

using files::json_value;

/// Hint for a file that was changed after a session wrote it.
inline constexpr const char* changed_file = "restore the original file";

/// A stimulus that a session lists, with its plans (schema tactor-plan/1, or tactor-plans/1 for several
/// strokes).
struct planned_stimulus {
    std::string motion;
    std::string method;
    std::string hash;
    std::string file;
    nlohmann::ordered_json document;
    std::optional<double> value = {}; ///< value of the option or parameter that the run varies

    /// Returns the plan of each stroke.
    std::vector<json_value> list_plans() const
    {
        const json_value all{document, file, changed_file};
        return document.contains("plans") ? all["plans"].list() : std::vector{all};
    }
};

/// Numbers of trials of one run in one session.
struct trial_counts {
    std::size_t valid = 0;
    std::size_t voids = 0;
    std::optional<std::size_t> xruns = 0; ///< void trials with gaps in the sound; missing if not recorded
};

struct session_facts {
    std::string participant; ///< code
    std::string code;        ///< code of the participant, or CODE_ses-N
    std::string file;        ///< path of session.json
    nlohmann::ordered_json document;
    /// Definition with its defaults. Missing if another program wrote the session, because other programs may
    /// have other defaults.
    std::optional<experiment_definition> design = {};
    std::string definition_hash; ///< SHA-256 of the definition's text
    std::vector<planned_stimulus> stimuli = {};
    std::vector<std::size_t> answered = {}; ///< number of lines for each questionnaire in `design`
    std::vector<trial_counts> counts = {};  ///< numbers of trials, by run

    json_value facts() const { return {document, file, changed_file}; }
};

/// A line of participants.tsv.
struct participant {
    std::string code;
    std::optional<std::string> age = {};
    std::optional<std::string> sex = {};
    std::optional<std::string> handedness = {};
};

struct study_facts {
    std::vector<session_facts> sessions = {}; ///< in the order of participants.tsv, then by session number
    std::vector<participant> people = {};     ///< selected participants, also those without a session
};

/// Reads the facts about the participants of `d`, which was read from the same folder.
/// \throws error (bad_input) with the file if a value has the wrong type, a definition or a plan is missing
///         or no longer has its SHA-256, or a trial has a plan that is not the plan of its stimulus.
study_facts read_facts(const std::filesystem::path& folder, const dataset& d);

/// Returns the text of the report. `f` must be from the same folder as `d`, and `a` the analysis of `d`.
std::string methods_text(const study_facts& f, const dataset& d, const analysis& a);

/// Writes the report completely or not at all. The last line has the SHA-256 of the text. \throws error:
/// bad_input if the folder does not exist, if the file was read as input, or (without `force`) if the
/// existing file is not a report of tactor or was changed; runtime for other errors of the system.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

/// Returns all facts, by their names in methods.md.
nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d, const analysis& a);

/// Returns methods.md, a Mustache template with the delimiters [[ and ]].
std::string_view methods_template() noexcept;

/// Returns a text on one line, with the special characters of Markdown escaped.
std::string escape_markdown(std::string_view text);

/// Fills in a Mustache template with the delimiters [[ and ]]. Renders a section `each` with the facts of
/// each session. A text that all sessions share appears once; other texts appear with the names of the
/// sessions. A text that is empty or has only blanks and punctuation becomes "not recorded". Renders a
/// section `alike` in the same way, but puts the texts one below the other; `who` has the names of a text's
/// sessions.
std::string fill_in(const std::string& text, const nlohmann::ordered_json& facts);

/// Returns the range of the days from one session of a participant to the next session.
std::string session_gap_text(const study_facts& f);

/// Returns "SMALLEST to LARGEST", a single number if all values are the same, or "not recorded" if there are
/// no values.
std::string range_text(const std::vector<double>& values);

/// Returns the options of a method with their values, such as "algorithm park2016, soa 0.07". Includes
/// default values.
std::string method_options(const options::option_values& o);

} // namespace tactor::study
