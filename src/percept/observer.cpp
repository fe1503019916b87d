// SPDX-License-Identifier: MIT
#include "percept/observer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/words.hpp"

namespace tactor::detail {
namespace {

// Give of a link without pull. With infinity there would be infinity / infinity.
constexpr double freest = 1e30;

void check(const char* what, double v, double least, double most)
{
    if (!(v >= least && v <= most))
        throw bad_field(what, fmt::format("{} is out of range", v),
                        fmt::format("{} to {}", plain_number(least), plain_number(most)));
}

void check_count(const array& a, const char* what, std::size_t n)
{
    if (n != 0 && n != a.tactors.size())
        throw bad_field(what, fmt::format("there are {} for {}", n, counted(a.tactors.size(), "tactor")),
                        "one for each, or none");
}

} // namespace

array felt_array(const array& a, const person& who)
{
    check_count(a, "shift", who.shift.size());
    array felt = a;
    for (std::size_t i = 0; i < who.shift.size(); ++i) {
        point& p = felt.tactors[i].position;
        p = {p.x_mm + who.shift[i].x_mm, p.y_mm + who.shift[i].y_mm};
        if (!std::isfinite(p.x_mm) || !std::isfinite(p.y_mm))
            throw bad_field("shift", fmt::format("that of tactor {} is not finite", i));
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
            throw bad_field("sensitivity_db", fmt::format("{} dB is not one", db));
    }
    return gains;
}

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
                fmt::format("number {}, {} s, is before the one before it or no time", i + 1, onsets_s[i]),
                "give them in order");
        if (i > 0) {
            const double way = o.sigma_v_mm_s * (onsets_s[i] - onsets_s[i - 1]) / o.sigma_mm;
            give.push_back(std::min(way * way, freest));
        }
    }
    return give;
}

// Solves by Thomas's elimination. Pivot i is k_i + q_i, and k / (k + q) is computed as 1 / (1 + q / k), so
// only positive numbers are added. Nothing cancels, however strong a link is; a rigid one has give 0.
std::vector<point> pulled(std::span<const double> give, std::span<const point> alone)
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

std::vector<point> pushed(std::span<const double> give, std::span<const point> felt)
{
    std::vector<point> m(felt.begin(), felt.end());
    for (std::size_t i = 0; i + 1 < felt.size(); ++i) {
        const point pull{(felt[i + 1].x_mm - felt[i].x_mm) / give[i],
                         (felt[i + 1].y_mm - felt[i].y_mm) / give[i]};
        m[i] = {m[i].x_mm - pull.x_mm, m[i].y_mm - pull.y_mm};
        m[i + 1] = {m[i + 1].x_mm + pull.x_mm, m[i + 1].y_mm + pull.y_mm};
    }
    return m;
}

std::optional<point> find_centre(const array& a, const burst& b, std::span<const double> gains)
{
    double energy = 0.0;
    point moment;
    for (const drive& d : b.drives) {
        if (d.tactor >= a.tactors.size())
            throw error(error_kind::bad_input, "plan", fmt::format("drives tactor {}", d.tactor),
                        fmt::format("\"{}\" has {}", a.name, counted(a.tactors.size(), "tactor")));
        const point& at = a.tactors[d.tactor].position;
        const double felt = d.amplitude * (gains.empty() ? 1.0 : gains[d.tactor]);
        const double e = felt * felt;
        energy += e;
        moment = {moment.x_mm + e * at.x_mm, moment.y_mm + e * at.y_mm};
    }
    if (!(energy > 0.0))
        return {};
    return point{moment.x_mm / energy, moment.y_mm / energy};
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<point> felt_places(const low_speed_observer& o, std::span<const double> onsets_s,
                               std::span<const point> alone)
{
    const std::vector<double> give = detail::link_give(o, onsets_s);
    if (onsets_s.size() != alone.size())
        throw detail::bad_field("onsets_s",
                                fmt::format("there are {}, and {} places", onsets_s.size(), alone.size()),
                                "one for each");
    for (const point& p : alone)
        if (!std::isfinite(p.x_mm) || !std::isfinite(p.y_mm))
            throw error(error_kind::bad_input, "place of a tap", "is not finite");
    return detail::pulled(give, alone);
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
                    "take an algorithm that has bursts");
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

} // namespace v0
} // namespace tactor
