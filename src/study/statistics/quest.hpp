// SPDX-License-Identifier: MIT
/// \file
/// The adaptive procedure QUEST+ (Watson 2017). It chooses the stimulus whose answer is expected to give the
/// most information about the parameters of a psychometric function.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tactor::study {

/// Parameters of a psychometric function.
struct psychometric {
    double threshold = 0.0;
    double slope = 1.0; ///< standard deviation of the normal distribution, in the unit of the stimulus
    double lapse = 0.0;
};

/// The x at which Phi is 0.75.
inline constexpr double normal_quartile = 0.6744897501960817;

/// Returns guess + (1 - guess - lapse) Phi((x - threshold) / slope).
double normal_chance(double x, const psychometric& p, double guess);

/// Possible stimuli, and possible parameters: all combinations of thresholds, slopes and lapses.
struct quest_grid {
    std::vector<double> stimuli = {};
    std::vector<double> thresholds = {};
    std::vector<double> weights = {}; ///< prior weights of the thresholds; empty if all are equal
    std::vector<double> slopes = {};
    std::vector<double> lapses = {};
};

class quest {
public:
    /// Chooses the first stimulus. `chance`: returns the chance, 0 to 1, of a right answer to a stimulus if
    /// the function has the given parameters.
    quest(const quest_grid& g, const std::function<double(double, const psychometric&)>& chance);

    /// Returns the next stimulus. If several stimuli are equally good, this is the first of them in the grid.
    double stimulus() const noexcept { return stimuli_[next_]; }
    /// Returns the index of stimulus() in the grid.
    std::size_t place() const noexcept { return next_; }
    /// Takes the answer to stimulus().
    void answer(bool right);

    /// Returns the posterior means of the parameters.
    psychometric estimate() const;
    /// Returns the posterior standard deviation of the threshold.
    double threshold_sd() const;
    /// Returns the expected entropy (natural logarithm) of the parameters after the answer to stimulus().
    double expected_entropy() const noexcept { return entropy_; }

private:
    void choose();

    std::vector<double> stimuli_;
    std::vector<psychometric> parameters_ = {};
    std::vector<double> chance_ = {};           ///< chance of a right answer, by stimulus, then by parameters
    std::vector<double> answer_entropies_ = {}; ///< entropy of an answer with this chance
    std::vector<double> likely_ = {};           ///< posterior chance of each set of parameters; the sum is 1
    std::size_t next_ = 0;
    double entropy_ = 0.0;
};

} // namespace tactor::study
