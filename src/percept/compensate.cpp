// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>

#include "core/access.hpp"
#include "core/path/shape.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "percept/observer.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/job.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::operator+;
using detail::operator-;
using detail::operator*;

constexpr double on_edge_mm = 1e-6;
// Least give: below it, sixteen digits do not distinguish a place from its neighbours'.
constexpr double least_give = 1e-7;
constexpr std::size_t most_taps = 1'000'000;

/// A symmetric positive definite matrix whose elements beyond two from the diagonal are 0, as its Cholesky
/// factor: in row r the elements in columns r, r - 1 and r - 2.
class chain_factor {
public:
    /// Factors I + weight A A, where A = I + K is the chain's matrix (observer.hpp).
    chain_factor(std::span<const double> give, double weight) : rows_(give.size() + 1)
    {
        const auto link = [&](std::size_t i) { return i < give.size() ? 1.0 / give[i] : 0.0; };
        double before = 0.0; // of A: the elements beside and on the diagonal in the row before
        double on_before = 0.0;
        for (std::size_t r = 0; r < rows_.size(); ++r) {
            const double after = link(r);
            const double on = 1.0 + before + after;
            row& l = rows_[r];
            if (r > 1)
                l[2] = weight * before * link(r - 2) / rows_[r - 2][0];
            if (r > 0)
                l[1] = (-weight * before * (on_before + on) - l[2] * rows_[r - 1][1]) / rows_[r - 1][0];
            l[0] = std::sqrt(1.0 + weight * (before * before + on * on + after * after) - l[1] * l[1] -
                             l[2] * l[2]);
            before = after;
            on_before = on;
        }
    }

    /// Replaces b by the solution.
    void solve(std::vector<point>& b) const
    {
        const std::size_t n = rows_.size();
        for (std::size_t r = 0; r < n; ++r) {
            if (r > 0)
                b[r] = b[r] - rows_[r][1] * b[r - 1];
            if (r > 1)
                b[r] = b[r] - rows_[r][2] * b[r - 2];
            b[r] = {b[r].x_mm / rows_[r][0], b[r].y_mm / rows_[r][0]};
        }
        for (std::size_t r = n; r-- > 0;) {
            if (r + 1 < n)
                b[r] = b[r] - rows_[r + 1][1] * b[r + 1];
            if (r + 2 < n)
                b[r] = b[r] - rows_[r + 2][2] * b[r + 2];
            b[r] = {b[r].x_mm / rows_[r][0], b[r].y_mm / rows_[r][0]};
        }
    }

private:
    using row = std::array<double, 3>;

    std::vector<row> rows_;
};

double squares(std::span<const point> a, std::span<const point> b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::pow(distance_mm(a[i], b[i]), 2.0);
    return sum;
}

// Returns the places on the array at which taps must be played to be felt as near to their targets as it
// allows: with m the places played and y the places felt, m = A y, it minimises |y - targets|^2. By the
// alternating direction method of multipliers (Boyd et al. 2011): y fits targets and what is allowed, z is
// the nearest place on the array, u sums up by how much the two differ. The weight of u changes where one of
// both lags behind. Each step is O(n); the best z counts.
std::vector<point> fit_on_array(const layout& l, std::span<const double> give, std::span<const point> targets)
{
    constexpr int look = 10; // steps
    constexpr int weigh = 50;
    constexpr int last_weighing = 1000;
    constexpr double most_work = 1e7; // steps of a tap
    constexpr double relaxation = 1.6;
    constexpr double small = 1e-12; // change of the cost between two looks, of the cost
    constexpr double apart = 1e-9;  // RMS of m - z, of the array's size
    const std::size_t n = targets.size();
    const auto [first, last] = detail::find_ends(l.places());
    const double apart_mm = apart * distance_mm(first, last);
    if (apart_mm == 0.0)
        return std::vector<point>(n, first);
    double weight = 1.0;
    for (const double g : give)
        weight = std::min(weight, 1.0 / (1.0 + 4.0 / g));
    chain_factor factor(give, weight);
    std::vector<point> z = detail::pushed(give, targets);
    std::transform(z.begin(), z.end(), z.begin(), [&](point p) { return l.nearest(p); });
    std::vector<point> u(n);
    std::vector<point> difference(n);
    std::vector<point> best = z;
    double best_cost = squares(detail::pulled(give, z), targets);
    double cost = best_cost;
    const int most_steps = static_cast<int>(std::clamp(most_work / static_cast<double>(n), 50.0, 5000.0));
    int calm = 0;
    for (int step = 1; step <= most_steps && calm < 2; ++step) {
        std::transform(z.begin(), z.end(), u.begin(), difference.begin(),
                       [](point p, point q) { return p - q; });
        std::vector<point> y = detail::pushed(give, difference);
        std::transform(targets.begin(), targets.end(), y.begin(), y.begin(),
                       [&](point t, point p) { return t + weight * p; });
        factor.solve(y);
        const std::vector<point> m = detail::pushed(give, y);
        double moved = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const point wanted = z[i] + relaxation * m[i] - relaxation * z[i] + u[i];
            const point nearest = l.nearest(wanted);
            moved += std::pow(distance_mm(nearest, z[i]), 2.0);
            u[i] = wanted - nearest;
            z[i] = nearest;
        }
        const double off = squares(m, z);
        if (step % look == 0) {
            const double now = squares(detail::pulled(give, z), targets);
            const bool still =
                std::abs(now - cost) <= small * now && off <= apart_mm * apart_mm * static_cast<double>(n);
            calm = still ? calm + 1 : 0;
            cost = now;
            if (now < best_cost) {
                best_cost = now;
                best = z;
            }
        }
        const double factor_of_weight = off > 100.0 * moved ? 2.0 : moved > 100.0 * off ? 0.5 : 1.0;
        if (step % weigh == 0 && step < last_weighing && factor_of_weight != 1.0) {
            weight *= factor_of_weight;
            std::transform(u.begin(), u.end(), u.begin(),
                           [&](point p) { return 1.0 / factor_of_weight * p; });
            factor = chain_factor(give, weight);
        }
    }
    return best;
}

std::size_t count_on_edge(const layout::impl& l, std::span<const point> taps)
{
    const std::vector<detail::hull_side> sides =
        l.hull.empty() ? std::vector<detail::hull_side>() : detail::hull_sides(l);
    const auto ends = detail::find_ends(l.points);
    return static_cast<std::size_t>(std::count_if(taps.begin(), taps.end(), [&](point p) {
        const bool at_end = std::min(distance_mm(p, ends.first), distance_mm(p, ends.second)) < on_edge_mm;
        return sides.empty() ? at_end
                             : std::any_of(sides.begin(), sides.end(), [p](const detail::hull_side& e) {
                                   return detail::dot(e.out, p) > e.reach - on_edge_mm;
                               });
    }));
}

// Returns the notice that every command prints about a compensated plan.
std::string notice(const compensated_plan& p)
{
    if (p.taps.empty())
        return fmt::format("no burst sounds that could be moved for {}", describe(p.observer));
    const tap_summary felt = summarise(p.taps);
    std::string text = fmt::format("bursts are moved for {}; it is predicted to feel them {:.3f} mm RMS and "
                                   "at most {:.3f} mm from the target",
                                   describe(p.observer), felt.rms_error_mm.value_or(0.0),
                                   felt.largest_error_mm.value_or(0.0));
    if (p.at_edge != 0)
        text += fmt::format(
            "; {} of {} cannot be moved far enough on this array, which alone leaves {:.3f} mm RMS "
            "and at most {:.3f} mm",
            p.at_edge, counted(p.taps.size(), "burst"), p.residual_rms_mm, p.residual_largest_mm);
    if (p.plan.algorithm == to_string(algorithm_kind::tactile_brush))
        text += "; off the lines of the grid they are no longer the Tactile Brush's";
    return text;
}

// Returns the plan's warning about bursts outside the triangle of their three tactors; empty if there is
// none.
std::string missed_warning(const layout& l, const plan& p)
{
    detail::missed_places missed;
    if (p.faces == faces_kind::nearest)
        for (const burst& b : p.bursts)
            missed.add(l, b);
    return missed.warning("burst");
}

} // namespace

compensated_places compensate(const layout& l, const low_speed_observer& o, std::span<const double> onsets_s,
                              std::span<const point> targets)
{
    compensated_places r;
    static_cast<void>(felt_places(o, onsets_s, targets)); // checks the arguments
    const std::vector<double> give = detail::link_give(o, onsets_s);
    if (std::any_of(give.begin(), give.end(), [](double g) { return g < least_give; }))
        throw error(error_kind::bad_input, "compensation",
                    "bursts that begin together, or nearly so for this observer, cannot be felt apart",
                    "a smaller {sigma_mm}, a larger {sigma_v_mm_s} or a longer SOA")
            .with_field("compensate");
    r.played = detail::pushed(give, targets);
    if (!std::all_of(r.played.begin(), r.played.end(), [&](point p) { return l.contains(p); })) {
        if (targets.size() > most_taps)
            throw error(error_kind::bad_input, "compensation",
                        fmt::format("{} bursts are too many", targets.size()),
                        fmt::format("at most {}; make the stroke shorter", most_taps))
                .with_field("compensate");
        r.played = fit_on_array(l, give, targets);
        r.at_edge = count_on_edge(detail::access::of(l), r.played);
    }
    r.felt = detail::pulled(give, r.played);
    return r;
}

compensated_plan make_compensated_plan(const array& a, const layout& l, const stroke& s,
                                       const plan_options& o, const low_speed_observer& m)
{
    if (s.fit)
        return make_compensated_plan(a, l, apply_fits({s}, l).front(), o, m);
    const plan_options own = detail::apply_choices(o, s.choices);
    if (own.algorithm == algorithm_kind::continuous)
        throw detail::bad_field("algorithm",
                                "continuous has no bursts that could be moved for the low-speed observer",
                                "{algorithm=park2016}, or no compensation");
    compensated_plan r;
    r.plan = make_plan(a, l, s, o);
    r.observer = m;
    std::vector<burst*> felt;
    std::vector<double> onsets_s;
    std::vector<point> targets;
    for (burst& b : r.plan.bursts)
        if (detail::find_centre(a, b)) {
            felt.push_back(&b);
            onsets_s.push_back(b.onset_s);
            targets.push_back(s.motion.position(b.onset_s));
        }
    const compensated_places places = compensate(l, m, onsets_s, targets);
    std::erase(r.plan.warnings, missed_warning(l, r.plan)); // counted again for the moved bursts
    const std::shared_ptr<const phantom_model> model = detail::choose_model(l, own);
    for (std::size_t i = 0; i < felt.size(); ++i) {
        burst& b = *felt[i];
        b.position = places.played[i];
        detail::drives_at(*model, l, b.position, b.intensity, b.drives);
    }
    if (std::string text = missed_warning(l, r.plan); !text.empty())
        r.plan.warnings.push_back(std::move(text));
    r.plan.conflicts = detail::find_conflicts(r.plan.bursts);
    r.taps = predict_taps(a, s, r.plan, m);
    r.at_edge = places.at_edge;
    double squares = 0.0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const double e = distance_mm(places.felt[i], targets[i]);
        squares += e * e;
        r.residual_largest_mm = std::max(r.residual_largest_mm, e);
    }
    if (!targets.empty())
        r.residual_rms_mm = std::sqrt(squares / static_cast<double>(targets.size()));
    r.plan.warnings.push_back(notice(r));
    return r;
}

} // namespace v0
} // namespace tactor
