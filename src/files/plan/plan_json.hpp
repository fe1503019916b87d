// SPDX-License-Identifier: MIT
/// \file
/// Plans as JSON (schemas tactor-plan/1 and tactor-plans/1): a record from which every sample can be
/// reproduced. These files can also be read.
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

/// Strokes and their plans.
struct piece {
    std::string name = {};
    std::vector<stroke> strokes = {};
    std::vector<placed_plan> plans = {}; ///< one plan for each stroke; empty before planning
    std::optional<fitting> fit = {};     ///< fit of all strokes as a whole, if any
    bool had_own_fit = false;            ///< a stroke was fitted because its file says so
    /// Results of compensation without their plans. Empty, or one result for each stroke.
    std::vector<compensated_plan> moved = {};
    std::filesystem::path samples = {}; ///< WAV file whose samples play instead of strokes; empty if none

    /// Returns the start of each plan, then the end of the last plan, s from the start of the piece.
    std::vector<double> starts_s() const { return start_times_s(plans); }
    double total_s() const;
};

/// Planned strokes, and all data on which their samples depend. The referenced objects must outlive this
/// object.
struct plan_record {
    const piece& made;
    const array& tactors;
    const score& samples;          ///< score of all plans, made with `options`
    const render_options& options; ///< options with the rate and the channels
};

/// Returns the keys that describe the place of an array on the body: site, up, place, turn and body. Keys
/// that the array does not have are left out.
nlohmann::ordered_json describe_site(const array& a);

/// Writes an object for each plan. Writes row by row, so that even a plan of an hour needs no document in
/// memory.
void write_plans(const plan_record& r, const text_sink& out);

/// Returns the text that write_plans() writes.
std::string plans_text(const plan_record& r);

/// Writes a text from plans_text() to a file, completely or not at all. The format has no place for a note of
/// its hash. Therefore a file with other bytes is replaced only with `force`. Blocks on the file system.
/// \throws error as detail::output_file does; error (bad_input) if a file with other bytes exists.
void save_plans(const std::string& text, const std::filesystem::path& file, bool force,
                detail::owner_kind writer = detail::owner_kind::user);

/// Returns the JSON Schema of a plan.
nlohmann::ordered_json plan_schema();

/// Returns the meaning of a stroke's note for people, or "" if there is no note.
std::string note_text(note_kind n);

/// Calls row(burst) for each burst of a plan. For the algorithm `continuous`, calls it for each point at
/// which the phantom is evaluated. Such a point lasts until the next point.
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

/// Treatment of a WAV file that is a plan's waveform.
enum class recordings_kind { read, refuse };

/// Contents of a file with one plan or several (schemas tactor-plan/1 and tactor-plans/1).
struct plan_file {
    piece made; ///< strokes as plans describe them: places of bursts or samples
    array tactors;
    render_options render; ///< options with rate, channels and marker
};

/// Returns true if a STROKE argument is the name of a plan file.
inline bool is_plan_file(std::string_view argument) noexcept
{
    return argument.ends_with(".json");
}

/// Reads plans from a file, one burst at a time, so that the text is never in memory as a whole. Blocks on
/// the file system.
/// \throws error (bad_input) with the line and column, or with the field.
plan_file load_plans(const std::string& file);
/// Reads plans from a text in memory. `name` is its name in messages. Use recordings_kind::refuse for a text
/// from another machine, because the recordings that it names would be files of this machine.
plan_file read_plans(std::string_view text, const std::string& name,
                     recordings_kind recordings = recordings_kind::read);

/// Returns true if a text can only contain plans: it is JSON, and not in any format of strokes.
bool holds_plans(std::string_view text);

/// Checks that a plan fits the array in use.
/// \throws error (bad_input) if the arrays differ in places, channels or polarities.
void check_same_array(const std::string& file, const array& made_for, const array& in_use);

/// Returns the numbers of a prediction as JSON, or the reason why there is no prediction.
nlohmann::ordered_json errors_json(const detail::prediction& r, observer_kind by);

/// Returns JSON with a line end: an object for one comparison, or an object with a list for several.
std::string comparisons_text(const std::vector<detail::comparison>& all, const array& a);
/// Returns the JSON Schema of comparisons.
nlohmann::ordered_json comparison_schema();

} // namespace tactor::files
