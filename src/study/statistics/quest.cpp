// SPDX-License-Identifier: MIT
#include "study/statistics/quest.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace tactor::study {
namespace {

double entropy_part(double chance)
{
    return chance > 0.0 ? -chance * std::log(chance) : 0.0;
}

// Returns the entropy of an answer that is right with this chance.
double answer_entropy(double chance)
{
    return entropy_part(chance) + entropy_part(1.0 - chance);
}

void scale_to_one(std::vector<double>& all)
{
    const double sum = std::accumulate(all.begin(), all.end(), 0.0);
    for (double& one : all)
        one /= sum;
}

} // namespace

double normal_chance(double x, const psychometric& p, double guess)
{
    const double z = (x - p.threshold) / p.slope;
    return guess + (1.0 - guess - p.lapse) * 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

quest::quest(const quest_grid& g, const std::function<double(double, const psychometric&)>& chance)
    : stimuli_(g.stimuli)
{
    for (std::size_t i = 0; i < g.thresholds.size(); ++i)
        for (const double slope : g.slopes)
            for (const double lapse : g.lapses) {
                parameters_.push_back({g.thresholds[i], slope, lapse});
                likely_.push_back(g.weights.empty() ? 1.0 : g.weights[i]);
            }
    scale_to_one(likely_);
    for (const double x : stimuli_)
        for (const psychometric& p : parameters_) {
            chance_.push_back(chance(x, p));
            answer_entropies_.push_back(answer_entropy(chance_.back()));
        }
    choose();
}

// Chooses the stimulus whose answer is expected to reduce the entropy of the parameters most. The expected
// reduction is the entropy of the answer minus its mean entropy given the parameters.
void quest::choose()
{
    double entropy = 0.0;
    for (const double l : likely_)
        entropy += entropy_part(l);
    entropy_ = std::numeric_limits<double>::infinity();
    const std::size_t n = parameters_.size();
    for (std::size_t i = 0; i < stimuli_.size(); ++i) {
        double right = 0.0;
        double known = 0.0;
        for (std::size_t k = 0; k < n; ++k) {
            right += likely_[k] * chance_[i * n + k];
            known += likely_[k] * answer_entropies_[i * n + k];
        }
        if (const double after = entropy - (answer_entropy(right) - known); after < entropy_) {
            entropy_ = after;
            next_ = i;
        }
    }
}

void quest::answer(bool right)
{
    const std::size_t n = parameters_.size();
    for (std::size_t k = 0; k < n; ++k) {
        const double chance = chance_[next_ * n + k];
        likely_[k] *= right ? chance : 1.0 - chance;
    }
    scale_to_one(likely_);
    choose();
}

psychometric quest::estimate() const
{
    psychometric mean{0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < likely_.size(); ++k) {
        mean.threshold += likely_[k] * parameters_[k].threshold;
        mean.slope += likely_[k] * parameters_[k].slope;
        mean.lapse += likely_[k] * parameters_[k].lapse;
    }
    return mean;
}

double quest::threshold_sd() const
{
    const double mean = estimate().threshold;
    double square = 0.0;
    for (std::size_t k = 0; k < likely_.size(); ++k)
        square += likely_[k] * (parameters_[k].threshold - mean) * (parameters_[k].threshold - mean);
    return std::sqrt(square);
}

} // namespace tactor::study
