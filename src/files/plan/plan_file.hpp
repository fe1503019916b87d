// SPDX-License-Identifier: MIT
/// \file
/// Plans that `plan --format json` printed, read back.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "files/plan/plan_json.hpp"

namespace tactor::files {

/// Treatment of a WAV file that a plan names as its waveform.
enum class recordings_kind { read, refuse };

/// Contents of a file with one plan or several (schemas tactor-plan/1 and tactor-plans/1).
struct plan_file {
    piece made; ///< its strokes as far as plans tell: where their bursts or samples are
    array tactors;
    render_options render; ///< with rate, channels and marker
};

/// Returns true if a STROKE argument names such a file: if its extension is .json.
bool is_plan_file(const std::string& argument);

/// Reads burst by burst, so that the text is never in memory. Blocks on the file system.
/// \throws error (bad_input) with the line and column, or the field.
plan_file load_plans(const std::string& file);
/// Reads a text that is in memory; `name` stands for it in messages. A text that comes from elsewhere may
/// have no recordings: they are files of this machine.
plan_file read_plans(std::string_view text, const std::string& name,
                     recordings_kind recordings = recordings_kind::read);

/// Returns true if a text can only be plans: no stroke file begins with a brace.
bool holds_plans(std::string_view text) noexcept;

/// Compares arrays. \throws error (bad_input) where places, channels or polarities differ.
void check_same_array(const std::string& file, const array& made_for, const array& in_use);

} // namespace tactor::files
