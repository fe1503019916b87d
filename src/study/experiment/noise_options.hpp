// SPDX-License-Identifier: MIT
/// \file
/// The masking noise that a definition asks for.
#pragma once

#include <string>

#include "study/experiment/definition.hpp"
#include "study/masking/masking_stream.hpp"

namespace tactor::study {

/// `m` must ask for one. The same seed gives the same noise.
masking_options noise_of(const masking_definition& m, std::string seed);

} // namespace tactor::study
