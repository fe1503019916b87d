// SPDX-License-Identifier: MIT
#include "study/statistics/tests.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/policies/policy.hpp>
#include <boost/math/tools/roots.hpp>

namespace tactor::study {
namespace {

// Policy that computes in double. By default, Boost.Math computes in long double, also once before main().
// valgrind does not support long double and would end the program there.
using in_double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

// Returns the noncentrality for which P(T <= t) is `below`. P falls as the noncentrality grows.
double noncentrality(double t, double df, double below)
{
    const auto off = [&](double delta) {
        return boost::math::cdf(boost::math::non_central_t_distribution<double, in_double>(df, delta), t) -
               below;
    };
    // Start with a bracket around t that is about as wide as the uncertainty of t. Widen it until it contains
    // the root.
    double width = 1.0 + std::abs(t) / std::sqrt(df);
    double low = t - width;
    double high = t + width;
    while (off(low) < 0.0)
        low -= width *= 2.0;
    width = 1.0 + std::abs(t) / std::sqrt(df);
    while (off(high) > 0.0)
        high += width *= 2.0;
    std::uintmax_t steps = 200;
    const auto [a, b] = boost::math::tools::toms748_solve(
        off, low, high, boost::math::tools::eps_tolerance<double>(48), steps);
    return (a + b) / 2.0;
}

struct share {
    double sum;
    double weight; ///< share of all choices of signs; exact, as a multiple of a power of two
};

constexpr std::size_t most_sums = std::size_t{1} << 20;

// Returns the sums of the values for all choices of signs, in ascending order and without duplicates. Returns
// an empty list if there are too many sums. `equal`: largest difference of two sums that count as equal.
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

using matrix = std::vector<std::vector<double>>;

// Returns Helmert's contrasts as rows: orthonormal, and orthogonal to the mean.
matrix contrasts(std::size_t levels)
{
    matrix c;
    for (std::size_t i = 1; i < levels; ++i) {
        const auto k = static_cast<double>(i);
        std::vector<double> row(levels, 0.0);
        for (std::size_t j = 0; j < i; ++j)
            row[j] = 1.0 / std::sqrt(k * (k + 1.0));
        row[i] = -k / std::sqrt(k * (k + 1.0));
        c.push_back(row);
    }
    return c;
}

matrix average(std::size_t levels)
{
    return {std::vector<double>(levels, 1.0 / std::sqrt(static_cast<double>(levels)))};
}

matrix kronecker_product(const matrix& a, const matrix& b)
{
    matrix c;
    for (const auto& x : a)
        for (const auto& y : b) {
            std::vector<double> row;
            for (const double u : x)
                for (const double v : y)
                    row.push_back(u * v);
            c.push_back(row);
        }
    return c;
}

// Sums of squares of an effect, of its interaction with groups, and of the error. `cross`: cross products of
// the participants' contrasts within groups.
struct parts {
    double effect = 0.0;
    double by_group = 0.0;
    double error = 0.0;
    matrix cross;
};

// Projects the cells onto contrasts. `groups`: the group of each participant, from 0; no group is empty.
parts project(const cell_table& t, const matrix& c, const std::vector<std::size_t>& groups)
{
    std::vector<double> n(1 + *std::max_element(groups.begin(), groups.end()), 0.0);
    for (const std::size_t g : groups)
        n[g] += 1.0;
    matrix z;
    matrix means(n.size(), std::vector<double>(c.size(), 0.0));
    for (std::size_t i = 0; i < t.values.size(); ++i) {
        std::vector<double> on;
        for (std::size_t k = 0; k < c.size(); ++k) {
            double sum = 0.0;
            for (std::size_t j = 0; j < t.values[i].size(); ++j)
                sum += c[k][j] * t.values[i][j];
            on.push_back(sum);
            means[groups[i]][k] += sum / n[groups[i]];
        }
        z.push_back(on);
    }
    parts s;
    s.cross.assign(c.size(), std::vector<double>(c.size(), 0.0));
    for (std::size_t i = 0; i < z.size(); ++i)
        for (std::size_t k = 0; k < c.size(); ++k)
            for (std::size_t l = 0; l < c.size(); ++l)
                s.cross[k][l] += (z[i][k] - means[groups[i]][k]) * (z[i][l] - means[groups[i]][l]);
    // Type III: tests the unweighted mean of the group means.
    const auto all = static_cast<double>(z.size());
    double inverse = 0.0;
    for (const double one : n)
        inverse += all / one;
    const auto count = static_cast<double>(n.size());
    for (std::size_t k = 0; k < c.size(); ++k) {
        double mean = 0.0;
        double of_all = 0.0;
        for (std::size_t g = 0; g < n.size(); ++g) {
            mean += means[g][k] / count;
            of_all += n[g] / all * means[g][k];
        }
        s.effect += all * count * count / inverse * mean * mean;
        for (std::size_t g = 0; g < n.size(); ++g)
            s.by_group += n[g] * (means[g][k] - of_all) * (means[g][k] - of_all);
        s.error += s.cross[k][k];
    }
    return s;
}

// Returns the largest sum of squares that may be only rounding error.
double rounding_error_limit(const cell_table& t)
{
    double largest = 0.0;
    std::size_t count = 0;
    for (const auto& row : t.values)
        for (const double v : row) {
            largest = std::max(largest, std::abs(v));
            ++count;
        }
    return static_cast<double>(count) * std::pow(few_digits * largest, 2.0);
}

// Returns the upper tail of the F distribution.
double f_p_value(double f, double df1, double df2)
{
    return boost::math::cdf(boost::math::complement(
        boost::math::fisher_f_distribution<double, in_double>(df1, df2), std::max(0.0, f)));
}

// Tests a sum of squares with `df1` degrees of freedom against the error in `s`.
effect judge(double squares, std::size_t df1, const parts& s, const cell_table& t, std::size_t groups,
             double all_error)
{
    effect e;
    const std::size_t n = t.values.size();
    if (df1 == 0 || n <= groups)
        return e;
    e.df1 = static_cast<double>(df1);
    e.df2 = static_cast<double>(s.cross.size() * (n - groups));
    if (s.error <= rounding_error_limit(t)) {
        e.ms_error = 0.0;
        return e;
    }
    e.ms_error = s.error / e.df2;
    e.f = squares / e.df1 / *e.ms_error;
    e.p = f_p_value(*e.f, e.df1, e.df2);
    e.eta2_partial = squares / (squares + s.error);
    e.eta2_generalised = squares / (squares + all_error);
    if (s.cross.size() < 2)
        return e;
    e.epsilon_gg = greenhouse_geisser_epsilon(s.cross);
    e.p_gg = f_p_value(*e.f, *e.epsilon_gg * e.df1, *e.epsilon_gg * e.df2);
    e.epsilon_hf = huynh_feldt_epsilon(*e.epsilon_gg, static_cast<double>(s.cross.size()),
                                       static_cast<double>(n - groups));
    if (e.epsilon_hf) {
        const double epsilon = std::min(1.0, *e.epsilon_hf);
        e.p_hf = f_p_value(*e.f, epsilon * e.df1, epsilon * e.df2);
    }
    if (const auto m = test_sphericity(s.cross, n - groups, t.first_levels * t.second_levels)) {
        e.mauchly_w = m->w;
        e.mauchly_p = m->p;
    }
    return e;
}

double trace(const matrix& m)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < m.size(); ++i)
        sum += m[i][i];
    return sum;
}

// Returns the determinant of a symmetric positive semidefinite matrix, by a Cholesky decomposition with
// pivoting.
double determinant(matrix m)
{
    double product = 1.0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        // Take the largest remaining diagonal element first, so that the last elements of a singular
        // matrix are only rounding errors.
        std::size_t best = k;
        for (std::size_t i = k; i < m.size(); ++i)
            best = m[i][i] > m[best][best] ? i : best;
        std::swap(m[k], m[best]);
        for (auto& row : m)
            std::swap(row[k], row[best]);
        if (!(m[k][k] > 0.0))
            return 0.0;
        product *= m[k][k];
        for (std::size_t i = k + 1; i < m.size(); ++i)
            for (std::size_t j = k + 1; j < m.size(); ++j)
                m[i][j] -= m[i][k] * m[k][j] / m[k][k];
    }
    return product;
}

double chi_squared_p_value(double x, double df)
{
    return boost::math::cdf(boost::math::complement(
        boost::math::chi_squared_distribution<double, in_double>(df), std::max(0.0, x)));
}

// Returns the upper tail of the normal distribution.
double upper_normal_tail(double z)
{
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

// Chance that the range of k standard normal variables is above w. It is an integral over the value z of the
// smallest variable. The integrand is the chance that all other variables are above z, minus the chance that
// all of them are between z and z + w. With this step, the trapezoidal rule is exact except for rounding: the
// integrand resembles a Gaussian, so the error falls as exp(-2 pi^2 / (k step^2)).
class range_tail {
public:
    explicit range_tail(std::size_t k) : others_(k - 1), step_(0.7 / std::sqrt(static_cast<double>(k)))
    {
        const auto kk = static_cast<double>(k);
        for (double z = -reach; z < reach; z += step_)
            nodes_.push_back({z, upper_normal_tail(z),
                              kk * step_ * std::exp(-z * z / 2.0) / std::sqrt(2.0 * std::numbers::pi)});
    }

    double operator()(double w) const
    {
        double sum = 0.0;
        for (const node& n : nodes_) {
            const double beyond = upper_normal_tail(n.z + w);
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

    // Returns a^m - b^m, where m is `others_`. Uses a - b, so that a small difference loses no digits.
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

double mean(std::span<const double> values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(std::span<const double> values, double mean)
{
    double squares = 0.0;
    for (const double x : values)
        squares += (x - mean) * (x - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

std::optional<double> median(std::vector<double> values)
{
    if (values.empty())
        return {};
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2.0;
}

bool varies(std::span<const double> values, double rounding)
{
    if (values.empty())
        return false;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double largest = std::max(std::abs(*low), std::abs(*high));
    return *high - *low > std::max(few_digits * largest, rounding);
}

double t_p_value(double t, double df)
{
    const boost::math::students_t_distribution<double, in_double> dist(df);
    return std::min(1.0, 2.0 * boost::math::cdf(boost::math::complement(dist, std::abs(t))));
}

double t_quantile(double df)
{
    return boost::math::quantile(boost::math::students_t_distribution<double, in_double>(df), 0.975);
}

std::optional<interval> noncentrality_interval(double t, double df)
{
    if (!(std::abs(t) <= 1e4))
        return {};
    return interval{noncentrality(t, df, 0.975), noncentrality(t, df, 0.025)};
}

t_test test_mean_quickly(std::span<const double> values, double against, double rounding)
{
    t_test r;
    r.n = values.size();
    if (values.empty())
        return r;
    r.mean = mean(values);
    if (values.size() < 2)
        return r;
    r.df = static_cast<double>(r.n - 1);
    if (!varies(values, rounding)) {
        r.se = 0.0;
        return r;
    }
    r.se = deviation(values, *r.mean) / std::sqrt(static_cast<double>(r.n));
    r.t = (*r.mean - against) / *r.se;
    r.p = t_p_value(*r.t, *r.df);
    return r;
}

t_test test_mean(std::span<const double> values, double against, double rounding)
{
    t_test r = test_mean_quickly(values, against, rounding);
    if (values.size() < 2)
        return r;
    // Sets differences to 0 if they are only rounding errors, because their signs mean nothing.
    std::vector<double> off(values.begin(), values.end());
    for (double& x : off) {
        const double least = std::max(few_digits * std::max(std::abs(x), std::abs(against)), rounding);
        x -= against;
        if (std::abs(x) <= least)
            x = 0.0;
    }
    r.p_signflip = sign_flip_p(off);
    if (!r.t)
        return r;
    const double root_n = std::sqrt(static_cast<double>(r.n));
    const double sd = deviation(values, *r.mean);
    const double wide = t_quantile(*r.df) * *r.se;
    r.ci = interval{*r.mean - wide, *r.mean + wide};
    r.d = (*r.mean - against) / sd;
    if (const auto delta = noncentrality_interval(*r.t, *r.df))
        r.d_ci = interval{delta->first / root_n, delta->second / root_n};
    return r;
}

std::vector<std::optional<interval>>
within_participant_intervals(const std::vector<std::vector<double>>& values, double rounding)
{
    std::vector<std::optional<interval>> all(values.empty() ? 0 : values[0].size());
    if (values.size() < 2 || all.size() < 2)
        return all;
    std::vector<double> own;
    for (const auto& row : values)
        own.push_back(mean(row));
    const double grand = mean(own);
    const auto n = static_cast<double>(values.size());
    const auto conditions = static_cast<double>(all.size());
    const double width = t_quantile(n - 1.0) * std::sqrt(conditions / (conditions - 1.0) / n);
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::vector<double> normalised;
        for (std::size_t i = 0; i < values.size(); ++i)
            normalised.push_back(values[i][k] - own[i] + grand);
        if (!varies(normalised, rounding))
            continue;
        const double middle = mean(normalised);
        const double half = width * deviation(normalised, middle);
        all[k] = interval{middle - half, middle + half};
    }
    return all;
}

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
    // Each sum of all values is a sum of the first half plus a sum of the second half.
    const std::vector<share> first = all_sums(values.first(values.size() / 2), 1e-12 * all);
    const std::vector<share> second = all_sums(values.subspan(values.size() / 2), 1e-12 * all);
    if (first.empty() || second.empty())
        return {};
    // Count only the sums at or above |observed|: each choice of signs has an opposite choice, so equally
    // many sums are at or below -|observed|.
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

interval binomial_interval(std::size_t hits, std::size_t n)
{
    using boost::math::binomial_distribution;
    constexpr double tail = 0.025;
    const auto trials = static_cast<double>(n);
    const auto successes = static_cast<double>(hits);
    return {binomial_distribution<double, in_double>::find_lower_bound_on_p(trials, successes, tail),
            binomial_distribution<double, in_double>::find_upper_bound_on_p(trials, successes, tail)};
}

mixed_anova analyse_groups(const cell_table& t, const std::vector<std::size_t>& groups)
{
    if (t.values.size() < 2)
        return {};
    const matrix first = contrasts(t.first_levels);
    const matrix second = contrasts(t.second_levels);
    const auto split = [&](const matrix& x, const matrix& y) {
        return project(t, kronecker_product(x, y), groups);
    };
    const parts a = split(first, average(t.second_levels));
    const parts b = split(average(t.first_levels), second);
    const parts ab = split(first, second);
    const parts participants = split(average(t.first_levels), average(t.second_levels));
    const double all_error = participants.error + a.error + b.error + ab.error;
    const std::size_t count = 1 + *std::max_element(groups.begin(), groups.end());
    const auto within = [&](const parts& s) {
        return judge(s.effect, s.cross.size(), s, t, count, all_error);
    };
    const auto by_group = [&](const parts& s) {
        return judge(s.by_group, (count - 1) * s.cross.size(), s, t, count, all_error);
    };
    return {
        by_group(participants), {within(a), within(b), within(ab)}, {by_group(a), by_group(b), by_group(ab)}};
}

anova analyse_repeated_measures(const cell_table& t)
{
    return analyse_groups(t, std::vector<std::size_t>(t.values.size(), 0)).within;
}

double greenhouse_geisser_epsilon(const matrix& cross)
{
    double squares = 0.0;
    for (const auto& row : cross)
        for (const double v : row)
            squares += v * v;
    const double sum = trace(cross);
    return std::min(1.0, sum * sum / (static_cast<double>(cross.size()) * squares)); // may round to above 1
}

std::optional<double> huynh_feldt_epsilon(double epsilon_gg, double df1, double df)
{
    const double rest = df - df1 * epsilon_gg;
    if (rest <= 1e-9 * df) // 0 except for rounding
        return {};
    return ((df + 1.0) * df1 * epsilon_gg - 2.0) / (df1 * rest);
}

std::optional<mauchly_test> test_sphericity(const matrix& cross, std::size_t df, std::size_t cells)
{
    if (df < cross.size())
        return {};
    const auto p = static_cast<double>(cross.size());
    const auto n = static_cast<double>(df);
    matrix scaled = cross;
    for (auto& row : scaled)
        for (double& v : row)
            v *= p / trace(cross);
    const double w = std::min(1.0, determinant(std::move(scaled)));
    // For a singular matrix, w is a rounding error of about 1e-16.
    if (w < 1e-13)
        return {};
    const double rho = 1.0 - (2.0 * p * p + p + 2.0) / (6.0 * p * n);
    const double second = (p + 2.0) * (p - 1.0) * (p - 2.0) *
                          (2.0 * p * p * p + 6.0 * p * p + 3.0 * static_cast<double>(cells) + 2.0) /
                          (288.0 * std::pow(n * p * rho, 2.0));
    const double z = -n * rho * std::log(w);
    const double f = p * (p + 1.0) / 2.0 - 1.0;
    const double p1 = chi_squared_p_value(z, f);
    const double p2 = chi_squared_p_value(z, f + 4.0);
    return mauchly_test{w, p1 + second * (p2 - p1)};
}

double studentized_range_p(double q, std::size_t levels, double df)
{
    if (!(q > 0.0))
        return 1.0;
    const range_tail tail(levels);
    // Logarithm of the density of x = log s, relative to its peak at 0. s^2 is chi squared / df, so the
    // density is c exp(df (x - s^2 / 2)). Values below e^-90 do not count.
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

std::vector<double> unwrap_angles(std::vector<double> degrees)
{
    constexpr double turn = 360.0;
    if (degrees.empty())
        return degrees;
    for (double& d : degrees)
        d -= turn * std::floor(d / turn);
    std::vector<double> sorted = degrees;
    std::ranges::sort(sorted);
    double first = sorted.front(); // first angle after the largest gap
    double gap = first + turn - sorted.back();
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] - sorted[i - 1] > gap) {
            gap = sorted[i] - sorted[i - 1];
            first = sorted[i];
        }
    for (double& d : degrees)
        d += d < first ? turn : 0.0;
    const double turns = std::round(mean(degrees) / turn);
    for (double& d : degrees)
        d -= turn * turns;
    return degrees;
}

} // namespace tactor::study
