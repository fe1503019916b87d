// SPDX-License-Identifier: MIT
#include "percept/spread.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::detail {
namespace {

constexpr double low_part = 0.05;
constexpr double high_part = 0.95;
constexpr std::size_t most_tracks = 40;
constexpr std::size_t most_speeds = 20'000'000; // speeds of all people, for a picture

// SplitMix64 (Steele, Lea and Flood 2014), equal on every machine.
class random_draws {
public:
    explicit random_draws(std::uint64_t seed) : state_(seed) {}

    // Returns a number from 0 up to 1.
    double part()
    {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
    }

    // Returns a number from -1 up to 1.
    double either_way() { return 2.0 * part() - 1.0; }

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

void draw_taps(speed_table& speeds, row_spread& r, const std::vector<tap>& taps)
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

void draw_samples(speed_table& speeds, row_spread& r, const std::vector<percept_sample>& samples)
{
    std::vector<point> track;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        speeds.add(i, samples[i].t_s, samples[i].speed_mm_s);
        if (samples[i].felt && (track.empty() || !(track.back() == *samples[i].felt)))
            track.push_back(*samples[i].felt);
    }
    add_track(r, std::move(track));
}

// Returns a quantile of a sorted list that is not empty, linear between its members.
double quantile(const std::vector<double>& sorted, double part)
{
    const double at = part * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    const std::size_t next = std::min(i + 1, sorted.size() - 1);
    return sorted[i] + (at - static_cast<double>(i)) * (sorted[next] - sorted[i]);
}

// Returns the interval of a figure; nothing if one of the people lacks it.
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

} // namespace

std::string spread_note(const spread_choice& c, bool by_taps)
{
    const std::string sigma =
        by_taps ? fmt::format("sigma from 1/{0} to {0} times as much, ", plain_number(c.sigma_factor)) : "";
    return fmt::format("5 to 95 % of {} drawn with seed {}: {}each tactor's threshold give or take {} dB, "
                       "its place within {} mm",
                       counted(c.people, "person", "people"), c.seed, sigma, plain_number(c.threshold_db),
                       plain_number(c.place_mm));
}

std::vector<drawn_person> draw_people(const spread_choice& c, std::size_t tactors)
{
    random_draws d(c.seed);
    std::vector<drawn_person> people(c.people);
    for (drawn_person& p : people) {
        p.sigma_factor = std::pow(c.sigma_factor, d.either_way());
        for (std::size_t i = 0; i < tactors; ++i) {
            p.who.sensitivity_db.push_back(c.threshold_db * d.either_way());
            const double turn = 2.0 * std::numbers::pi * d.part();
            const double away = c.place_mm * std::sqrt(d.part());
            p.who.shift.push_back({away * std::cos(turn), away * std::sin(turn)});
        }
    }
    return people;
}

row_spread predict_spread(const std::vector<drawn_person>& people, const array& a, const stroke& s,
                          const plan& p, const std::optional<low_speed_observer>& low_speed, bool for_picture,
                          const std::function<void()>& after_person)
{
    const double speeds_each =
        low_speed ? static_cast<double>(p.bursts.size()) : s.motion.duration_s() / percept_step_s;
    if (for_picture && speeds_each * static_cast<double>(people.size()) > static_cast<double>(most_speeds))
        throw error(error_kind::bad_input, "spread",
                    fmt::format("{} people are too many for a picture of a stroke of {}", people.size(),
                                seconds_text(s.motion.duration_s())),
                    "ask for fewer people, or draw no picture")
            .with_field("spread");
    std::vector<percept_summary> felt;
    std::vector<tap_summary> tapped;
    speed_table speeds;
    row_spread r;
    for (const drawn_person& x : people) {
        if (low_speed) {
            low_speed_observer o = *low_speed;
            o.sigma_mm = std::clamp(o.sigma_mm * x.sigma_factor, least_sigma_mm, most_sigma_mm);
            const std::vector<tap> taps = predict_taps(a, s, p, o, x.who);
            tapped.push_back(summarise(taps));
            if (for_picture)
                draw_taps(speeds, r, taps);
        } else if (for_picture) {
            const std::vector<percept_sample> samples = predict_percept(a, s, p, x.who);
            felt.push_back(summarise(samples));
            draw_samples(speeds, r, samples);
        } else {
            felt.push_back(summarise(a, s, p, x.who));
        }
        after_person();
    }
    if (low_speed) {
        r.rms_error_mm = find_interval(tapped, &tap_summary::rms_error_mm);
        r.largest_error_mm = find_interval(tapped, &tap_summary::largest_error_mm);
        r.felt_length_mm = find_interval(tapped, &tap_summary::felt_length_mm);
        r.length_ratio = find_interval(tapped, &tap_summary::length_ratio);
    } else {
        r.rms_error_mm = find_interval(felt, &percept_summary::rms_error_mm);
        r.largest_error_mm = find_interval(felt, &percept_summary::largest_error_mm);
        r.speed_cv = find_interval(felt, &percept_summary::speed_cv);
        r.intensity_cv = find_interval(felt, &percept_summary::intensity_cv);
    }
    for (std::size_t i = 0; i < speeds.speeds.size(); ++i)
        if (const auto range = find_interval(speeds.speeds[i], std::identity{}))
            r.speeds.push_back({speeds.times_s[i], range->low, range->high});
    return r;
}

} // namespace tactor::detail
