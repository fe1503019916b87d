// SPDX-License-Identifier: MIT
#include "study/statistics/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace tactor::study {
namespace {

// Adjusts the p values of all pairs.
void add_holm(std::vector<paired_comparison>& all)
{
    std::vector<std::optional<double>> p;
    for (const paired_comparison& c : all)
        p.push_back(c.test.p);
    p = holm(p);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].p_holm = p[i];
}

} // namespace

std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p)
{
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p[i])
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return *p[a] < *p[b]; });
    std::vector<std::optional<double>> adjusted(p.size());
    double least = 0.0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        least = std::max(least, std::min(1.0, static_cast<double>(order.size() - rank) * *p[order[rank]]));
        adjusted[order[rank]] = least;
    }
    return adjusted;
}

std::vector<comparison> tukey(const std::vector<double>& means, std::size_t n, std::optional<double> ms_error,
                              double df)
{
    std::vector<comparison> all;
    for (std::size_t a = 0; a < means.size(); ++a)
        for (std::size_t b = a + 1; b < means.size(); ++b) {
            comparison c{a, b, means[a] - means[b]};
            if (ms_error && *ms_error > 0.0) {
                c.q = std::abs(c.difference) / std::sqrt(*ms_error / static_cast<double>(n));
                c.p = studentized_range_p(*c.q, means.size(), df);
            }
            all.push_back(c);
        }
    return all;
}

std::vector<paired_comparison> compare_pairs(const std::vector<std::vector<double>>& levels, double rounding,
                                             t_test (*test)(std::span<const double>, double, double))
{
    std::vector<paired_comparison> all;
    for (std::size_t a = 0; a < levels.size(); ++a)
        for (std::size_t b = a + 1; b < levels.size() && !levels[a].empty(); ++b) {
            std::vector<double> differences;
            for (std::size_t i = 0; i < levels[a].size(); ++i)
                differences.push_back(levels[a][i] - levels[b][i]);
            all.push_back({a, b, test(differences, 0.0, rounding)});
        }
    add_holm(all);
    return all;
}

std::vector<paired_comparison> compare_group_pairs(const std::vector<std::vector<double>>& groups)
{
    double squares = 0.0;
    double df = 0.0;
    bool vary = false;
    for (const std::vector<double>& g : groups) {
        if (g.empty())
            return {};
        for (const double x : g)
            squares += (x - mean(g)) * (x - mean(g));
        df += static_cast<double>(g.size()) - 1.0;
        vary = vary || varies(g);
    }
    std::vector<paired_comparison> all;
    for (std::size_t a = 0; a < groups.size(); ++a)
        for (std::size_t b = a + 1; b < groups.size(); ++b) {
            t_test r{.n = groups[a].size() + groups[b].size(), .mean = mean(groups[a]) - mean(groups[b])};
            if (vary) {
                const double sd = std::sqrt(squares / df);
                const double root = std::sqrt(1.0 / static_cast<double>(groups[a].size()) +
                                              1.0 / static_cast<double>(groups[b].size()));
                r.df = df;
                r.se = sd * root;
                r.t = *r.mean / *r.se;
                r.p = t_p_value(*r.t, df);
                const double wide = t_quantile(df) * *r.se;
                r.ci = interval{*r.mean - wide, *r.mean + wide};
                r.d = *r.mean / sd;
                if (const auto delta = noncentrality_interval(*r.t, df))
                    r.d_ci = interval{delta->first * root, delta->second * root};
            }
            all.push_back({a, b, r});
        }
    add_holm(all);
    return all;
}

} // namespace tactor::study
