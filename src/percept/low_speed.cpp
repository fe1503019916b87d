// SPDX-License-Identifier: MIT
#include "percept/low_speed.hpp"

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
        throw detail::bad_field(what, fmt::format("{} is out of range", v),
                                fmt::format("{} to {}", plain_number(least), plain_number(most)));
}

} // namespace

std::vector<double> link_give(const low_speed_observer& o, std::span<const double> onsets_s)
{
    check("sigma_mm", o.sigma_mm, least_sigma_mm, most_sigma_mm);
    check("sigma_v_mm_s", o.sigma_v_mm_s, least_sigma_v_mm_s, most_sigma_v_mm_s);
    std::vector<double> give;
    give.reserve(onsets_s.size());
    for (std::size_t i = 0; i < onsets_s.size(); ++i) {
        if (!std::isfinite(onsets_s[i]) || (i > 0 && onsets_s[i] < onsets_s[i - 1]))
            throw detail::bad_field(
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

} // namespace v0
} // namespace tactor
