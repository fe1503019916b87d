// SPDX-License-Identifier: MIT
/// \file
/// Plans as JSON (schemas tactor-plan/1 and tactor-plans/1), a record of every sample, and plans read back.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <tactor/array.hpp>
#include <tactor/tactor.hpp>

#include "files/json/writer.hpp"
#include "files/text_file.hpp"
#include "percept/compare.hpp"

namespace tactor::files {

/// Strokes, and the plans that were made from them.
struct piece {
    std::string name = {};
    std::vector<stroke> strokes = {};
    std::vector<placed_plan> plans = {}; ///< one for each stroke; empty before planning
    std::optional<fitting> fit = {};     ///< fitting of all strokes together
    /// Results of compensation without their plans: empty, or one for each stroke.
    std::vector<compensated_plan> moved = {};
    std::filesystem::path samples = {}; ///< WAV file with samples in place of strokes; empty: none

    /// Returns the start of each plan and the end of the last, s from the start of all.
    std::vector<double> starts_s() const { return start_times_s(plans); }
    double total_s() const;
};

/// Planned strokes, and everything that their samples depend on. It refers to objects that must outlive it.
struct plan_record {
    const piece& made;
    const array& tactors;
    const score& samples;          ///< score of all plans, made with `options`
    const render_options& options; ///< with rate and channels
};

/// Returns the keys that place an array on the body: site, up, place, turn and body, each if the array has
/// it.
nlohmann::ordered_json describe_site(const array& a);

/// Writes an object for each plan, row by row, so that a plan of an hour needs no document in memory.
void write_plans(const plan_record& r, const text_sink& out);

/// Returns what write_plans() writes.
std::string plans_text(const plan_record& r);

/// Writes a file of such a text, whole or not at all. Its bytes are its identity: it has no place for a mark,
/// so without `force` no file with other bytes is replaced. Blocks on the file system.
/// \throws error as detail::output_file; bad_input for such a file.
void save_plans(const std::string& text, const std::filesystem::path& file, bool force,
                detail::owner_kind writer = detail::owner_kind::user);

/// Returns the schema of such an object.
nlohmann::ordered_json plan_schema();

/// Returns the meaning of a stroke's note, for people; empty for none.
std::string note_text(note_kind n);

/// Calls row(burst) for each burst. For `continuous`, calls it for each point at which the phantom is
/// evaluated; a point lasts until the next.
template <class Row>
void for_each_row(const plan& p, Row&& row)
{
    for (const burst& b : p.bursts)
        row(b);
    burst b;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); ++k) {
        p.curve->sample(k, b);
        b.duration_s = std::min(continuous_step_s, p.stroke_duration_s - b.onset_s);
        row(b);
    }
}

/// Treatment of a WAV file that a plan names as its waveform.
enum class recordings_kind { read, refuse };

/// Contents of a file with one plan or several (schemas tactor-plan/1 and tactor-plans/1).
struct plan_file {
    piece made; ///< strokes as far as plans describe them: places of bursts or samples
    array tactors;
    render_options render; ///< with rate, channels and marker
};

/// Returns true if a STROKE argument names such a file.
inline bool is_plan_file(std::string_view argument) noexcept
{
    return argument.ends_with(".json");
}

/// Reads plans burst by burst, so that the whole text is never in memory. Blocks on the file system.
/// \throws error (bad_input) with the line and column, or the field.
plan_file load_plans(const std::string& file);
/// Reads a text in memory; `name` stands for it in messages. A text from another machine must not name
/// recordings, which are files of this one.
plan_file read_plans(std::string_view text, const std::string& name,
                     recordings_kind recordings = recordings_kind::read);

/// Returns true if a text can only be plans: JSON that is no format of strokes.
bool holds_plans(std::string_view text);

/// Compares arrays.
/// \throws error (bad_input) if places, channels or polarities differ.
void check_same_array(const std::string& file, const array& made_for, const array& in_use);

/// Returns the numbers of a prediction, or the reason why there are none.
nlohmann::ordered_json errors_json(const detail::prediction& r, observer_kind by);

/// Returns a comparison as an object, several as a list in an object, with a line end.
std::string comparisons_text(const std::vector<detail::comparison>& all, const array& a);
/// Returns the schema of such an object.
nlohmann::ordered_json compare_schema();

} // namespace tactor::files
