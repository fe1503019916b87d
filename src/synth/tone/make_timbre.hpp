// SPDX-License-Identifier: MIT
/// \file
/// Timbre of a plan. It is computed when a score is made, never in the audio thread.
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include <tactor/plan.hpp>

#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// Returns the timbre of a plan; null for a sine of one frequency, which needs none.
/// \throws error (bad_input) for a timbre that is not possible at that rate.
std::shared_ptr<const timbre> make_timbre(const plan& p, unsigned rate);

/// Returns the field that sets the frequency of a plan's carrier, for messages.
const char* carrier_field(const plan& p) noexcept;

/// Returns true if the carrier crosses zero whenever its phase is 0: bursts between two such times need no
/// ramp.
bool crosses_zero(const plan& p) noexcept;

/// Timbres of the plans of one score, each stored once. One thread.
class timbre_shelf {
public:
    /// Returns the timbre of a plan. Throws like make_timbre().
    std::shared_ptr<const timbre> get(const plan& p, unsigned rate);

private:
    struct place {
        plan sound; ///< only with the members that determine the sound
        std::shared_ptr<const timbre> made;
    };
    std::vector<place> places_;
};

using spectrum = std::vector<std::complex<double>>;

/// Computes x[n] = sum over k of x[k] exp(2 pi i k n / size), in place; the size is a power of 2. The bits
/// are the same on every machine.
void compute_fourier_sum(spectrum& x);

} // namespace tactor::synth
