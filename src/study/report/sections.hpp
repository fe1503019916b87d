// SPDX-License-Identifier: MIT
/// \file
/// The sections of a methods section, each with its heading.
#pragma once

#include <string>
#include <string_view>

#include "study/analysis/analysis.hpp"
#include "study/report/facts.hpp"

namespace tactor::study {

std::string participants_section(const study_facts& f, const analysis& a);
/// Array, carrier, levels, thresholds, the sound device.
std::string apparatus_section(const study_facts& f);
/// Timing law, algorithms, phantom models, motions.
std::string stimuli_section(const study_facts& f);
/// Runs, trials, order, masking, breaks.
std::string procedure_section(const study_facts& f, const dataset& d);
/// Void trials, versions, hashes.
std::string data_section(const study_facts& f, const dataset& d);
/// As tactor analyze computes them; each is marked where the study is simulated.
std::string results_section(const analysis& a);
/// The papers that `named` names.
std::string references_section(std::string_view named);

} // namespace tactor::study
