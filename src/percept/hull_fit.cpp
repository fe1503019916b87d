// SPDX-License-Identifier: MIT
#include "percept/hull_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "percept/band.hpp"
#include "percept/low_speed.hpp"

namespace tactor::detail {
namespace {

constexpr int most_steps = 200;
constexpr double small_gap = 1e-16;    // what ends the search, in units of the array's size squared
constexpr double bearable_gap = 1e-10; // where rounding ends it before
constexpr double nearly = 0.995;       // of the way to the next side

/// With y the places felt and m = A y, A = I + K: minimise |y - x|^2 / 2 where each m_i keeps each side. s
/// are the distances from the sides, lambda what they push with; y is inside from the first step on.
class inner_search {
public:
    inner_search(std::span<const double> give, std::vector<point> x, std::vector<beyond> sides)
        : give_(give),
          x_(std::move(x)),
          sides_(std::move(sides)),
          y_(x_.size()),
          slack_(x_.size() * sides_.size()),
          push_(slack_.size()),
          slack_step_(slack_.size()),
          push_step_(slack_.size()),
          rhs_(2 * x_.size()),
          matrix_(2 * x_.size())
    {
        for (std::size_t k = 0; k < slack_.size(); ++k) {
            slack_[k] = sides_[k % sides_.size()].reach;
            push_[k] = 0.1 / slack_[k];
        }
    }

    /// False: rounding ended it too early. The best place on the way counts.
    bool run()
    {
        double best = std::numeric_limits<double>::infinity();
        for (int i = 0; i < most_steps && best > small_gap; ++i) {
            find_residual();
            const double now = gap();
            if (now < best) {
                best = now;
                best_ = y_;
            }
            if (!(now < 1e3 * best) || !step())
                break;
        }
        return best <= bearable_gap;
    }

    const std::vector<point>& felt() const { return best_; }

private:
    double sum_of_products() const
    {
        double sum = 0.0;
        for (std::size_t k = 0; k < slack_.size(); ++k)
            sum += slack_[k] * push_[k];
        return sum;
    }

    // How far |y - x|^2 / 2 may be from its least: from what the dual problem, of which push is a solution,
    // is worth.
    double gap() const
    {
        double squares = 0.0;
        for (const point& r : residual_)
            squares += r.x_mm * r.x_mm + r.y_mm * r.y_mm;
        return sum_of_products() + squares / 2.0;
    }

    // A sum_e out_e v_e.
    template <class Value>
    std::vector<point> from_sides(Value&& v) const
    {
        std::vector<point> sum(x_.size());
        for (std::size_t i = 0, k = 0; i < sum.size(); ++i)
            for (const beyond& e : sides_) {
                const double u = v(k++);
                sum[i] = {sum[i].x_mm + u * e.out.x_mm, sum[i].y_mm + u * e.out.y_mm};
            }
        return pushed(give_, sum);
    }

    void find_residual()
    {
        residual_ = from_sides([&](std::size_t k) { return push_[k]; });
        for (std::size_t i = 0; i < x_.size(); ++i)
            residual_[i] = {residual_[i].x_mm + y_[i].x_mm - x_[i].x_mm,
                            residual_[i].y_mm + y_[i].y_mm - x_[i].y_mm};
    }

    // The three elements of A in row l, from column l - 1.
    std::array<double, 3> row_of(std::size_t l) const
    {
        const double before = l > 0 ? 1.0 / give_[l - 1] : 0.0;
        const double after = l < give_.size() ? 1.0 / give_[l] : 0.0;
        return {-before, 1.0 + before + after, -after};
    }

    // I + A D A, D having blocks sum_e (push / slack) out out'.
    bool build()
    {
        const std::size_t n = x_.size();
        matrix_.clear();
        for (std::size_t r = 0; r < 2 * n; ++r)
            matrix_.at(r, r) = 1.0;
        for (std::size_t l = 0, k = 0; l < n; ++l) {
            double xx = 0.0;
            double xy = 0.0;
            double yy = 0.0;
            for (const beyond& e : sides_) {
                const double w = push_[k] / slack_[k];
                ++k;
                xx += w * e.out.x_mm * e.out.x_mm;
                xy += w * e.out.x_mm * e.out.y_mm;
                yy += w * e.out.y_mm * e.out.y_mm;
            }
            const std::array<double, 3> a = row_of(l);
            const std::size_t from = l > 0 ? 0 : 1;
            const std::size_t to = l + 1 < n ? 3 : 2;
            for (std::size_t i = from; i < to; ++i)
                for (std::size_t j = from; j <= i; ++j) {
                    const double f = a[i] * a[j];
                    const std::size_t r = 2 * (l + i - 1);
                    const std::size_t c = 2 * (l + j - 1);
                    matrix_.at(r, c) += f * xx;
                    matrix_.at(r + 1, c) += f * xy;
                    matrix_.at(r + 1, c + 1) += f * yy;
                    if (c < r)
                        matrix_.at(r, c + 1) += f * xy;
                }
        }
        return matrix_.factor();
    }

    // Steps of y, slack and push for products slack * push that change by what `wanted` says.
    template <class Wanted>
    void aim(Wanted&& wanted)
    {
        const std::vector<point> force = from_sides([&](std::size_t k) { return wanted(k) / slack_[k]; });
        for (std::size_t i = 0; i < x_.size(); ++i) {
            rhs_[2 * i] = -residual_[i].x_mm - force[i].x_mm;
            rhs_[2 * i + 1] = -residual_[i].y_mm - force[i].y_mm;
        }
        matrix_.solve(rhs_);
        way_.resize(x_.size());
        for (std::size_t i = 0; i < x_.size(); ++i)
            way_[i] = {rhs_[2 * i], rhs_[2 * i + 1]};
        const std::vector<point> moved = pushed(give_, way_);
        for (std::size_t i = 0, k = 0; i < x_.size(); ++i)
            for (const beyond& e : sides_) {
                const double goal = wanted(k); // before the steps that it looks at change
                slack_step_[k] = -dot(e.out, moved[i]);
                push_step_[k] = (goal - push_[k] * slack_step_[k]) / slack_[k];
                ++k;
            }
    }

    double longest_step() const
    {
        double most = 1.0;
        for (std::size_t k = 0; k < slack_.size(); ++k) {
            if (slack_step_[k] < 0.0)
                most = std::min(most, -slack_[k] / slack_step_[k]);
            if (push_step_[k] < 0.0)
                most = std::min(most, -push_[k] / push_step_[k]);
        }
        return most;
    }

    bool step()
    {
        if (!build())
            return false;
        const double count = static_cast<double>(slack_.size());
        const double mean = sum_of_products() / count;
        aim([&](std::size_t k) { return -slack_[k] * push_[k]; });
        const double straight = longest_step();
        double after = 0.0;
        for (std::size_t k = 0; k < slack_.size(); ++k)
            after += (slack_[k] + straight * slack_step_[k]) * (push_[k] + straight * push_step_[k]);
        const double centring = std::pow(after / count / mean, 3.0) * mean;
        aim([&](std::size_t k) { return -slack_[k] * push_[k] - slack_step_[k] * push_step_[k] + centring; });
        const double length = std::min(1.0, nearly * longest_step());
        for (std::size_t i = 0; i < y_.size(); ++i)
            y_[i] = {y_[i].x_mm + length * way_[i].x_mm, y_[i].y_mm + length * way_[i].y_mm};
        for (std::size_t k = 0; k < slack_.size(); ++k) {
            slack_[k] += length * slack_step_[k];
            push_[k] += length * push_step_[k];
        }
        return length > 1e-12;
    }

    std::span<const double> give_;
    std::vector<point> x_;
    std::vector<beyond> sides_;
    std::vector<point> y_;
    std::vector<point> best_;
    std::vector<double> slack_; // by tap, then by side
    std::vector<double> push_;
    std::vector<double> slack_step_;
    std::vector<double> push_step_;
    std::vector<double> rhs_;
    band matrix_;
    std::vector<point> residual_;
    std::vector<point> way_;
};

} // namespace

std::vector<point> fit_inside(std::span<const double> give, std::span<const point> targets,
                              const std::vector<beyond>& sides, point inside)
{
    if (targets.size() > most_fit_constraints / sides.size())
        throw error(error_kind::bad_input, "compensation",
                    fmt::format("{} bursts on an array whose edge has {} sides are too many", targets.size(),
                                sides.size()),
                    fmt::format("at most {} times {}; make the stroke shorter",
                                most_fit_constraints / sides.size(), sides.size()));
    // About `inside`, in units of the array's size.
    std::vector<beyond> around = sides;
    double size = 0.0;
    for (beyond& e : around) {
        e.reach -= dot(e.out, inside);
        size = std::max(size, e.reach);
    }
    for (beyond& e : around)
        e.reach /= size;
    std::vector<point> x(targets.begin(), targets.end());
    for (point& p : x)
        p = {(p.x_mm - inside.x_mm) / size, (p.y_mm - inside.y_mm) / size};
    inner_search search(give, std::move(x), std::move(around));
    if (!search.run())
        throw error(error_kind::bad_input, "compensation",
                    "the observer pulls bursts together too strongly for an answer to be found",
                    "a smaller sigma_mm, a larger sigma_v_mm_s or a longer SOA");
    std::vector<point> m = pushed(give, search.felt());
    for (point& p : m)
        p = {inside.x_mm + size * p.x_mm, inside.y_mm + size * p.y_mm};
    return m;
}

} // namespace tactor::detail
