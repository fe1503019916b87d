// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include "core/distance.hpp"
#include "core/words.hpp"
#include "percept/percept_sounding.hpp"
#include "percept/person.hpp"
#include "percept/summaries.hpp"
#include "plan/rounded.hpp"

namespace tactor {
inline namespace v0 {
namespace {

std::size_t count_samples(double duration_s)
{
    if (!(duration_s <= longest_percept_s))
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("lasts {}, too long to predict what is felt", seconds_text(duration_s)),
                    fmt::format("at most {} s", longest_percept_s));
    return static_cast<std::size_t>((duration_s + detail::same_time_s) / percept_step_s) + 1;
}

percept_sample target_at(const stroke& s, std::size_t i)
{
    percept_sample x;
    x.t_s = static_cast<double>(i) * percept_step_s;
    x.target = s.motion.position(x.t_s);
    x.target_intensity = s.motion.intensity(x.t_s);
    return x;
}

/// Speed of the felt position, sample by sample. Takes the positions in order, and knows a speed as soon as
/// the window has passed. In silence, the last position is held.
class running_speed {
public:
    /// Samples on either side of the middle of the window.
    static constexpr std::size_t half_window = 50;
    static_assert(percept_window_s == 2 * half_window * percept_step_s);
    /// Samples from the one whose speed next() returns to the newest.
    static constexpr std::size_t delay = half_window + 1;

    std::optional<double> next(const std::optional<point>& felt)
    {
        if (count_ == 0) {
            if (!felt)
                return {};
            origin_ = *felt;
        }
        held_ = felt.value_or(held_);
        // Relative to the first position, for precision.
        const std::size_t j = count_++;
        const point& before = sums_[j % capacity];
        sums_[(j + 1) % capacity] = {before.x_mm + (held_.x_mm - origin_.x_mm),
                                     before.y_mm + (held_.y_mm - origin_.y_mm)};
        felt_[j % capacity] = felt.has_value();
        if (j < 2 * delay)
            return {};
        const std::size_t middle = j - delay;
        was_felt_ = felt_[middle % capacity];
        return detail::length_mm(average(middle + 1), average(middle - 1)) / (2.0 * percept_step_s);
    }

    /// Returns true if anything was felt at the sample whose speed was returned.
    bool was_felt() const noexcept { return was_felt_; }

private:
    static constexpr std::size_t capacity = 128;
    static_assert(capacity >= 2 * delay + 2);

    point average(std::size_t i) const
    {
        constexpr double width = 2 * half_window + 1;
        const point& before = sums_[(i - half_window) % capacity];
        const point& after = sums_[(i + half_window + 1) % capacity];
        return {(after.x_mm - before.x_mm) / width, (after.y_mm - before.y_mm) / width};
    }

    std::size_t count_ = 0; // from the first felt one on
    point origin_;
    point held_;
    std::array<point, capacity> sums_{}; // of as many samples
    std::array<bool, capacity> felt_{};
    bool was_felt_ = false;
};

/// Mean and variance, in one pass (Welford 1962).
class moments {
public:
    void add(double x)
    {
        ++count_;
        const double before = x - mean_;
        mean_ += before / count_;
        squares_ += before * (x - mean_);
    }

    std::optional<double> coefficient_of_variation() const
    {
        if (!(mean_ > 0.0))
            return {};
        return std::sqrt(squares_ / count_) / mean_;
    }

private:
    double count_ = 0.0;
    double mean_ = 0.0;
    double squares_ = 0.0;
};

/// Distance of a prediction from its target, summed sample by sample.
class summing {
public:
    /// Adds a sample except its speed, which may come later. Speeds are added in their own order.
    void add(const percept_sample& x)
    {
        ++count_;
        intensity_.add(x.intensity);
        shared_ += x.shared ? 1.0 : 0.0;
        if (!x.felt)
            return;
        ++felt_;
        const double off = detail::length_mm(*x.felt, x.target);
        squares_ += off * off;
        largest_ = std::max(largest_, off);
    }

    /// Adds the speed of a sample at which something is felt.
    void add_speed(double mm_s) { speed_.add(mm_s); }

    /// Adds a sample with its speed, if known.
    void add_all(const percept_sample& x)
    {
        add(x);
        if (x.felt && x.speed_mm_s)
            add_speed(*x.speed_mm_s);
    }

    percept_summary result() const
    {
        percept_summary r;
        if (!(count_ > 0.0))
            return r;
        if (felt_ > 0.0) {
            r.rms_error_mm = std::sqrt(squares_ / felt_);
            r.largest_error_mm = largest_;
        }
        r.speed_cv = speed_.coefficient_of_variation();
        r.intensity_cv = intensity_.coefficient_of_variation();
        r.silent_share = (count_ - felt_) / count_;
        r.shared_share = shared_ / count_;
        return r;
    }

private:
    moments speed_;
    moments intensity_;
    double count_ = 0.0;
    double felt_ = 0.0;
    double shared_ = 0.0;
    double squares_ = 0.0;
    double largest_ = 0.0;
};

/// A plan, summed while it is followed.
struct followed_plan {
    detail::sounding now;
    running_speed speed = {};
    summing sums = {};
};

} // namespace

void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                    const std::function<void(const percept_sample&)>& each)
{
    constexpr std::size_t delay = running_speed::delay;
    const std::size_t count = count_samples(s.motion.duration_s());
    const array felt = detail::felt_array(a, who);
    detail::sounding now(felt, p, s.motion.duration_s(), detail::person_gains(a, who));
    running_speed speed;
    std::array<percept_sample, delay + 1> waiting; // samples that wait for their speed
    for (std::size_t i = 0; i < count + delay; ++i) {
        if (i < count) {
            percept_sample& x = waiting[i % waiting.size()];
            x = target_at(s, i);
            now.at(x.t_s, x);
            if (const auto v = speed.next(x.felt))
                waiting[(i - delay) % waiting.size()].speed_mm_s = v;
        }
        if (i >= delay)
            each(waiting[(i - delay) % waiting.size()]);
    }
}

std::vector<percept_sample> predict_percept(const array& a, const stroke& s, const plan& p, const person& who)
{
    std::vector<percept_sample> samples;
    samples.reserve(count_samples(s.motion.duration_s()));
    follow_percept(a, s, p, who, [&](const percept_sample& x) { samples.push_back(x); });
    return samples;
}

percept_summary summarise(const array& a, const stroke& s, const plan& p, const person& who)
{
    summing sums;
    follow_percept(a, s, p, who, [&](const percept_sample& x) { sums.add_all(x); });
    return sums.result();
}

percept_summary summarise(const std::vector<percept_sample>& samples)
{
    summing sums;
    for (const percept_sample& x : samples)
        sums.add_all(x);
    return sums.result();
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans,
                                               const std::function<void(const percept_sample&)>& each)
{
    const std::size_t count = count_samples(s.motion.duration_s());
    std::vector<followed_plan> all;
    all.reserve(plans.size());
    for (const plan* p : plans)
        all.push_back({detail::sounding(a, *p, s.motion.duration_s(), {})});
    for (std::size_t i = 0; i < count; ++i) {
        percept_sample x = target_at(s, i);
        for (followed_plan& f : all) {
            f.now.at(x.t_s, x);
            f.sums.add(x);
            const auto v = f.speed.next(x.felt);
            if (v && f.speed.was_felt())
                f.sums.add_speed(*v);
            if (each)
                each(x);
        }
    }
    std::vector<percept_summary> summaries;
    for (const followed_plan& f : all)
        summaries.push_back(f.sums.result());
    return summaries;
}

} // namespace tactor::detail
