// SPDX-License-Identifier: MIT
/// \file
/// Which of the loops that clones.hpp makes this processor runs.
#pragma once

namespace tactor::synth {

/// "avx-512", "avx2" or "baseline".
const char* vector_path() noexcept;

} // namespace tactor::synth
