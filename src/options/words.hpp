// SPDX-License-Identifier: MIT
/// \file
/// Names of options in errors: fields of the library and marks of the table, written as the user of a front
/// end knows them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

#include "options/option.hpp"

namespace tactor::options {

/// Words of the library that stand for no option, and what a front end says.
struct own_word {
    std::string_view of_library;
    std::string_view here;
};

/// A front end's way to write options.
struct spelling {
    /// The option, or with a value what sets it: "--timing", "--timing fit". The value of a flag is "true".
    std::string (*write)(const option& o, std::string_view value) = nullptr;
    std::uint64_t where = ~std::uint64_t{0}; ///< bits of the options that it has; others stay as they are
    std::span<const own_word> own = {};
};

/// Writes marks: {soa}, {soa_s}, {timing=fit}. Other braces stay.
std::string spell_marks(std::string_view text, const spelling& by);
/// The same of all texts of an error.
error spell_marks(const error& e, const spelling& by);

/// Writes marks, and what can only mean an option: "soa_s", "timing = fit", "snap = true", if it is no part
/// of a longer word. `but_keys`: not what stroke files have keys for.
std::string spell(std::string_view text, const spelling& by, bool but_keys = false);

} // namespace tactor::options
