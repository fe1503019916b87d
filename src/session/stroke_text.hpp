// SPDX-License-Identifier: MIT
/// \file
/// Strokes as the text of a new file, and the parts of the strokes that the file cannot hold.
#pragma once

#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>

#include "files/plan/plan_json.hpp"
#include "files/stroke_format.hpp"
#include "options/option.hpp"

namespace tactor::session {

/// Returns the strokes of plans, each with its plan's method and start.
std::vector<stroke> list_plan_strokes(const files::piece& planned);

/// Function that returns the start of each stroke, s from the start of the piece. May throw.
using start_finder = std::function<std::vector<double>(const std::vector<stroke>&)>;

/// Replaces each start that a new file in this format cannot hold by one that counts from the start of the
/// piece. Calls `find` only if there is such a start.
void replace_unsupported_starts(std::vector<stroke>& strokes, const detail::stroke_format& to,
                                const start_finder& find);

/// Adds options to the strokes that do not set them: options that have a key in stroke files, and that the
/// user set or that differ from the built-in options. A client does not get the names of the owner's
/// recordings.
void add_missing_options(std::vector<stroke>& strokes, const options::option_values& o);

/// Returns the starts of strokes, s, as if each lasted as long as its path.
std::vector<double> path_starts_s(const std::vector<stroke>& strokes);

/// Text of a stroke file, and what the file lacks.
struct written_strokes {
    std::string text = {};
    std::vector<std::string> left_out = {}; ///< sentences such as "a CSV file cannot hold the name"
};

/// Describes what a file of strokes that were fitted to the array lacks: it has millimetres.
std::string lost_fit(const detail::stroke_format& to);

/// Writes strokes as text. Then reads this text, and lists what the format could not hold. `on`: the array on
/// which the strokes were placed; null if each stroke has its own fit.
/// \throws error (bad_input) about `name` if there are more strokes than the format can hold.
written_strokes write_strokes(std::span<const stroke> strokes, const detail::stroke_format& to,
                              const std::string& name, const layout* on);

/// Writes a stroke file whole or not at all, in the format of its extension. Returns what the file lacks.
/// Unless `force`, replaces a file only if tactor wrote it and it has not changed. Blocks on the file system.
/// \throws error (bad_input) for an unknown extension; also throws as write_strokes() and write_text() do.
std::vector<std::string> save_strokes(std::span<const stroke> strokes, const std::string& file, bool force,
                                      const layout* on, detail::owner_kind writer = detail::owner_kind::user);

/// Returns the format of a new stroke file. \throws error (bad_input) for an unknown extension. The error
/// lists the known extensions, and `others`, which the caller also takes.
const detail::stroke_format& find_output_format(const std::string& file,
                                                std::initializer_list<std::string_view> others = {});

} // namespace tactor::session
