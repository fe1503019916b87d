// SPDX-License-Identifier: MIT
/// \file
/// QUEST+ (Watson 2017): the next stimulus is the one whose answer is expected to say most about the
/// parameters of a psychometric function.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tactor::study {

/// Parameters of a psychometric function.
struct psychometric {
    double threshold = 0.0;
    double slope = 1.0; ///< standard deviation of the normal, in the unit of the stimulus
    double lapse = 0.0;
};

/// The x at which Phi is 0.75.
inline constexpr double normal_quartile = 0.6744897501960817;

/// Returns guess + (1 - guess - lapse) Phi((x - threshold) / slope).
double normal_chance(double x, const psychometric& p, double guess);

/// Possible stimuli and parameters: each threshold with each slope and each lapse.
struct quest_grid {
    std::vector<double> stimuli = {};
    std::vector<double> thresholds = {};
    std::vector<double> weights = {}; ///< weights of the thresholds before the first answer; empty: all equal
    std::vector<double> slopes = {};
    std::vector<double> lapses = {};
};

class quest {
public:
    /// `chance` returns the chance of a right answer to a stimulus, 0 to 1, from the parameters.
    quest(const quest_grid& g, const std::function<double(double, const psychometric&)>& chance);

    /// Returns the next stimulus. Of equally good ones this is the first in the grid.
    double stimulus() const noexcept { return stimuli_[next_]; }
    /// Returns the index of stimulus() in the grid.
    std::size_t place() const noexcept { return next_; }
    /// Takes the answer to stimulus().
    void answer(bool right);

    /// Returns the means of the parameters after the answers so far.
    psychometric estimate() const;
    /// Returns the standard deviation of the threshold after the answers so far.
    double threshold_sd() const;
    /// Returns the entropy (natural logarithm) that is expected after the answer to stimulus().
    double expected_entropy() const noexcept { return entropy_; }

private:
    void choose();

    std::vector<double> stimuli_;
    std::vector<psychometric> parameters_ = {};
    std::vector<double> chance_ = {};           ///< of a right answer, by stimulus, then by parameters
    std::vector<double> answer_entropies_ = {}; ///< of an answer with that chance
    std::vector<double> likely_ = {};           ///< chance of each set of parameters; sums up to 1
    std::size_t next_ = 0;
    double entropy_ = 0.0;
};

} // namespace tactor::study
