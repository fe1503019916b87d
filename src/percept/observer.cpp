// SPDX-License-Identifier: MIT
#include "percept/observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>

#include "core/access.hpp"
#include "core/path/shape.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/plane.hpp"
#include "plan/job.hpp"

namespace tactor::detail {
namespace {

// Give (1 / weight) of a link that does not pull. Infinity would lead to infinity / infinity.
constexpr double freest = 1e30;

void check(const char* what, double v, double least, double most)
{
    if (!(v >= least && v <= most))
        throw bad_field(what, fmt::format("{} is out of range", v),
                        fmt::format("give {} to {}", plain_number(least), plain_number(most)));
}

void check_count(const array& a, const char* what, std::size_t n)
{
    if (n != 0 && n != a.tactors.size())
        throw bad_field(what,
                        fmt::format("there are {} values for {}", n, counted(a.tactors.size(), "tactor")),
                        "give one value for each tactor, or none");
}

// The low-speed observer pulls taps together like a chain: (I + K) x = m. Here m are the places of the taps
// alone, x are the places where they are felt, and K is the Laplacian of a chain whose link i has the weight
// k_i = (sigma / (sigma_v (t_(i+1) - t_i)))^2.

// Returns the give 1 / k of each link. It is 0 if two taps begin together.
// \throws error (bad_input) as felt_places() does.
std::vector<double> link_give(const low_speed_observer& o, std::span<const double> onsets_s)
{
    check("sigma_mm", o.sigma_mm, least_sigma_mm, most_sigma_mm);
    check("sigma_v_mm_s", o.sigma_v_mm_s, least_sigma_v_mm_s, most_sigma_v_mm_s);
    std::vector<double> give;
    give.reserve(onsets_s.size());
    for (std::size_t i = 0; i < onsets_s.size(); ++i) {
        if (!std::isfinite(onsets_s[i]) || (i > 0 && onsets_s[i] < onsets_s[i - 1]))
            throw bad_field(
                "onsets_s",
                fmt::format("onset {}, {} s, is before the previous one, or not a time", i + 1, onsets_s[i]),
                "give onsets in ascending order");
        if (i > 0) {
            const double way = o.sigma_v_mm_s * (onsets_s[i] - onsets_s[i - 1]) / o.sigma_mm;
            give.push_back(std::min(way * way, freest));
        }
    }
    return give;
}

// Solves (I + K) x = m by the Thomas algorithm, in O(n). Pivot i is k_i + q_i. Computes k / (k + q) as
// 1 / (1 + q / k), so that only positive numbers are added and nothing cancels, even for strong links. A
// rigid link has give 0.
std::vector<point> solve_link_matrix(std::span<const double> give, std::span<const point> alone)
{
    std::vector<point> x(alone.begin(), alone.end());
    const std::size_t n = x.size();
    if (n == 0)
        return x;
    std::vector<double> q(n, 1.0);
    for (std::size_t i = 1; i < n; ++i) {
        const double part = 1.0 / (1.0 + q[i - 1] * give[i - 1]);
        q[i] += q[i - 1] * part;
        x[i].x_mm += x[i - 1].x_mm * part;
        x[i].y_mm += x[i - 1].y_mm * part;
    }
    x[n - 1] = {x[n - 1].x_mm / q[n - 1], x[n - 1].y_mm / q[n - 1]};
    for (std::size_t i = n - 1; i-- > 0;) {
        const double pivot = 1.0 + q[i] * give[i];
        x[i] = {(x[i].x_mm * give[i] + x[i + 1].x_mm) / pivot, (x[i].y_mm * give[i] + x[i + 1].y_mm) / pivot};
    }
    return x;
}

// Returns (I + K) x. No `give` may be 0.
std::vector<point> apply_link_matrix(std::span<const double> give, std::span<const point> felt)
{
    std::vector<point> m(felt.begin(), felt.end());
    for (std::size_t i = 0; i + 1 < felt.size(); ++i) {
        const point pull{(felt[i + 1].x_mm - felt[i].x_mm) / give[i],
                         (felt[i + 1].y_mm - felt[i].y_mm) / give[i]};
        m[i] = m[i] - pull;
        m[i + 1] = m[i + 1] + pull;
    }
    return m;
}

// Returns the centre of energy of a burst's drives, or nothing for a silent burst. `gains`: factor on the
// amplitude of each tactor; empty if all are 1.
// \throws error (bad_input) for a tactor that the array does not have.
std::optional<point> find_centre(const array& a, const burst& b, std::span<const double> gains = {})
{
    double energy = 0.0;
    point moment;
    for (const drive& d : b.drives) {
        if (d.tactor >= a.tactors.size())
            refuse_tactor(a, d.tactor);
        const point& at = a.tactors[d.tactor].position;
        const double felt = d.amplitude * (gains.empty() ? 1.0 : gains[d.tactor]);
        const double e = felt * felt;
        energy += e;
        moment = moment + e * at;
    }
    if (!(energy > 0.0))
        return {};
    return point{moment.x_mm / energy, moment.y_mm / energy};
}

} // namespace

void refuse_tactor(const array& a, unsigned tactor)
{
    throw error(error_kind::bad_input, "plan", fmt::format("it drives tactor {}", tactor),
                fmt::format("\"{}\" has {}", a.name, counted(a.tactors.size(), "tactor")));
}

array felt_array(const array& a, const person& who)
{
    check_count(a, "shift", who.shift.size());
    array felt = a;
    for (std::size_t i = 0; i < who.shift.size(); ++i) {
        point& p = felt.tactors[i].position;
        p = p + who.shift[i];
        if (!finite(p))
            throw bad_field("shift", fmt::format("the shift of tactor {} is not finite", i));
    }
    return felt;
}

std::vector<double> person_gains(const array& a, const person& who)
{
    check_count(a, "sensitivity_db", who.sensitivity_db.size());
    std::vector<double> gains;
    for (const double db : who.sensitivity_db) {
        gains.push_back(std::pow(10.0, db / 20.0));
        if (!(gains.back() > 0.0 && std::isfinite(gains.back())))
            throw bad_field("sensitivity_db", fmt::format("{} dB is not a threshold", db));
    }
    return gains;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<point> felt_places(const low_speed_observer& o, std::span<const double> onsets_s,
                               std::span<const point> alone)
{
    const std::vector<double> give = detail::link_give(o, onsets_s);
    if (onsets_s.size() != alone.size())
        throw detail::bad_field(
            "onsets_s", fmt::format("there are {} onsets, but {} places", onsets_s.size(), alone.size()),
            "give one onset for each place");
    for (const point& p : alone)
        if (!detail::finite(p))
            throw error(error_kind::bad_input, "place of a tap", "it is not finite");
    return detail::solve_link_matrix(give, alone);
}

std::string describe(const low_speed_observer& o)
{
    return fmt::format("the low-speed observer (Goldreich 2007) with sigma {} mm and sigma_v {} mm/s, built "
                       "for taps on the forearm; nobody has fitted it to a palm or to bursts that touch",
                       plain_number(o.sigma_mm), plain_number(o.sigma_v_mm_s));
}

std::vector<tap> predict_taps(const array& a, const stroke& s, const plan& p, const low_speed_observer& o,
                              const person& who)
{
    if (p.curve)
        throw error(error_kind::bad_input, "plan",
                    "it is continuous, and the low-speed observer predicts taps only",
                    "use an algorithm with bursts");
    const array felt_at = detail::felt_array(a, who);
    const std::vector<double> gains = detail::person_gains(a, who);
    std::vector<tap> taps;
    std::vector<double> onsets_s;
    std::vector<point> alone;
    taps.reserve(p.bursts.size());
    for (const burst& b : p.bursts) {
        const std::optional<point> centre = detail::find_centre(felt_at, b, gains);
        if (!centre)
            continue;
        taps.push_back({b.onset_s, s.motion.position(b.onset_s), *centre});
        onsets_s.push_back(b.onset_s);
        alone.push_back(*centre);
    }
    const std::vector<point> felt = felt_places(o, onsets_s, alone);
    for (std::size_t i = 0; i < taps.size(); ++i)
        taps[i].felt = felt[i];
    return taps;
}

tap_summary summarise(const std::vector<tap>& taps)
{
    tap_summary r;
    double squares = 0.0;
    for (std::size_t i = 0; i < taps.size(); ++i) {
        const double error = distance_mm(taps[i].felt, taps[i].target);
        squares += error * error;
        r.largest_error_mm = std::max(r.largest_error_mm.value_or(0.0), error);
        if (i == 0)
            continue;
        r.felt_length_mm += distance_mm(taps[i].felt, taps[i - 1].felt);
        r.target_length_mm += distance_mm(taps[i].target, taps[i - 1].target);
    }
    if (!taps.empty())
        r.rms_error_mm = std::sqrt(squares / static_cast<double>(taps.size()));
    if (r.target_length_mm > 0.0)
        r.length_ratio = r.felt_length_mm / r.target_length_mm;
    return r;
}

namespace {

using detail::operator+;
using detail::operator-;
using detail::operator*;

constexpr double on_edge_mm = 1e-6;
// Least give. Below it, a double cannot distinguish the places of neighbouring taps.
constexpr double least_give = 1e-7;
constexpr std::size_t most_taps = 1'000'000;

/// Cholesky factor of a symmetric positive definite matrix with bandwidth 2. Row r has the elements in
/// columns r, r - 1 and r - 2.
class chain_factor {
public:
    /// Factors I + weight A A, where A = I + K is the matrix of the chain.
    chain_factor(std::span<const double> give, double weight) : rows_(give.size() + 1)
    {
        const auto link = [&](std::size_t i) { return i < give.size() ? 1.0 / give[i] : 0.0; };
        double before = 0.0; // elements of A in the previous row, beside and on the diagonal
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

double sum_squared_distances(std::span<const point> a, std::span<const point> b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::pow(distance_mm(a[i], b[i]), 2.0);
    return sum;
}

// Returns the places on the array at which taps must be played, so that they are felt as near to the targets
// as the array allows. Minimises |y - targets|^2, where y are the places felt, and m = A y the places played.
// Uses the alternating direction method of multipliers (Boyd et al. 2011): y is a compromise between the
// targets and z, z are the points of the array nearest to m, and u sums up the differences of m and z. Adapts
// the weight of these differences if one residual is much larger than the other. Each step is O(n). Returns
// the best z.
std::vector<point> fit_on_array(const layout& l, std::span<const double> give, std::span<const point> targets)
{
    constexpr int look = 10; // steps between two looks at the cost
    constexpr int weigh = 50;
    constexpr int last_weighing = 1000;
    constexpr double most_work = 1e7; // number of steps times number of taps
    constexpr double relaxation = 1.6;
    constexpr double small = 1e-12; // relative change of the cost between two looks
    constexpr double apart = 1e-9;  // converged: RMS of m - z, relative to the array's size
    const std::size_t n = targets.size();
    const auto [first, last] = detail::find_ends(l.places());
    const double apart_mm = apart * distance_mm(first, last);
    if (apart_mm == 0.0)
        return std::vector<point>(n, first);
    double weight = 1.0;
    for (const double g : give)
        weight = std::min(weight, 1.0 / (1.0 + 4.0 / g));
    chain_factor factor(give, weight);
    std::vector<point> z = detail::apply_link_matrix(give, targets);
    std::transform(z.begin(), z.end(), z.begin(), [&](point p) { return l.nearest(p); });
    std::vector<point> u(n);
    std::vector<point> difference(n);
    std::vector<point> best = z;
    double best_cost = sum_squared_distances(detail::solve_link_matrix(give, z), targets);
    double cost = best_cost;
    const int most_steps = static_cast<int>(std::clamp(most_work / static_cast<double>(n), 50.0, 5000.0));
    int calm = 0;
    for (int step = 1; step <= most_steps && calm < 2; ++step) {
        std::transform(z.begin(), z.end(), u.begin(), difference.begin(),
                       [](point p, point q) { return p - q; });
        std::vector<point> y = detail::apply_link_matrix(give, difference);
        std::transform(targets.begin(), targets.end(), y.begin(), y.begin(),
                       [&](point t, point p) { return t + weight * p; });
        factor.solve(y);
        const std::vector<point> m = detail::apply_link_matrix(give, y);
        double moved = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const point wanted = z[i] + relaxation * m[i] - relaxation * z[i] + u[i];
            const point nearest = l.nearest(wanted);
            moved += std::pow(distance_mm(nearest, z[i]), 2.0);
            u[i] = wanted - nearest;
            z[i] = nearest;
        }
        const double off = sum_squared_distances(m, z);
        if (step % look == 0) {
            const double now = sum_squared_distances(detail::solve_link_matrix(give, z), targets);
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

std::size_t count_edge_taps(const layout::impl& l, std::span<const point> taps)
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
std::string compensation_notice(const compensated_plan& p)
{
    if (p.taps.empty())
        return fmt::format("there is no audible burst to move for {}", describe(p.observer));
    const tap_summary felt = summarise(p.taps);
    std::string text = fmt::format("bursts are moved for {}, which is predicted to feel them {:.3f} mm RMS "
                                   "and at most {:.3f} mm from the target",
                                   describe(p.observer), felt.rms_error_mm.value_or(0.0),
                                   felt.largest_error_mm.value_or(0.0));
    if (p.at_edge != 0)
        text +=
            fmt::format("; {} of {} cannot be moved far enough on this array, which alone leaves {:.3f} mm "
                        "RMS and at most {:.3f} mm; other places may be as good",
                        p.at_edge, counted(p.taps.size(), "burst"), p.residual_rms_mm, p.residual_largest_mm);
    if (p.plan.algorithm == to_string(algorithm_kind::tactile_brush))
        text += "; off the lines of the grid they are no longer the Tactile Brush's";
    return text;
}

// Returns the plan's warning about bursts outside the triangle of their three tactors. Empty if there are no
// such bursts.
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
        throw error(
            error_kind::bad_input, "compensation",
            "this observer cannot feel bursts at different places if they begin at nearly the same time",
            "use a smaller {sigma_mm}, a larger {sigma_v_mm_s} or a longer SOA")
            .with_field("compensate");
    r.played = detail::apply_link_matrix(give, targets);
    if (!std::all_of(r.played.begin(), r.played.end(), [&](point p) { return l.contains(p); })) {
        if (targets.size() > most_taps)
            throw error(error_kind::bad_input, "compensation",
                        fmt::format("{} bursts are too many", targets.size()),
                        fmt::format("use at most {}: make the stroke shorter", most_taps))
                .with_field("compensate");
        r.played = fit_on_array(l, give, targets);
        r.at_edge = count_edge_taps(detail::access::of(l), r.played);
    }
    r.felt = detail::solve_link_matrix(give, r.played);
    return r;
}

compensated_plan make_compensated_plan(const array& a, const layout& l, const stroke& s,
                                       const plan_options& o, const low_speed_observer& m)
{
    if (s.fit)
        return make_compensated_plan(a, l, apply_fits({s}, l).front(), o, m);
    const plan_options own = detail::apply_choices(o, s.choices);
    if (own.algorithm == algorithm_kind::continuous)
        throw detail::bad_field("algorithm", "continuous has no bursts to move for the low-speed observer",
                                "use {algorithm=park2016}, or no compensation");
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
        detail::compute_drives(*model, l, b.position, b.intensity, b.drives);
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
    r.plan.warnings.push_back(compensation_notice(r));
    return r;
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

compensated_plan plan_for_observer(const array& a, const layout& l, const stroke& s, const plan_options& o,
                                   const low_speed_observer* observer)
{
    return observer == nullptr ? compensated_plan{.plan = make_plan(a, l, s, o)}
                               : make_compensated_plan(a, l, s, o, *observer);
}

} // namespace tactor::detail
