// SPDX-License-Identifier: MIT

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include "study/statistics/precision.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

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

matrix kronecker(const matrix& a, const matrix& b)
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

// The sums of squares of an effect, and the cross products of the participants' differences.
struct parts {
    double effect = 0.0;
    double error = 0.0;
    matrix cross;
};

parts project(const cell_table& t, const matrix& c)
{
    const auto n = static_cast<double>(t.values.size());
    matrix z;
    std::vector<double> mean(c.size(), 0.0);
    for (const auto& row : t.values) {
        std::vector<double> on;
        for (std::size_t k = 0; k < c.size(); ++k) {
            double sum = 0.0;
            for (std::size_t i = 0; i < row.size(); ++i)
                sum += c[k][i] * row[i];
            on.push_back(sum);
            mean[k] += sum / n;
        }
        z.push_back(on);
    }
    parts s;
    s.cross.assign(c.size(), std::vector<double>(c.size(), 0.0));
    for (const auto& on : z)
        for (std::size_t k = 0; k < c.size(); ++k)
            for (std::size_t l = 0; l < c.size(); ++l)
                s.cross[k][l] += (on[k] - mean[k]) * (on[l] - mean[l]);
    for (std::size_t k = 0; k < c.size(); ++k) {
        s.effect += n * mean[k] * mean[k];
        s.error += s.cross[k][k];
    }
    return s;
}

// Returns the largest sum of squares that rounding leaves of 0.
double nothing(const cell_table& t)
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

effect judge(const parts& s, const cell_table& t, double all_error)
{
    effect e;
    const std::size_t n = t.values.size();
    const auto df1 = static_cast<double>(s.cross.size());
    if (s.cross.empty() || n < 2)
        return e;
    e.df1 = df1;
    e.df2 = df1 * static_cast<double>(n - 1);
    if (s.error <= nothing(t)) {
        e.ms_error = 0.0;
        return e;
    }
    e.ms_error = s.error / e.df2;
    e.f = s.effect / df1 / *e.ms_error;
    e.p = p_of_f(*e.f, e.df1, e.df2);
    e.eta2_partial = s.effect / (s.effect + s.error);
    e.eta2_generalised = s.effect / (s.effect + all_error);
    if (s.cross.size() < 2)
        return e;
    e.epsilon_gg = greenhouse_geisser(s.cross);
    e.p_gg = p_of_f(*e.f, *e.epsilon_gg * e.df1, *e.epsilon_gg * e.df2);
    if (const auto m = mauchly(s.cross, n - 1, t.first_levels * t.second_levels)) {
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

// Returns the determinant of a symmetric matrix without negative eigenvalues, by Cholesky; 0 if one is 0.
double determinant(matrix m)
{
    double product = 1.0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        // The largest that is left comes first, so that only rounding remains of a singular matrix.
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

double upper_chi_squared(double x, double df)
{
    return boost::math::cdf(boost::math::complement(
        boost::math::chi_squared_distribution<double, in_double>(df), std::max(0.0, x)));
}

} // namespace

double p_of_f(double f, double df1, double df2)
{
    return boost::math::cdf(boost::math::complement(
        boost::math::fisher_f_distribution<double, in_double>(df1, df2), std::max(0.0, f)));
}

anova repeated_measures(const cell_table& t)
{
    if (t.values.size() < 2)
        return {};
    const matrix first = contrasts(t.first_levels);
    const matrix second = contrasts(t.second_levels);
    const parts a = project(t, kronecker(first, average(t.second_levels)));
    const parts b = project(t, kronecker(average(t.first_levels), second));
    const parts ab = project(t, kronecker(first, second));
    const parts participants = project(t, kronecker(average(t.first_levels), average(t.second_levels)));
    const double all_error = participants.error + a.error + b.error + ab.error;
    return {judge(a, t, all_error), judge(b, t, all_error), judge(ab, t, all_error)};
}

double greenhouse_geisser(const matrix& cross)
{
    double squares = 0.0;
    for (const auto& row : cross)
        for (const double v : row)
            squares += v * v;
    const double sum = trace(cross);
    return std::min(1.0, sum * sum / (static_cast<double>(cross.size()) * squares)); // but for rounding
}

std::optional<mauchly_test> mauchly(const matrix& cross, std::size_t df, std::size_t cells)
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
    // A singular matrix has a w of rounding errors, some 1e-16.
    if (w < 1e-13)
        return {};
    const double rho = 1.0 - (2.0 * p * p + p + 2.0) / (6.0 * p * n);
    const double second = (p + 2.0) * (p - 1.0) * (p - 2.0) *
                          (2.0 * p * p * p + 6.0 * p * p + 3.0 * static_cast<double>(cells) + 2.0) /
                          (288.0 * std::pow(n * p * rho, 2.0));
    const double z = -n * rho * std::log(w);
    const double f = p * (p + 1.0) / 2.0 - 1.0;
    const double p1 = upper_chi_squared(z, f);
    const double p2 = upper_chi_squared(z, f + 4.0);
    return mauchly_test{w, p1 + second * (p2 - p1)};
}

} // namespace tactor::study
