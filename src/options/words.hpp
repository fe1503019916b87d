// SPDX-License-Identifier: MIT
/// \file
/// From an error of the library to the message of a front end.
///
/// An error has a field ("soa_s"), a place in a file, and marks in its texts (core/marks.hpp). Each front end
/// has a spelling that writes field and marks: cli/option_words.cpp ("--soa"), server/faults.cpp
/// ("options.soa"), python/options.cpp ("soa"), study/experiment/definition.cpp. at_default() puts the place
/// in [defaults] before an option's error. None of them looks into the words.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// A front end's own word for a mark, or for a field that is no row: {"command:devices", "devices()"}. The
/// mark "array" stands for {array=palm}, too, and {} for its value. An empty word leaves it out, with its
/// clause.
struct own_word {
    std::string_view mark;
    std::string_view here;
};

/// A front end's way to write options.
struct spelling {
    /// The option, or with a value what sets it: "--timing", "--timing fit". The value of a flag is "true".
    std::string (*write)(const option& o, std::string_view value) = nullptr;
    std::uint64_t where = ~std::uint64_t{0}; ///< bits of its options; others are written as fields
    std::span<const own_word> own = {};
};

/// Writes the marks of a text. Braces that name nothing known stay. `in_file`: keys of stroke files are
/// written as fields.
std::string spell(std::string_view text, const spelling& by, bool in_file = false);
/// Writes the name of a field.
std::string spell_field(std::string_view field, const spelling& by);
/// Writes what an error is about, and its marks.
error spell(const error& e, const spelling& by);

} // namespace tactor::options
