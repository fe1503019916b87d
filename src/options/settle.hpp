// SPDX-License-Identifier: MIT
/// \file
/// What is given to options: who wins, what goes together, and how errors call them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/setup.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// Takes what the user gave; marks the row as given. What [defaults] say of the option or of its rival no
/// longer counts. \throws error (bad_input) for a rival that the user gave as well, and for a text that
/// cannot be read.
void give(wishes& w, const option& o, const value& v);

/// A value of [defaults], checked.
struct said_default {
    const option* row = nullptr;
    value said = {};
    source_place at = {};
};

/// Checks [defaults]. \throws error (bad_input) with the place in the file.
std::vector<said_default> read_defaults(const setup& says);

/// Fills rows that can be given at w.place, and that the user did not give, from [defaults]. What a file says
/// wins over what was said before it. \throws error (bad_input) with the place in the file.
void apply_defaults(wishes& w, const setup& says);

/// Settles options that depend on others, once all are given. \throws error (bad_input) for those that
/// nothing uses.
void settle(wishes& w);

/// \throws error (bad_input) where an option would plan `what` anew, which is planned already.
void refuse_planning(const wishes& w, const std::string& what);

/// An error about a value that [defaults] gave, with its place there; others as they are.
error at_default(const wishes& w, const error& e);

/// Writes a mark: the row's name and, where the mark has one, the value.
using speller = std::function<std::string(const option& o, std::string_view value)>;

/// Texts of the library and of the table name options by marks: {soa}, {timing=fit}. Returns the text with
/// each mark as `spell` writes it.
std::string spell_marks(std::string_view text, const speller& spell);
/// The same of all texts of an error.
error spell_marks(const error& e, const speller& spell);

} // namespace tactor::options
