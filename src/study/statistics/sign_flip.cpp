// SPDX-License-Identifier: MIT
#include "study/statistics/sign_flip.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace tactor::study {
namespace {

struct share {
    double sum;
    double weight; ///< part of all choices of signs: a multiple of a power of two, so exact
};

constexpr std::size_t most_sums = std::size_t{1} << 20;

// All sums of the values with either sign, in order, equal ones as one; empty where they are too many.
std::vector<share> all_sums(std::span<const double> values, double equal)
{
    std::vector<share> sums{{0.0, 1.0}};
    for (const double v : values) {
        std::vector<share> both;
        both.reserve(2 * sums.size());
        const auto moved = [&](double by) {
            std::vector<share> m = sums;
            for (share& s : m)
                s = {s.sum + by, s.weight / 2.0};
            return m;
        };
        const std::vector<share> down = moved(-std::abs(v));
        const std::vector<share> up = moved(std::abs(v));
        std::merge(down.begin(), down.end(), up.begin(), up.end(), std::back_inserter(both),
                   [](const share& a, const share& b) { return a.sum < b.sum; });
        sums.clear();
        for (const share& s : both)
            if (!sums.empty() && s.sum - sums.back().sum <= equal)
                sums.back().weight += s.weight;
            else
                sums.push_back(s);
        if (sums.size() > most_sums)
            return {};
    }
    return sums;
}

} // namespace

std::optional<double> sign_flip_p(std::span<const double> values)
{
    double all = 0.0;
    double observed = 0.0;
    for (const double v : values) {
        all += std::abs(v);
        observed += v;
    }
    if (values.empty())
        return {};
    // A sum of one half and one of the other make each sum of all.
    const std::vector<share> first = all_sums(values.first(values.size() / 2), 1e-12 * all);
    const std::vector<share> second = all_sums(values.subspan(values.size() / 2), 1e-12 * all);
    if (first.empty() || second.empty())
        return {};
    // As many sums are at or above |observed| as at or below -|observed|: signs come in opposites.
    const double limit = std::abs(observed) - 1e-9 * all;
    if (limit <= 0.0)
        return 1.0;
    double above = 0.0;
    double taken = 0.0;
    std::size_t at = second.size();
    for (const share& s : first) {
        while (at > 0 && s.sum + second[at - 1].sum >= limit)
            taken += second[--at].weight;
        above += s.weight * taken;
    }
    return std::min(1.0, 2.0 * above);
}

} // namespace tactor::study
