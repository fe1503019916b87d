// SPDX-License-Identifier: MIT
#include "percept/hull_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "percept/low_speed.hpp"

namespace tactor::detail {
namespace {

constexpr int most_steps = 200;
constexpr double small_gap = 1e-16;    // for each tap; ends the search, in units of the array's size squared
constexpr double bearable_gap = 1e-10; // for each tap, if rounding ends the search before
constexpr double nearly = 0.995;       // part of the distance to the next side

/// Search for the best places. With m the places played, y the places felt, m = A y and A = I + K: minimise
/// |y - x|^2 / 2 while each m_i keeps each side. Slack are the distances from the sides, push the forces of
/// the sides; m is inside from the first step on.
///
/// Newton's step is solved for the force f on each tap: (D^-1 + A A) f = D^-1 c - A r. Solved for y instead,
/// I + A D A would have to keep its 1 next to the weights of the sides that are reached, which grow without
/// bound. Forces and steps of a tap are in its own frame.
class inner_search {
public:
    inner_search(std::span<const double> give, std::vector<point> x, std::vector<beyond> sides)
        : give_(give),
          x_(std::move(x)),
          sides_(std::move(sides)),
          m_(x_.size()),
          slack_(x_.size() * sides_.size()),
          push_(slack_.size()),
          slack_step_(slack_.size()),
          push_step_(slack_.size()),
          rhs_(2 * x_.size()),
          matrix_(2 * x_.size()),
          force_(x_.size()),
          way_(x_.size())
    {
        for (std::size_t k = 0; k < slack_.size(); ++k) {
            slack_[k] = sides_[k % sides_.size()].reach;
            push_[k] = 0.1 / slack_[k];
        }
    }

    /// Searches. Returns false if rounding ended it too early. The best places on the way count.
    bool run()
    {
        const double taps = static_cast<double>(x_.size());
        double best = std::numeric_limits<double>::infinity();
        for (int i = 0; i < most_steps && best > small_gap * taps; ++i) {
            find_residual();
            const double now = gap();
            if (now < best) {
                best = now;
                best_ = m_;
            }
            if (!(now < 1e3 * best) || !step())
                break;
        }
        return best <= bearable_gap * taps;
    }

    const std::vector<point>& played() const { return best_; }

private:
    double sum_of_products() const
    {
        double sum = 0.0;
        for (std::size_t k = 0; k < slack_.size(); ++k)
            sum += slack_[k] * push_[k];
        return sum;
    }

    // Returns a bound on how far |y - x|^2 / 2 is from its minimum: the value of the dual problem, of which
    // push is a solution, gives it.
    double gap() const
    {
        double squares = 0.0;
        for (const point& r : residual_)
            squares += r.x_mm * r.x_mm + r.y_mm * r.y_mm;
        return sum_of_products() + squares / 2.0;
    }

    // Computes y - x + A sum_e out_e push_e.
    void find_residual()
    {
        residual_.assign(x_.size(), {});
        for (std::size_t k = 0; k < push_.size(); ++k) {
            point& r = residual_[k / sides_.size()];
            const point& out = sides_[k % sides_.size()].out;
            r = {r.x_mm + push_[k] * out.x_mm, r.y_mm + push_[k] * out.y_mm};
        }
        residual_ = pushed(give_, residual_);
        const std::vector<point> y = pulled(give_, m_);
        for (std::size_t i = 0; i < x_.size(); ++i)
            residual_[i] = {residual_[i].x_mm + y[i].x_mm - x_[i].x_mm,
                            residual_[i].y_mm + y[i].y_mm - x_[i].y_mm};
    }

    // Returns the three elements of A in row l, from column l - 1.
    std::array<double, 3> matrix_row(std::size_t l) const
    {
        const double before = l > 0 ? 1.0 / give_[l - 1] : 0.0;
        const double after = l < give_.size() ? 1.0 / give_[l] : 0.0;
        return {-before, 1.0 + before + after, -after};
    }

    // Builds D^-1 + A A, where D has the blocks sum_e (push / slack) out out'.
    bool build()
    {
        const std::size_t sides = sides_.size();
        matrix_.clear();
        frames_.clear();
        for (std::size_t l = 0; l < x_.size(); ++l) {
            frames_.emplace_back(sides_,
                                 [&](std::size_t e) { return push_[l * sides + e] / slack_[l * sides + e]; });
            const std::array<double, 3> a = matrix_row(l);
            const std::array<double, 3>& d = frames_.back().inverse();
            const double here = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
            matrix_.at(2 * l, 2 * l) = here + d[0];
            matrix_.at(2 * l + 1, 2 * l) = d[1];
            matrix_.at(2 * l + 1, 2 * l + 1) = here + d[2];
            if (l > 0)
                link(l, l - 1, a[0] * (matrix_row(l - 1)[1] + a[1]));
            if (l > 1)
                link(l, l - 2, a[0] * matrix_row(l - 1)[0]);
        }
        return matrix_.factor();
    }

    // Sets the same element for both axes, between two frames.
    void link(std::size_t l, std::size_t earlier, double v)
    {
        const point turned = frames_[l].into(frames_[earlier].axis());
        matrix_.at(2 * l, 2 * earlier) = v * turned.x_mm;
        matrix_.at(2 * l + 1, 2 * earlier) = v * turned.y_mm;
        matrix_.at(2 * l, 2 * earlier + 1) = -v * turned.y_mm;
        matrix_.at(2 * l + 1, 2 * earlier + 1) = v * turned.x_mm;
    }

    // Computes steps of m, slack and push whose products slack * push change by `wanted`.
    template <class Wanted>
    void aim(Wanted&& wanted)
    {
        const std::size_t sides = sides_.size();
        const std::vector<point> off = pushed(give_, residual_);
        for (std::size_t i = 0; i < x_.size(); ++i) {
            point sum;
            for (std::size_t e = 0; e < sides; ++e) {
                const double v = wanted(i * sides + e) / slack_[i * sides + e];
                const point out = frames_[i].out(e);
                sum = {sum.x_mm + v * out.x_mm, sum.y_mm + v * out.y_mm};
            }
            force_[i] = sum;
            const point c = frames_[i].times_inverse(sum);
            const point r = frames_[i].into(off[i]);
            rhs_[2 * i] = c.x_mm - r.x_mm;
            rhs_[2 * i + 1] = c.y_mm - r.y_mm;
        }
        matrix_.solve(rhs_);
        for (std::size_t i = 0; i < x_.size(); ++i) {
            way_[i] =
                frames_[i].times_inverse({rhs_[2 * i] - force_[i].x_mm, rhs_[2 * i + 1] - force_[i].y_mm});
            for (std::size_t e = 0; e < sides; ++e) {
                const std::size_t k = i * sides + e;
                const double goal = wanted(k); // before the steps that it reads change
                slack_step_[k] = -dot(frames_[i].out(e), way_[i]);
                push_step_[k] = (goal - push_[k] * slack_step_[k]) / slack_[k];
            }
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
        for (std::size_t i = 0; i < m_.size(); ++i) {
            const point way = frames_[i].back(way_[i]);
            m_[i] = {m_[i].x_mm + length * way.x_mm, m_[i].y_mm + length * way.y_mm};
        }
        for (std::size_t k = 0; k < slack_.size(); ++k) {
            slack_[k] += length * slack_step_[k];
            push_[k] += length * push_step_[k];
        }
        return length > 1e-12;
    }

    std::span<const double> give_;
    std::vector<point> x_;
    std::vector<beyond> sides_;
    std::vector<point> m_;
    std::vector<point> best_;
    std::vector<double> slack_; // by tap, then by side
    std::vector<double> push_;
    std::vector<double> slack_step_;
    std::vector<double> push_step_;
    std::vector<double> rhs_;
    band matrix_;
    std::vector<tap_frame> frames_;
    std::vector<point> residual_;
    std::vector<point> force_;
    std::vector<point> way_; // step of m
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
                                most_fit_constraints / sides.size(), sides.size()))
            .with_field("compensate");
    // Centred on `inside`, in units of the array's size.
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
                    "a smaller {sigma_mm}, a larger {sigma_v_mm_s} or a longer SOA")
            .with_field("compensate");
    std::vector<point> m = search.played();
    for (point& p : m)
        p = {inside.x_mm + size * p.x_mm, inside.y_mm + size * p.y_mm};
    return m;
}

} // namespace tactor::detail
