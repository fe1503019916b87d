// SPDX-License-Identifier: MIT
#include "study/statistics/psychometric_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <boost/math/policies/policy.hpp>
#include <boost/math/special_functions/erf.hpp>

#include "study/random/random.hpp"

namespace tactor::study {
namespace {

// Policy that computes in double; tests.cpp has the reason.
using in_double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

struct sigmoid_value {
    double below; // S(z)
    double above; // 1 - S(z), precise even if S is near 1
    double slope; // dS / dz
    double bend;  // d2S / dz2
};

sigmoid_value evaluate(sigmoid kind, double z)
{
    if (kind == sigmoid::normal) {
        const double density = std::exp(-z * z / 2.0) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
        return {0.5 * std::erfc(-z / std::numbers::sqrt2), 0.5 * std::erfc(z / std::numbers::sqrt2), density,
                -z * density};
    }
    const double below = 1.0 / (1.0 + std::exp(-z));
    const double above = 1.0 / (1.0 + std::exp(z));
    return {below, above, below * above, below * above * (above - below)};
}

double normal_quantile(double share)
{
    return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * share, in_double());
}

// Parameters for stimuli that are scaled to -1 ... 1: z = a + b x.
struct point {
    double a;
    double b;
    double lapse;
};

// Log-likelihood without binomial coefficients, and its derivatives with respect to a, b and the lapse.
struct likelihood {
    double log = 0.0;
    std::array<double, 3> gradient = {};
    std::array<std::array<double, 3>, 3> information = {};

    double determinant() const // of the information about a and b
    {
        const auto& i = information;
        return i[0][0] * i[1][1] - i[0][1] * i[0][1];
    }
    bool is_singular() const
    {
        return !(information[0][0] > 0.0 && determinant() > 1e-12 * information[0][0] * information[1][1]);
    }
};

// Computes the log-likelihood with the observed information, or with the expected information if `expected`.
likelihood evaluate(const std::vector<answer_block>& blocks, const psychometric_family& f, const point& p,
                    bool expected = false)
{
    likelihood all;
    const double height = 1.0 - f.guess - p.lapse;
    for (const auto& [x, trials, answers] : blocks) {
        const sigmoid_value s = evaluate(f.kind, p.a + p.b * x);
        const double lapse_yes = f.lapses_to_yes * p.lapse;
        const double yes = std::max(f.guess + lapse_yes + height * s.below, 1e-150);
        const double no = std::max(p.lapse - lapse_yes + height * s.above, 1e-150);
        const auto n = static_cast<double>(trials);
        const auto k = static_cast<double>(answers);
        all.log += k * std::log(yes) + (n - k) * std::log(no);
        const double score = k / yes - (n - k) / no;
        const double weight = expected ? n / (yes * no) : k / (yes * yes) + (n - k) / (no * no);
        const double bent = expected ? 0.0 : score;
        const std::array<double, 3> by{height * s.slope, height * s.slope * x, f.lapses_to_yes - s.below};
        const double aa = height * s.bend;
        const std::array<std::array<double, 3>, 3> second{
            {{aa, aa * x, -s.slope}, {aa * x, aa * x * x, -s.slope * x}, {-s.slope, -s.slope * x, 0.0}}};
        for (std::size_t i = 0; i < 3; ++i) {
            all.gradient[i] += score * by[i];
            for (std::size_t j = 0; j < 3; ++j)
                all.information[i][j] += weight * by[i] * by[j] - bent * second[i][j];
        }
    }
    return all;
}

// Returns the step of Newton's method, or of Fisher's scoring if `expected`. The step keeps the lapse within
// its bounds. Returns nothing if the information matrix is not positive definite. With `expected`, the step
// does not change the lapse if the answers have no information about the lapse.
std::optional<point> find_ascent_step(const likelihood& l, double lapse, double most_lapse, bool expected)
{
    if (l.is_singular())
        return {};
    const auto& i = l.information;
    const auto solve = [&](double u, double v) {
        return std::array{(i[1][1] * u - i[0][1] * v) / l.determinant(),
                          (i[0][0] * v - i[0][1] * u) / l.determinant()};
    };
    const auto free = solve(l.gradient[0], l.gradient[1]);
    const auto by_lapse = solve(i[0][2], i[1][2]);
    const double rest = i[2][2] - i[0][2] * by_lapse[0] - i[1][2] * by_lapse[1];
    double moved = 0.0;
    if (rest > 1e-12 * i[2][2])
        moved = std::clamp((l.gradient[2] - i[0][2] * free[0] - i[1][2] * free[1]) / rest, -lapse,
                           most_lapse - lapse);
    else if (most_lapse > 0.0 && !expected)
        return {};
    return point{free[0] - by_lapse[0] * moved, free[1] - by_lapse[1] * moved, moved};
}

struct summit {
    point at;
    double log;
    bool step = false; // true if all steep slopes fit equally well
};

// Climbs to a maximum of the likelihood by Newton's method, or by Fisher's scoring if Newton's method has no
// step. Halves each step until the likelihood does not fall. Returns nothing if the share of answers does not
// rise with x.
std::optional<summit> climb(const std::vector<answer_block>& blocks, const psychometric_family& f, point p)
{
    likelihood here = evaluate(blocks, f, p);
    for (int i = 0; i < 200; ++i) {
        auto move = find_ascent_step(here, p.lapse, f.most_lapse, false);
        if (!move) {
            here = evaluate(blocks, f, p, true);
            move = find_ascent_step(here, p.lapse, f.most_lapse, true);
        }
        const auto& up = here.gradient;
        // The sum is the square of the step in standard errors.
        if (!move || up[0] * move->a + up[1] * move->b + up[2] * move->lapse < 1e-16) {
            // The slope is known if it is more than a thousandth of its standard error.
            const bool known = move && p.b * p.b * here.determinant() > 1e-6 * here.information[0][0];
            const bool step = !known && p.b > 1.0 && std::abs(p.a) < p.b;
            return p.b > 0.0 && (known || step) ? std::optional(summit{p, here.log, step}) : std::nullopt;
        }
        double part = 1.0;
        for (;; part /= 2.0) {
            const point next{p.a + part * move->a, p.b + part * move->b,
                             std::clamp(p.lapse + part * move->lapse, 0.0, f.most_lapse)};
            const likelihood there = evaluate(blocks, f, next);
            if (there.log >= here.log - 1e-13 * std::abs(here.log)) {
                p = next;
                here = there;
                break;
            }
            if (part < 1e-12)
                return {};
        }
    }
    return {};
}

// Climbs from each start and returns the highest maximum. With lapses and guesses there may be several
// maxima.
std::optional<summit> find_highest_maximum(const std::vector<answer_block>& blocks,
                                           const psychometric_family& f, const std::vector<point>& starts)
{
    std::optional<summit> best;
    for (const point& start : starts)
        if (const auto s = climb(blocks, f, start); s && (!best || s->log > best->log))
            best = s;
    return best;
}

// Blocks of answers whose stimuli are scaled to -1 ... 1.
struct scaled_blocks {
    explicit scaled_blocks(std::span<const answer_block> given) : all(given.begin(), given.end())
    {
        const auto [least, most] =
            std::ranges::minmax_element(given, std::less<>(), [](const answer_block& b) { return b.x; });
        middle = (least->x + most->x) / 2.0;
        half = (most->x - least->x) / 2.0;
        for (answer_block& block : all)
            block.x = (block.x - middle) / half;
    }
    std::vector<answer_block> all;
    double middle = 0.0;
    double half = 0.0;
};

// Returns the highest log-likelihood that any function can have.
double saturated_likelihood(const std::vector<answer_block>& blocks)
{
    double sum = 0.0;
    for (const answer_block& block : blocks)
        for (const std::size_t count : {block.k, block.n - block.k})
            if (count > 0)
                sum += static_cast<double>(count) *
                       std::log(static_cast<double>(count) / static_cast<double>(block.n));
    return sum;
}

psychometric_fit describe(const scaled_blocks& blocks, const summit& best)
{
    psychometric_fit fit;
    fit.parameters = {blocks.middle - blocks.half * best.at.a / best.at.b, blocks.half / best.at.b,
                      best.at.lapse};
    fit.step = best.step;
    fit.deviance = std::max(0.0, 2.0 * (saturated_likelihood(blocks.all) - best.log));
    return fit;
}

// Returns the 95 % percentile interval of values from `times` simulations, corrected for `bias` (Efron 1987).
// Returns nothing if more than 5 % of the simulations have no value.
std::optional<interval> percentile_interval(std::vector<double> values, std::size_t times, double bias = 0.0)
{
    const auto n = static_cast<double>(values.size());
    if (values.empty() || n < 0.95 * static_cast<double>(times))
        return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double z) {
        const double share = evaluate(sigmoid::normal, 2.0 * bias + z).below;
        const double place = std::clamp(share * (n + 1.0) - 1.0, 0.0, n - 1.0);
        const auto i = static_cast<std::size_t>(place);
        const double next = values[std::min(i + 1, values.size() - 1)];
        return values[i] + (place - static_cast<double>(i)) * (next - values[i]);
    };
    const double z = normal_quantile(0.975);
    return interval{at(-z), at(z)};
}

} // namespace

double chance(double x, const psychometric& p, const psychometric_family& f)
{
    return f.guess + f.lapses_to_yes * p.lapse +
           (1.0 - f.guess - p.lapse) * evaluate(f.kind, (x - p.threshold) / p.slope).below;
}

double find_quartile(sigmoid kind) noexcept
{
    return kind == sigmoid::normal ? normal_quartile : std::log(3.0);
}

std::optional<psychometric_fit> fit_psychometric(std::span<const answer_block> blocks,
                                                 const psychometric_family& f)
{
    if (blocks.empty())
        return {};
    const scaled_blocks scaled(blocks);
    if (!(scaled.half > 0.0))
        return {};
    std::vector<point> starts;
    for (const double lapse : {0.0, f.most_lapse / 2.0, f.most_lapse}) {
        std::optional<summit> best;
        for (double threshold = -1.0; threshold < 1.1; threshold += 0.2)
            for (double b = 0.5; b < static_cast<double>(blocks.size()); b *= 2.0) {
                const point p{-b * threshold, b, lapse};
                if (const double log = evaluate(scaled.all, f, p).log; !best || log > best->log)
                    best = summit{p, log};
            }
        starts.push_back(best->at);
    }
    const auto best = find_highest_maximum(scaled.all, f, starts);
    if (!best)
        return {};
    return describe(scaled, *best);
}

psychometric_bootstrap bootstrap_psychometric(std::span<const answer_block> blocks,
                                              const psychometric_family& f, const psychometric_fit& fit,
                                              std::string_view seed, std::size_t times)
{
    psychometric_bootstrap result;
    if (fit.step)
        return result;
    random_numbers r(seed);
    scaled_blocks scaled(blocks);
    const auto& [threshold, slope, found_lapse] = fit.parameters;
    std::vector<point> starts;
    for (const double lapse : {0.0, f.most_lapse / 2.0, f.most_lapse})
        starts.push_back({(scaled.middle - threshold) / slope, scaled.half / slope, lapse});
    std::vector<double> thresholds;
    std::vector<double> slopes;
    double as_large = 1.0;
    double less_slope = 0.5;
    for (std::size_t i = 0; i < times; ++i) {
        for (std::size_t j = 0; j < blocks.size(); ++j) {
            const double yes = chance(blocks[j].x, fit.parameters, f);
            scaled.all[j].k = 0;
            for (std::size_t trial = 0; trial < blocks[j].n; ++trial)
                scaled.all[j].k += r.unit() < yes ? 1 : 0;
        }
        const auto best = find_highest_maximum(scaled.all, f, starts);
        if (!best)
            continue;
        const psychometric_fit again = describe(scaled, *best);
        thresholds.push_back(again.parameters.threshold);
        slopes.push_back(again.parameters.slope);
        less_slope += again.parameters.slope < slope ? 1.0 : 0.0;
        // The tolerance counts deviances as equal if they differ only by rounding.
        as_large += again.deviance >= fit.deviance - 1e-9 * (1.0 + fit.deviance) ? 1.0 : 0.0;
    }
    const auto share = [&](double count) { return count / static_cast<double>(thresholds.size() + 1); };
    result.threshold = percentile_interval(thresholds, times);
    result.slope = percentile_interval(slopes, times, normal_quantile(share(less_slope)));
    if (result.threshold)
        result.p_gof = share(as_large);
    result.failed = times - thresholds.size();
    return result;
}

} // namespace tactor::study
