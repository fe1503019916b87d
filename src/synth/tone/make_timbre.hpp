// SPDX-License-Identifier: MIT
/// \file
/// From what a plan says of its sound to a timbre.
#pragma once

#include <memory>
#include <vector>

#include <tactor/plan.hpp>

#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// The timbre of a plan; null for a sine of one frequency, which needs none.
/// \throws error (bad_input) for a timbre that cannot be made at that rate.
std::shared_ptr<const timbre> make_timbre(const plan& p, unsigned rate);

/// What says the frequency of a plan's carrier, for messages.
const char* carrier_field(const plan& p) noexcept;

/// Whether the carrier crosses zero where its phase says so: bursts between two such places need no ramp.
bool crosses_zero(const plan& p) noexcept;

/// Timbres of the plans of one score, each once. Not for several threads.
class timbre_shelf {
public:
    /// Throws like make_timbre().
    std::shared_ptr<const timbre> get(const plan& p, unsigned rate);

private:
    struct place {
        plan asked; ///< only the parts that are heard count
        std::shared_ptr<const timbre> made;
    };
    std::vector<place> places_;
};

} // namespace tactor::synth
