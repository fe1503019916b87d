// SPDX-License-Identifier: MIT
#include "percept/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "percept/observer.hpp"
#include "percept/path_errors.hpp"

namespace tactor::detail {
namespace {

constexpr double low_part = 0.05;
constexpr double high_part = 0.95;
constexpr std::size_t most_tracks = 40;
constexpr std::size_t most_speeds = 20'000'000; // greatest number for all people together, for a picture

// SplitMix64 (Steele, Lea and Flood 2014). It gives the same numbers on every machine.
class random_draws {
public:
    explicit random_draws(std::uint64_t seed) : state_(seed) {}

    // Returns a number from 0 to below 1.
    double part()
    {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
    }

    // Returns a number from -1 to below 1.
    double draw_signed_number() { return 2.0 * part() - 1.0; }

private:
    std::uint64_t state_;
};

// Speeds at each time, by person.
struct speed_table {
    std::vector<double> times_s = {};
    std::vector<std::vector<std::optional<double>>> speeds = {};

    void add(std::size_t at, double t_s, std::optional<double> v)
    {
        if (speeds.size() <= at) {
            speeds.resize(at + 1);
            times_s.resize(at + 1);
            times_s[at] = t_s;
        }
        speeds[at].push_back(v);
    }
};

void add_track(row_spread& r, std::vector<point> track)
{
    if (r.tracks.size() < most_tracks)
        r.tracks.push_back(std::move(track));
}

void record_taps(speed_table& speeds, row_spread& r, const std::vector<tap>& taps)
{
    std::vector<point> track;
    for (std::size_t i = 0, at = 0; i < taps.size(); ++i) {
        track.push_back(taps[i].felt);
        if (i > 0 && taps[i].onset_s > taps[i - 1].onset_s)
            speeds.add(at++, (taps[i].onset_s + taps[i - 1].onset_s) / 2.0,
                       distance_mm(taps[i].felt, taps[i - 1].felt) / (taps[i].onset_s - taps[i - 1].onset_s));
    }
    add_track(r, std::move(track));
}

void record_samples(speed_table& speeds, row_spread& r, const std::vector<percept_sample>& samples)
{
    std::vector<point> track;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        speeds.add(i, samples[i].t_s, samples[i].speed_mm_s);
        if (samples[i].felt && (track.empty() || !(track.back() == *samples[i].felt)))
            track.push_back(*samples[i].felt);
    }
    add_track(r, std::move(track));
}

// Returns a quantile of a sorted list, which must not be empty. Interpolates linearly between values.
double quantile(const std::vector<double>& sorted, double part)
{
    const double at = part * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    const std::size_t next = std::min(i + 1, sorted.size() - 1);
    return sorted[i] + (at - static_cast<double>(i)) * (sorted[next] - sorted[i]);
}

// Returns the interval of a figure over people, or nothing if the figure is missing for a person.
template <class Person, class Figure>
std::optional<interval> find_interval(const std::vector<Person>& people, Figure figure)
{
    std::vector<double> sorted;
    for (const Person& one : people)
        if (const std::optional<double> v = std::invoke(figure, one))
            sorted.push_back(*v);
    if (sorted.empty() || sorted.size() != people.size())
        return {};
    std::sort(sorted.begin(), sorted.end());
    return interval{quantile(sorted, low_part), quantile(sorted, high_part)};
}

struct drawn_person {
    tactor::person who;
    double sigma_factor = 1.0;
};

// Draws people at random. The same seed and number of tactors give the same people.
std::vector<drawn_person> draw_people(const spread_choice& c, std::size_t tactors)
{
    random_draws d(c.seed);
    std::vector<drawn_person> people(c.people);
    for (drawn_person& p : people) {
        p.sigma_factor = std::pow(c.sigma_factor, d.draw_signed_number());
        for (std::size_t i = 0; i < tactors; ++i) {
            p.who.sensitivity_db.push_back(c.threshold_db * d.draw_signed_number());
            const double turn = 2.0 * std::numbers::pi * d.part();
            const double away = c.place_mm * std::sqrt(d.part());
            p.who.shift.push_back({away * std::cos(turn), away * std::sin(turn)});
        }
    }
    return people;
}

// Sets the errors of taps in a summary. Each tap counts once, at its onset.
void report_taps(const std::vector<tap>& taps, const stroke& s, const target_places& targets,
                 percept_summary& r)
{
    path_errors errors(targets);
    std::array<double, lag_count> x_mm{};
    std::array<double, lag_count> y_mm{};
    for (const tap& t : taps) {
        for (std::size_t k = 0; k < lag_count; ++k) {
            const point at =
                s.motion.position(t.onset_s - static_cast<double>(lag_count - 1 - k) * percept_step_s);
            x_mm[k] = at.x_mm;
            y_mm[k] = at.y_mm;
        }
        const auto nearest = static_cast<std::size_t>(std::lround(t.onset_s / percept_step_s));
        errors.add(std::min(nearest, targets.size() - 1), {x_mm.data(), y_mm.data()}, t.felt);
    }
    errors.report(r);
}

prediction predict_low_speed(const array& a, const stroke& s, const target_places& targets, const plan& p,
                             const low_speed_observer& o, const person& who = {})
{
    prediction r;
    if (p.curve) {
        r.unpredicted = "continuous has no bursts, and this observer feels only taps";
        return r;
    }
    r.taps = predict_taps(a, s, p, o, who);
    r.tapped = summarise(r.taps);
    report_taps(r.taps, s, targets, r.felt);
    return r;
}

// Predicts how a plan feels to each person, by the observer in `choice`. Returns the intervals over people.
row_spread predict_spread(const std::vector<drawn_person>& people, const array& a, const stroke& s,
                          const target_places& targets, const plan& p, const comparison_choice& choice)
{
    const bool by_taps = choice.observer.kind == observer_kind::low_speed;
    const double speeds_each =
        by_taps ? static_cast<double>(p.bursts.size()) : s.motion.duration_s() / percept_step_s;
    if (choice.keep_samples &&
        speeds_each * static_cast<double>(people.size()) > static_cast<double>(most_speeds))
        throw error(error_kind::bad_input, "spread",
                    fmt::format("{} people are too many for a picture of a stroke of {}", people.size(),
                                seconds_text(s.motion.duration_s())),
                    "use fewer people, or draw no picture")
            .with_field("spread");
    std::vector<percept_summary> felt;
    std::vector<tap_summary> tapped;
    speed_table speeds;
    row_spread r;
    for (const drawn_person& x : people) {
        if (by_taps) {
            low_speed_observer o = choice.observer.low_speed;
            o.sigma_mm = std::clamp(o.sigma_mm * x.sigma_factor, least_sigma_mm, most_sigma_mm);
            const prediction one = predict_low_speed(a, s, targets, p, o, x.who);
            felt.push_back(one.felt);
            tapped.push_back(one.tapped);
            if (choice.keep_samples)
                record_taps(speeds, r, one.taps);
        } else if (choice.keep_samples) {
            const std::vector<percept_sample> samples = predict_percept(a, s, p, x.who);
            felt.push_back(summarise(samples));
            record_samples(speeds, r, samples);
        } else {
            felt.push_back(predict_summary(a, targets, s.motion.duration_s(), p, x.who));
        }
        choice.after_person();
    }
    r.rms_error_mm = find_interval(felt, &percept_summary::rms_error_mm);
    r.largest_error_mm = find_interval(felt, &percept_summary::largest_error_mm);
    r.lag_s = find_interval(felt, &percept_summary::lag_s);
    r.rms_at_lag_mm = find_interval(felt, &percept_summary::rms_at_lag_mm);
    r.along_rms_mm = find_interval(felt, &percept_summary::along_rms_mm);
    r.along_max_mm = find_interval(felt, &percept_summary::along_max_mm);
    r.across_rms_mm = find_interval(felt, &percept_summary::across_rms_mm);
    r.across_max_mm = find_interval(felt, &percept_summary::across_max_mm);
    r.rms_to_path_mm = find_interval(felt, &percept_summary::rms_to_path_mm);
    r.speed_cv = find_interval(felt, &percept_summary::speed_cv);
    r.intensity_cv = find_interval(felt, &percept_summary::intensity_cv);
    r.felt_length_mm = find_interval(tapped, &tap_summary::felt_length_mm);
    r.length_ratio = find_interval(tapped, &tap_summary::length_ratio);
    for (std::size_t i = 0; i < speeds.speeds.size(); ++i)
        if (const auto range = find_interval(speeds.speeds[i], std::identity{}))
            r.speeds.push_back({speeds.times_s[i], range->low, range->high});
    return r;
}

prediction predict_with_targets(const array& a, const stroke& s, const target_places& targets, const plan& p,
                                const observer_choice& o,
                                const std::function<void(const percept_sample&)>& each = {})
{
    if (o.kind == observer_kind::low_speed)
        return predict_low_speed(a, s, targets, p, o.low_speed);
    return {.felt = predict_summary(a, targets, s.motion.duration_s(), p, {}, each)};
}

} // namespace

std::string prediction_note(const observer_choice& o)
{
    const std::string model = "a model's prediction, not a measurement: ";
    if (o.kind == observer_kind::low_speed)
        return model + describe(o.low_speed);
    return model + "the felt position is assumed to be the centre of energy of the tactors that sound";
}

prediction predict(const array& a, const stroke& s, const plan& p, const observer_choice& o,
                   const std::function<void(const percept_sample&)>& each)
{
    return predict_with_targets(a, s, target_places(s.motion), p, o, each);
}

bool comparison::playable() const
{
    return std::any_of(rows.begin(), rows.end(), [](const comparison_row& r) { return r.plan.has_value(); });
}

bool comparison::predicted() const
{
    return std::any_of(rows.begin(), rows.end(),
                       [](const comparison_row& r) { return r.plan.has_value() && r.unpredicted.empty(); });
}

comparison compare(const stroke& target, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice)
{
    // Removes the stroke's own choices, because each row has its own algorithm and phantom model.
    stroke s = target;
    s.choices.algorithm.reset();
    s.choices.phantom.reset();
    s.choices.faces.reset();
    comparison c{s, choice.observer, choice.compensate, choice.spread, options.faces};
    const std::vector<drawn_person> people = draw_people(choice.spread, a.tactors.size());
    std::optional<target_places> targets; // shared by all rows; throws if the target is too long
    for (const algorithm_kind algorithm : choice.algorithms)
        for (const phantom_kind phantom : choice.phantoms) {
            comparison_row row{{}, algorithm, phantom};
            plan_options o = options;
            o.algorithm = algorithm;
            o.phantom = phantom;
            try {
                row.plan = plan_for_observer(a, faces, s, o,
                                             choice.compensate ? &choice.observer.low_speed : nullptr)
                               .plan;
                if (!targets)
                    targets.emplace(s.motion);
                static_cast<prediction&>(row) =
                    predict_with_targets(a, s, *targets, *row.plan, choice.observer);
                if (choice.keep_samples && choice.observer.kind == observer_kind::centroid)
                    row.samples = predict_percept(a, s, *row.plan);
                if (!people.empty() && row.unpredicted.empty())
                    row.spread = predict_spread(people, a, s, *targets, *row.plan, choice);
            } catch (const error& e) {
                if (e.kind() != error_kind::bad_input)
                    throw;
                row.plan.reset();
                row.refused = e;
            }
            c.rows.push_back(std::move(row));
        }
    return c;
}

std::string spread_note(const spread_choice& c, bool by_taps)
{
    const std::string sigma =
        by_taps ? fmt::format("sigma from 1/{0} to {0} times as much, ", plain_number(c.sigma_factor)) : "";
    return fmt::format("5 to 95 % of {} drawn with seed {}: {}each tactor's threshold plus or minus {} dB, "
                       "its place within {} mm",
                       counted(c.people, "person", "people"), c.seed, sigma, plain_number(c.threshold_db),
                       plain_number(c.place_mm));
}

} // namespace tactor::detail
