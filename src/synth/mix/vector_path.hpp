// SPDX-License-Identifier: MIT
/// \file
/// Which of the loops that clones.hpp compiles runs on this processor.
#pragma once

namespace tactor::synth {

/// "avx-512", "avx2" or "baseline".
const char* vector_path() noexcept;

} // namespace tactor::synth
