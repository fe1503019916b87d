// SPDX-License-Identifier: MIT
#include "study/statistics/tests.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactor::study {
namespace {

// The normal distribution's upper tail.
double above(double z)
{
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

// The chance that the range of k standard normal variables is above w: over the place z of the least of them,
// all others are above z, less that all are in z ... z + w. Trapezoids of this width are right to rounding:
// the integrand is a Gaussian's kin, and its error falls as exp(-2 pi^2 / (k step^2)).
class range_tail {
public:
    explicit range_tail(std::size_t k) : others_(k - 1), step_(0.7 / std::sqrt(static_cast<double>(k)))
    {
        const auto kk = static_cast<double>(k);
        for (double z = -reach; z < reach; z += step_)
            nodes_.push_back(
                {z, above(z), kk * step_ * std::exp(-z * z / 2.0) / std::sqrt(2.0 * std::numbers::pi)});
    }

    double operator()(double w) const
    {
        double sum = 0.0;
        for (const node& n : nodes_) {
            const double beyond = above(n.z + w);
            sum += n.weight * difference(n.above, std::max(0.0, n.above - beyond), beyond);
        }
        return std::clamp(sum, 0.0, 1.0);
    }

private:
    static constexpr double reach = 9.0;
    struct node {
        double z;
        double above;
        double weight;
    };

    // a^m - b^m, where a - b is known: nothing of a small one is lost.
    double difference(double a, double b, double a_less_b) const
    {
        if (others_ == 1)
            return a_less_b;
        if (a_less_b > 0.1 * a)
            return std::pow(a, static_cast<double>(others_)) - std::pow(b, static_cast<double>(others_));
        return -std::pow(a, static_cast<double>(others_)) *
               std::expm1(static_cast<double>(others_) * std::log1p(-a_less_b / a));
    }

    std::size_t others_;
    double step_;
    std::vector<node> nodes_;
};

} // namespace

double studentized_range_p(double q, std::size_t levels, double df)
{
    if (!(q > 0.0))
        return 1.0;
    const range_tail tail(levels);
    // Over x = log s, s^2 = chi squared / df: density c exp(df (x - s^2 / 2)). Its logarithm relative to the
    // peak at 0, beside which nothing below e^-90 counts.
    const auto log_density = [&](double x) { return df * (x - 0.5 * std::expm1(2.0 * x)); };
    const double step = std::min(0.04, 0.35 / std::sqrt(df));
    double sum = 0.0;
    double all = 0.0;
    const auto take = [&](double x) {
        const double weight = std::exp(log_density(x));
        all += weight;
        sum += weight * tail(q * std::exp(x));
    };
    take(0.0);
    for (double x = step; log_density(x) > -90.0; x += step)
        take(x);
    for (double x = -step; log_density(x) > -90.0; x -= step)
        take(x);
    return std::min(1.0, sum / all);
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

} // namespace tactor::study
