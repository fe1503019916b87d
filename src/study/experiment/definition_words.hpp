// SPDX-License-Identifier: MIT
/// \file
/// The library's advice for whoever writes a definition.
#pragma once

#include <string>
#include <string_view>

namespace tactor::study {

/// A hint of the library with the keys of a definition where it names its fields, and without what a
/// definition cannot say. What reads as a field no more is made no option of, either.
std::string in_definition_words(std::string_view hint);

} // namespace tactor::study
