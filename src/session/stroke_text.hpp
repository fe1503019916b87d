// SPDX-License-Identifier: MIT
/// \file
/// Strokes as the text of a new file, and the parts of them that it cannot hold.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/plan/plan_json.hpp"
#include "files/stroke_format.hpp"
#include "options/option.hpp"

namespace tactor::session {

/// Returns the strokes of plans, each with its plan's method and start.
std::vector<stroke> list_plan_strokes(const files::piece& planned);

/// Returns the starts of strokes, s from the start of the piece. May throw.
using start_finder = std::function<std::vector<double>(const std::vector<stroke>&)>;

/// Counts a start from the start of the piece if a new file in this format cannot hold it. Calls `find` only
/// if there is such a start.
void count_from_piece(std::vector<stroke>& strokes, const detail::stroke_format& to,
                      const start_finder& find);

/// Adds the options that differ from the built-in ones or that the user set, if stroke files have keys for
/// them, to the strokes that do not set them. A client gets no names of the owner's recordings.
void put_options(std::vector<stroke>& strokes, const options::option_values& o);

/// Returns the starts of strokes, s, as if each lasted as long as its path.
std::vector<double> path_starts_s(const std::vector<stroke>& strokes);

/// Text of a stroke file, and what it lacks.
struct written_strokes {
    std::string text = {};
    std::vector<std::string> left_out = {}; ///< "a CSV file cannot hold the name", for people
};

/// Writes strokes, and reads the text again to find what it lacks.
/// \throws error (bad_input) about `name` for more strokes than the format can hold.
written_strokes write_strokes(std::span<const stroke> strokes, const detail::stroke_format& to,
                              const std::string& name);

/// Writes a stroke file whole or not at all, in the format of its extension. Returns what it lacks. Without
/// `force` it replaces a file only as tactor wrote it. Blocks on the file system.
/// \throws error (bad_input) for another extension, as write_strokes(), and as detail::write_text().
std::vector<std::string> save_strokes(std::span<const stroke> strokes, const std::string& file, bool force,
                                      detail::owner_kind writer = detail::owner_kind::user);

/// Returns the format of a new stroke file. \throws error (bad_input) that lists the extensions, and the
/// others that the caller takes.
const detail::stroke_format& find_written_format(const std::string& file,
                                                 std::vector<std::string_view> others = {});

} // namespace tactor::session
