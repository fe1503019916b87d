// SPDX-License-Identifier: MIT
/// \file
/// One stroke by several algorithms and phantom models: what each is predicted to feel like.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"

namespace tactor::cli {

/// What the prediction is, in a sentence that goes with its numbers.
inline constexpr const char* prediction_note =
    "a model's prediction, not a measurement: the felt position is taken to be the centre of energy of the "
    "tactors that sound";

/// One algorithm with one phantom model. Either a plan, or why there is none.
struct comparison_row {
    algorithm method = algorithm::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    std::optional<plan> schedule = {};
    percept_summary felt = {};
    std::vector<percept_sample> samples = {}; ///< only where asked for
    std::optional<error> refused = {};
};

struct comparison {
    stroke target;
    std::vector<comparison_row> rows = {};

    /// Whether any algorithm can play it.
    bool playable() const;
};

/// What is compared with what.
struct comparison_choice {
    std::vector<algorithm> algorithms = {};
    std::vector<phantom_kind> phantoms = {};
    bool keep_samples = false;
};

/// Every algorithm with every model, in this order. An algorithm that cannot play the stroke becomes a row
/// that says why. \throws what is not bad input.
comparison compare(const stroke& s, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice);

/// All write to `out`.
void print_text(std::FILE* out, const std::vector<comparison>& all, const array& a);
void print_json(std::FILE* out, const std::vector<comparison>& all, const array& a);
void print_csv(std::FILE* out, const std::vector<comparison>& all, const array& a);

} // namespace tactor::cli
