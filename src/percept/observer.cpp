// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "core/refused.hpp"
#include "core/words.hpp"
#include "percept/low_speed.hpp"
#include "percept/person.hpp"

namespace tactor::detail {
namespace {

void check_count(const array& a, const char* what, std::size_t n)
{
    if (n != 0 && n != a.tactors.size())
        throw detail::bad_field(what,
                                fmt::format("there are {} for {}", n, counted(a.tactors.size(), "tactor")),
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
            throw detail::bad_field("shift", fmt::format("that of tactor {} is not finite", i));
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
            throw detail::bad_field("sensitivity_db", fmt::format("{} dB is not one", db));
    }
    return gains;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

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
