// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "core/trajectory/impl.hpp"
#include "core/trajectory/units.hpp"
#include "core/words.hpp"
#include "plan/job.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr double shortest_burst_s = 0.0001; // shorter than a frame at 8 kHz
constexpr double longest_free_soa_s = 10.0;
// Longest duration in the data to which Eq. (1) was fitted (Israr and Poupyrev 2011).
constexpr double longest_fitted_s = 0.160;
// Shortest path that people feel well as movement, relative to the distance between two tactors
// (Remache-Vinueza, Trujillo-Leon and Vidal-Verdu, Displays 2024).
constexpr double least_travel = 0.2;
// Longest side of a face without a warning, in pitches. The RMS error of gaussian along a diagonal is 1.2 mm
// for a grid of 20 x 20 mm, 2.5 mm for 20 x 24 mm, 4.2 mm for 20 x 28 mm, and 9 mm for 20 x 40 mm.
constexpr double widest_face = 1.15;
// Messages show durations in milliseconds: a difference of less than half a millisecond does not count.
constexpr double law_tolerance_s = 0.0005;
constexpr std::uint64_t most_samples = 4000;

void count(const layout& l, const plan& p, detail::burst_count& c)
{
    if (c.all == 0 && !p.bursts.empty())
        c.first_s = p.bursts.front().duration_s;
    c.all += p.bursts.size();
    for (const burst& b : p.bursts) {
        if (p.faces == faces_kind::nearest)
            c.missed.add(l, b);
        c.longest_s = std::max(c.longest_s, b.duration_s);
        c.too_long += b.duration_s > longest_fitted_s + 1e-9 ? 1 : 0;
        if (b.duration_s * p.carrier_hz < 1.0 - 1e-9) {
            c.shortest_s = c.too_short == 0 ? b.duration_s : std::min(c.shortest_s, b.duration_s);
            ++c.too_short;
        }
    }
}

void warn_of_long_bursts(const detail::burst_count& c, plan& p)
{
    if (c.too_long != 0)
        p.warnings.push_back(
            fmt::format("{} of {} {} longer than {:.3f} s (up to {:.3f} s), beyond the range "
                        "for which the timing law was fitted",
                        c.too_long, counted(c.all, "burst"), c.too_long == 1 ? "lasts" : "last",
                        longest_fitted_s, c.longest_s));
}

void warn_of_short_bursts(const detail::burst_count& c, plan& p)
{
    if (c.too_short != 0)
        p.warnings.push_back(fmt::format("{} of {} {} shorter than one cycle of the carrier, {:.4g} ms at "
                                         "{:.6g} Hz (down to {:.4g} ms): too short to feel as vibration",
                                         c.too_short, counted(c.all, "burst"),
                                         c.too_short == 1 ? "is" : "are", 1e3 / p.carrier_hz, p.carrier_hz,
                                         c.shortest_s * 1e3));
}

/// Warns of a stroke that hardly moves, but not of a stroke that rests.
void warn_of_short_travel(double pitch_mm, plan& p)
{
    if (p.stroke_length_mm > 0.0 && p.stroke_length_mm < least_travel * pitch_mm * (1.0 - 1e-9))
        p.warnings.push_back(fmt::format("its path of {:.4g} mm is shorter than a fifth of the {:.4g} mm "
                                         "between tactors: people may not feel it move",
                                         p.stroke_length_mm, pitch_mm));
}

/// Warns of a movement whose numbers are probably in another unit.
void warn_of_units(const stroke& s, plan& p)
{
    constexpr int parts = 100;
    detail::travel t{p.stroke_length_mm, p.stroke_duration_s};
    if (const auto* drawn = std::get_if<detail::drawn_path>(&detail::access::of(s.motion).law);
        drawn != nullptr && drawn->moves)
        t.moving_s *= drawn->moves->moving_s() / drawn->moves->total_s();
    for (int i = 0; i <= parts; ++i) {
        const point at = s.motion.position(p.stroke_duration_s * i / parts);
        t.farthest_mm = std::max({t.farthest_mm, std::abs(at.x_mm), std::abs(at.y_mm)});
    }
    constexpr double same = 1e-6;
    if (s.speed_mm_s && std::abs(*s.speed_mm_s * t.moving_s - t.length_mm) <= same * t.length_mm)
        t.source = detail::pace_source::speed;
    if (std::string text = detail::unit_warning(t); !text.empty())
        p.warnings.push_back(std::move(text));
}

/// Warns of faces that are too wide for gaussian, whose width is 0.6 of the pitch in every direction.
void warn_of_wide_faces(const layout& l, const phantom_model& m, plan& p)
{
    if (m.name() != to_string(phantom_kind::gaussian) || l.faces().empty())
        return;
    std::vector<double> longest_mm;
    for (const std::vector<unsigned>& f : l.faces()) {
        double most = 0.0;
        for (std::size_t i = 0; i < f.size(); ++i)
            most = std::max(most, distance_mm(l.places()[f[i]], l.places()[f[(i + 1) % f.size()]]));
        longest_mm.push_back(most);
    }
    const auto middle = longest_mm.begin() + static_cast<std::ptrdiff_t>(longest_mm.size() / 2);
    std::nth_element(longest_mm.begin(), middle, longest_mm.end());
    if (*middle > widest_face * l.pitch_mm())
        p.warnings.push_back(fmt::format(
            "gaussian spreads by {:.4g} mm, the median distance to the nearest tactor, but neighbours are "
            "{:.4g} mm apart: between those, people feel it at the nearer one (use phantom = "
            "inverse-distance or barycentric)",
            l.pitch_mm(), *middle));
}

/// Warns if the algorithm does not use the option `faces`, and of places outside the triangle of their three
/// tactors. `missed` must have counted the bursts; for a curve, this function counts some 4000 samples.
void warn_of_faces(const layout& l, const plan_options& o, detail::missed_places& missed, plan& p)
{
    if (o.faces != p.faces)
        p.warnings.push_back(fmt::format(
            "faces = {} is not used: tactile-brush plays on the lines of the grid", to_string(o.faces)));
    if (p.faces != faces_kind::nearest)
        return;
    const std::uint64_t samples = p.curve ? p.curve->size() : 0;
    burst b;
    for (std::uint64_t k = 0; k < samples; k += 1 + samples / most_samples) {
        p.curve->sample(k, b);
        missed.add(l, b);
    }
    if (std::string text = missed.warning(p.curve ? "sample" : "burst"); !text.empty())
        p.warnings.push_back(std::move(text));
}

/// Warns of missing samples, and of parts of a vibration that were left out. A recorder that was switched off
/// leaves a file that is shorter than its header says.
void warn_of_missing_samples(plan& p)
{
    const std::shared_ptr<const recording>& r = p.wave.recorded;
    if (p.wave.kind != waveform_kind::recording)
        return;
    if (r->source)
        p.warnings.insert(p.warnings.end(), r->source->notes.begin(), r->source->notes.end());
    if (r->missing > 0)
        p.warnings.push_back(fmt::format("{}: the recording is incomplete: it has {} of {}",
                                         recording_name(*r), r->samples.size(),
                                         counted(r->samples.size() + r->missing, "sample")));
}

/// Warns if the requested burst duration is not used, or does not match the SOA by the timing law.
void warn_of_own_duration(const plan_options& o, const detail::burst_count& c, plan& p)
{
    if (!o.burst_s)
        return;
    if (!p.soa_s) {
        p.warnings.push_back(fmt::format(
            "the requested burst duration, {}, is not used: {}", seconds_text(*o.burst_s),
            p.curve ? "continuous has no bursts" : "tactile-brush takes durations from path and timing law"));
        return;
    }
    const timing_profile& law = o.profile;
    const bool in_bounds = *p.soa_s > law.intercept_s && *p.soa_s <= law.max_soa_s + detail::same_time_s;
    const double d = c.first_s;
    if (!in_bounds || std::abs(d - detail::law_duration_s(law, *p.soa_s)) > law_tolerance_s)
        p.warnings.push_back(
            fmt::format("bursts of {} every {} break the timing law, SOA = {:.6g} duration + {}, which gives "
                        "them an SOA of {}: people may not feel one motion",
                        seconds_text(d), seconds_text(*p.soa_s), law.slope, seconds_text(law.intercept_s),
                        seconds_text(law.slope * d + law.intercept_s, 4)));
}

double check_carrier(double hz)
{
    if (!(hz > 0.0 && std::isfinite(hz)))
        throw detail::bad_field("carrier_hz", fmt::format("{} Hz is not a frequency", hz),
                                "give more than 0, such as 250");
    return hz;
}

/// Checks the timing law.
/// \throws error (bad_input) for a law that no SOA can follow.
void check_profile(const timing_profile& p)
{
    const auto refuse = [](std::string_view what, double value, std::string_view hint) {
        throw error(error_kind::bad_input, "timing profile", fmt::format("{} {} is impossible", what, value),
                    hint)
            .with_field("profile");
    };
    if (!(p.slope > 0.0 && p.slope < 1.0))
        refuse("a slope of", p.slope, "give 0 to 1; 0.32 on palm and forearm");
    if (!(p.intercept_s >= 0.0 && std::isfinite(p.intercept_s)))
        refuse("an intercept (s) of", p.intercept_s, "give 0 or more; 0.0473 on palm and forearm");
    if (!(p.max_soa_s > p.intercept_s && std::isfinite(p.max_soa_s)))
        refuse("a longest SOA (s) of", p.max_soa_s,
               fmt::format("give more than the intercept, {}", p.intercept_s));
}

/// Checks options.
/// \throws error (bad_input) for options that the algorithm cannot use.
void check_options(const plan_options& o)
{
    if (o.algorithm == algorithm_kind::tactile_brush)
        check_profile(o.profile);
    // Checks SOA and burst duration. The other algorithms do not use them, so checks only a changed SOA.
    if (o.algorithm == algorithm_kind::park2016 || o.soa_s != plan_options{}.soa_s)
        static_cast<void>(burst_duration_s(o));
}

/// Returns true if the error is about an SOA or a burst duration that the stroke itself sets.
bool is_own(const error& e, const stroke_choices& c)
{
    return (e.field() == "soa_s" && c.soa_s) || (e.field() == "burst_s" && (c.burst_s || c.soa_s));
}

void check_stroke_options(const plan_options& o, const stroke& s)
{
    try {
        check_options(o);
    } catch (const error& e) {
        if (s.places.choices.line == 0 || !is_own(e, s.choices))
            throw;
        throw e.reworded(s.places.choices.text(), fmt::format("{}: {}", e.subject(), e.why()), e.hint())
            .with_place(s.places.choices);
    }
}

} // namespace

double burst_duration_s(const timing_profile& p, double soa_s)
{
    check_profile(p);
    if (!(soa_s > p.intercept_s && soa_s <= p.max_soa_s))
        throw detail::bad_field(
            "soa_s",
            fmt::format("{} s is out of range: the SOA must be above {} s and at most {} s", soa_s,
                        p.intercept_s, p.max_soa_s),
            fmt::format("use {}, or set {{burst_s}} for a wider range", p.max_soa_s));
    return detail::law_duration_s(p, soa_s);
}

double burst_duration_s(const plan_options& o)
{
    if (!o.burst_s)
        return burst_duration_s(o.profile, o.soa_s);
    check_profile(o.profile);
    if (!(o.soa_s >= shortest_burst_s && o.soa_s <= longest_free_soa_s))
        throw detail::bad_field(
            "soa_s",
            fmt::format("{} s is out of range: with a set burst duration the SOA must be from {} to {} s",
                        o.soa_s, shortest_burst_s, longest_free_soa_s),
            fmt::format("use {}", o.profile.max_soa_s));
    if (!(*o.burst_s >= shortest_burst_s && std::isfinite(*o.burst_s)))
        throw detail::bad_field(
            "burst_s", fmt::format("{} s is too short: {} s is the shortest", *o.burst_s, shortest_burst_s),
            fmt::format("use {} to {} s", shortest_burst_s, o.soa_s));
    if (*o.burst_s > o.soa_s)
        throw detail::bad_field(
            "burst_s",
            fmt::format("{} s is longer than the SOA of {} s, and bursts must not overlap", *o.burst_s,
                        o.soa_s),
            fmt::format("use at most {} s, or a longer SOA", o.soa_s));
    return *o.burst_s;
}

double intensity_scale::amplitude(double intensity) const
{
    // Callers refuse intensities that are negative or not numbers.
    if (!(intensity > 0.0))
        return intensity;
    if (level_db != 0.0) {
        if (!(std::isfinite(level_db) && level_db < 0.0))
            throw detail::bad_field("level_db", fmt::format("{} is not a level of 0 dB or less", level_db),
                                    "give 0 dB or less, relative to the requested level");
        return intensity_scale{kind, exponent, sl_db}.amplitude(intensity) * std::pow(10.0, level_db / 20.0);
    }
    if (kind == scale_kind::linear)
        return intensity;
    if (kind == scale_kind::stevens) {
        if (!detail::bounds_of::stevens_exponent.holds(exponent))
            throw detail::bad_field(
                "stevens_exponent", fmt::format("{} is not an exponent", exponent),
                "give 0.1 to 3; 0.95 at 60 Hz and 0.6 at 250 Hz on the finger (Stevens 1968)");
        return std::pow(intensity, 1.0 / exponent);
    }
    if (!(sl_db > 0.0 && sl_db <= 100.0))
        throw error(
            error_kind::bad_input, "{intensity_scale}",
            fmt::format("the scale sl needs a sensation level above 0 and at most 100 dB, but it is {} dB",
                        sl_db),
            "give {sl_db} above 0 dB, such as 7")
            .with_field("intensity_scale");
    return std::pow(10.0, sl_db * (intensity - 1.0) / 20.0);
}

plan make_plan(const array& a, const layout& l, const stroke& s, const plan_options& o)
{
    return detail::plan_in_pieces(a, l, s, o, {});
}

plan make_plan(const array& a, const stroke& s, const plan_options& o)
{
    return make_plan(a, layout(a), s, o);
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

plan_options apply_choices(plan_options common, const stroke_choices& c)
{
    common.algorithm = c.algorithm.value_or(common.algorithm);
    common.soa_s = c.soa_s.value_or(common.soa_s);
    common.burst_s = c.burst_s ? c.burst_s : common.burst_s;
    common.scale.level_db += c.level_db;
    common.faces = c.faces.value_or(common.faces);
    if (c.phantom) {
        common.phantom = *c.phantom;
        common.custom_phantom.reset();
    }
    return common;
}

namespace {

std::optional<double> first_carrier_hz(const stroke_sound& s)
{
    return !s.carrier_times.empty()     ? s.carrier_times.front().hz
           : !s.carrier_profile.empty() ? s.carrier_profile.front().hz
                                        : s.carrier_hz;
}

} // namespace

plan plan_in_pieces(const array& a, const layout& l, const stroke& s, const plan_options& common,
                    const burst_taker& take)
{
    if (s.fit)
        return plan_in_pieces(a, l, apply_fits({s}, l).front(), common, take);
    const plan_options o = apply_choices(common, s.choices);
    check_stroke_options(o, s);
    if (l.places().size() != a.tactors.size())
        throw error(error_kind::bad_input, "layout",
                    fmt::format("it has {}, but the array has {}", counted(l.places().size(), "tactor"),
                                a.tactors.size()),
                    "build the layout from the same array");
    burst_count bursts;
    const job j{a, l, s, o, choose_model(l, o), bursts, take};
    plan p;
    p.warnings = s.warnings;
    p.algorithm = to_string(o.algorithm);
    p.phantom = j.model->name();
    p.faces = effective_faces(o);
    p.stroke_duration_s = s.motion.duration_s();
    p.stroke_length_mm = s.motion.length_mm();
    p.carrier_hz = check_carrier(first_carrier_hz(s.sound).value_or(o.carrier_hz));
    p.overlap = o.overlap;
    p.wave = s.sound.wave.value_or(o.wave);
    p.am = s.sound.am.value_or(o.am);
    if (p.wave.recorded && p.wave.recorded->source &&
        (p.wave.texture == texture_kind::cycle || s.motion.length_mm() == 0.0))
        p.wave.texture = texture_kind::time; // the recording is no cycle, or the path has no length
    validate(p.wave);
    validate(p.am);
    p.course = make_course(s, p.wave);
    switch (o.algorithm) {
    case algorithm_kind::park2016:
        plan_park(j, p);
        break;
    case algorithm_kind::tactile_brush:
        plan_brush(j, p);
        break;
    case algorithm_kind::continuous:
        plan_continuous(j, p);
        break;
    }
    p.conflicts = find_conflicts(p.bursts);
    deliver_bursts(j, p);
    warn_of_units(s, p);
    warn_of_short_travel(l.pitch_mm(), p);
    warn_of_wide_faces(l, *j.model, p);
    warn_of_faces(l, o, bursts.missed, p);
    warn_of_long_bursts(bursts, p);
    warn_of_short_bursts(bursts, p);
    warn_of_own_duration(o, bursts, p);
    warn_of_missing_samples(p);
    return p;
}

void deliver_bursts(const job& j, plan& p)
{
    count(j.faces, p, j.counted);
    if (j.take) {
        j.take(p, p.bursts);
        p.bursts.clear();
    }
}

} // namespace tactor::detail
