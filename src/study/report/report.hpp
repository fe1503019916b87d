// SPDX-License-Identifier: MIT
/// \file
/// The methods section of a paper about a study, as Markdown: methods.md, filled in with facts. They come
/// from the study's files other than the answers: the circumstances of each session, and the participants.
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

/// Hint for a file that differs from what a session wrote.
inline constexpr const char* changed_file = "restore it: it was changed";

/// A stimulus that a session lists, with its plans (schema tactor-plan/1, or tactor-plans/1 for several
/// strokes).
struct planned_stimulus {
    std::string motion;
    std::string method;
    std::string hash;
    std::string file;
    nlohmann::ordered_json document;
    std::optional<double> value = {}; ///< value of what its run varies

    /// Returns the plan of each stroke.
    std::vector<json_value> plans() const
    {
        const json_value all{document, file, changed_file};
        return document.contains("plans") ? all["plans"].list() : std::vector{all};
    }
};

/// Number of a session's trials of a run.
struct trial_counts {
    std::size_t valid = 0;
    std::size_t voids = 0;
    std::optional<std::size_t> xruns = 0; ///< void trials with gaps in the sound; none: not recorded
};

struct session_facts {
    std::string participant; ///< code
    std::string code;        ///< the same, or CODE_ses-N
    std::string file;        ///< session.json
    nlohmann::ordered_json document;
    /// The definition with its defaults. Only for sessions that tactor held: other programs may have other
    /// defaults.
    std::optional<experiment_definition> design = {};
    std::string definition_hash; ///< SHA-256 of its text
    std::vector<planned_stimulus> stimuli = {};
    std::vector<std::size_t> answered = {}; ///< number of lines, by questionnaire of the design
    std::vector<trial_counts> counts = {};  ///< by run

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
    std::vector<session_facts> sessions = {}; ///< in the order of participants.tsv, then by number
    std::vector<participant> people = {};     ///< selected participants, also those without a session
};

/// Reads the facts about the participants of `d`, which was read from the same folder.
/// \throws error (bad_input) with the file: a value of another type; a definition or a plan that is missing
///         or no longer has its SHA-256; a trial whose stimulus is not the one with its plan's hash.
study_facts read_facts(const std::filesystem::path& folder, const dataset& d);

/// Returns the whole text. `f` is from the same folder as `d`, and `a` is about it.
std::string methods_text(const study_facts& f, const dataset& d, const analysis& a);

/// Writes the report whole or not at all, with its SHA-256 in the last line. \throws error: bad_input for a
/// folder that does not exist, for a file that was read as input, and without `force` for a file that is not
/// a report of tactor or that somebody has changed; runtime for what the system refuses.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

/// Returns all facts, by their names in methods.md.
nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d, const analysis& a);

/// Returns methods.md, a template of Mustache with [[ and ]].
std::string_view methods_template() noexcept;

/// Returns a name or text from a file on one line, with Markdown's own characters escaped.
std::string escape_markdown(std::string_view text);

/// Returns a template of Mustache with [[ and ]], filled in with facts. Its sections `each` are filled in
/// with the facts of each session. A text that all sessions share appears once, and other texts appear with
/// their sessions. A text that is empty or has only blanks and punctuation becomes "not recorded". Sections
/// `alike` are filled in in the same way, but one below the other, each with its sessions as `who`.
std::string fill_in(const std::string& text, const nlohmann::ordered_json& facts);

/// Returns the days from the start of each session to the start of the participant's next session.
std::string between_text(const study_facts& f);

/// Returns the smallest and the largest value, or the only value; "not recorded" without values.
std::string range_text(const std::vector<double>& values);

/// Returns the options of a method by name, including those that have the plan's defaults: "algorithm
/// park2016, soa 0.07".
std::string method_options(const options::option_values& o);

} // namespace tactor::study
