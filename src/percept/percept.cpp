// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/path/shape.hpp"
#include "core/words.hpp"
#include "percept/observer.hpp"
#include "percept/path_errors.hpp"

namespace tactor::detail {
namespace {

constexpr double never_s = std::numeric_limits<double>::infinity();

double burst_end_s(const burst& b)
{
    return b.onset_s + b.duration_s;
}

// State of a plan at ascending times. The state is computed again only when a burst begins or ends.
class sounding {
public:
    // Starts before the plan. Array and plan must outlive this object. `end_s`: end of the movement. `gains`:
    // gain of each tactor; may be empty.
    sounding(const array& a, const plan& p, double end_s, std::vector<double> gains)
        : tactors_(a),
          plan_(p),
          end_s_(end_s),
          gains_(std::move(gains)),
          first_end_s_(never_s),
          parts_(a.tactors.size())
    {
    }

    // Fills in felt, intensity and shared. Times must ascend.
    // \throws error (bad_input) if the plan names a tactor that the array does not have.
    void at(double t_s, percept_sample& out)
    {
        if (plan_.curve) {
            plan_.curve->at(t_s, sampled_);
            add(sampled_);
            sum_drives();
        } else {
            const bool begun = begin_bursts(t_s);
            const bool ended = end_bursts(t_s);
            if (begun || ended) {
                for (const std::size_t i : active_)
                    add(plan_.bursts[i]);
                sum_drives();
            }
        }
        out.felt = now_.felt;
        out.intensity = now_.intensity;
        out.shared = now_.shared;
    }

private:
    // Bursts that sound on one tactor.
    struct part {
        unsigned bursts = 0;
        double energy = 0.0;
        double sum = 0.0;
        double largest = 0.0;
        double intensity = 0.0;
    };
    struct state {
        std::optional<point> felt = {};
        double intensity = 0.0;
        bool shared = false;
    };

    bool begin_bursts(double t_s)
    {
        const std::size_t before = next_;
        for (; next_ < plan_.bursts.size() && plan_.bursts[next_].onset_s <= t_s + same_time_s; ++next_) {
            active_.push_back(next_);
            first_end_s_ = std::min(first_end_s_, burst_end_s(plan_.bursts[next_]));
        }
        return next_ != before;
    }

    bool end_bursts(double t_s)
    {
        if (first_end_s_ > t_s + same_time_s)
            return false;
        // The Tactile Brush's last burst ends with the movement, and the burst before it often ends later.
        // Both bursts still count at the last sample.
        const bool begun = next_ > 0 && plan_.bursts[next_ - 1].onset_s >= t_s - same_time_s;
        const bool closing = t_s > end_s_ - same_time_s && !begun;
        const double limit_s = closing ? t_s - same_time_s : t_s + same_time_s;
        std::erase_if(active_, [&](std::size_t i) { return burst_end_s(plan_.bursts[i]) <= limit_s; });
        first_end_s_ = never_s;
        for (const std::size_t i : active_)
            first_end_s_ = std::min(first_end_s_, burst_end_s(plan_.bursts[i]));
        return true;
    }

    void add(const burst& b)
    {
        for (const drive& d : b.drives) {
            if (d.tactor >= parts_.size())
                refuse_tactor(tactors_, d.tactor);
            part& x = parts_[d.tactor];
            if (x.bursts == 0)
                touched_.push_back(d.tactor);
            ++x.bursts;
            x.energy += d.amplitude * d.amplitude;
            x.sum += d.amplitude;
            x.largest = std::max(x.largest, d.amplitude);
            x.intensity = std::max(x.intensity, b.intensity);
        }
    }

    double amplitude(const part& x) const
    {
        if (x.bursts == 1 || plan_.overlap == overlap_kind::sum)
            return x.sum;
        return plan_.overlap == overlap_kind::max ? x.largest : std::min(x.intensity, std::sqrt(x.energy));
    }

    void sum_drives()
    {
        now_ = {};
        double energy = 0.0;
        point moment;
        for (const unsigned i : touched_) {
            const double a = amplitude(parts_[i]) * (gains_.empty() ? 1.0 : gains_[i]);
            energy += a * a;
            moment.x_mm += a * a * tactors_.tactors[i].position.x_mm;
            moment.y_mm += a * a * tactors_.tactors[i].position.y_mm;
            now_.shared = now_.shared || parts_[i].bursts > 1;
            parts_[i] = {};
        }
        touched_.clear();
        now_.intensity = std::sqrt(energy);
        if (energy > 0.0)
            now_.felt = point{moment.x_mm / energy, moment.y_mm / energy};
    }

    const array& tactors_;
    const plan& plan_;
    double end_s_;
    std::vector<double> gains_;       // by tactor; empty if all are 1
    std::size_t next_ = 0;            // the first burst that has not begun
    std::vector<std::size_t> active_; // bursts that sound
    double first_end_s_;              // earliest end of the active bursts
    std::vector<part> parts_;         // by tactor; zero if the tactor is not in touched_
    std::vector<unsigned> touched_;
    burst sampled_; // sample of a continuous plan
    state now_;
};

} // namespace

std::size_t count_percept_samples(double duration_s)
{
    if (!(duration_s <= longest_percept_s))
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("it lasts {}, too long for a prediction", seconds_text(duration_s)),
                    fmt::format("use at most {} s", longest_percept_s));
    return static_cast<std::size_t>((duration_s + same_time_s) / percept_step_s) + 1;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {
namespace {

percept_sample target_at(const stroke& s, std::size_t i)
{
    percept_sample x;
    x.t_s = static_cast<double>(i) * percept_step_s;
    x.target = s.motion.position(x.t_s);
    x.target_intensity = s.motion.intensity(x.t_s);
    return x;
}

/// Speed of the felt position, computed while samples arrive in order. The speed of a sample is known when
/// the window around it has passed. During silence, the position does not change.
class running_speed {
public:
    /// Samples on either side of the middle of the window.
    static constexpr std::size_t half_window = 50;
    static_assert(percept_window_s == 2 * half_window * percept_step_s);
    /// Number of samples by which the speed that next() returns is late.
    static constexpr std::size_t delay = half_window + 1;

    std::optional<double> next(const std::optional<point>& felt)
    {
        if (count_ == 0) {
            if (!felt)
                return {};
            origin_ = *felt;
        }
        held_ = felt.value_or(held_);
        // Sums positions relative to the first position, for precision.
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

    std::size_t count_ = 0; // number of samples from the first felt position on
    point origin_;
    point held_;
    std::array<point, capacity> sums_{}; // sum of the first j positions, at j % capacity
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

/// Summary of a percept, computed sample by sample.
class summing {
public:
    /// `targets`: targets of the samples; must outlive this object.
    explicit summing(const detail::target_places& targets) : errors_(targets) {}

    /// Adds the next sample without the speed. add_speed() may add the speed later.
    void add(const percept_sample& x)
    {
        intensity_.add(x.intensity);
        shared_ += x.shared ? 1 : 0;
        if (x.felt) {
            ++felt_;
            errors_.add(count_, *x.felt);
        }
        ++count_;
    }

    /// Adds the speed of a sample at which something is felt.
    void add_speed(double mm_s) { speed_.add(mm_s); }

    percept_summary result() const
    {
        const auto count = static_cast<double>(count_);
        percept_summary r;
        errors_.report(r);
        r.speed_cv = speed_.coefficient_of_variation();
        r.intensity_cv = intensity_.coefficient_of_variation();
        r.silent_share = static_cast<double>(count_ - felt_) / count;
        r.shared_share = static_cast<double>(shared_) / count;
        return r;
    }

private:
    detail::path_errors errors_;
    moments speed_;
    moments intensity_;
    std::size_t count_ = 0;
    std::size_t felt_ = 0;
    std::size_t shared_ = 0;
};

} // namespace

void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                    const std::function<void(const percept_sample&)>& each)
{
    constexpr std::size_t delay = running_speed::delay;
    const std::size_t count = detail::count_percept_samples(s.motion.duration_s());
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
    samples.reserve(detail::count_percept_samples(s.motion.duration_s()));
    follow_percept(a, s, p, who, [&](const percept_sample& x) { samples.push_back(x); });
    return samples;
}

percept_summary summarise(const array& a, const stroke& s, const plan& p, const person& who)
{
    return detail::predict_summary(a, detail::target_places(s.motion), s.motion.duration_s(), p, who);
}

percept_summary summarise(const std::vector<percept_sample>& samples)
{
    if (samples.empty())
        return {};
    const detail::target_places targets(samples);
    summing sums(targets);
    for (const percept_sample& x : samples) {
        sums.add(x);
        if (x.felt && x.speed_mm_s)
            sums.add_speed(*x.speed_mm_s);
    }
    return sums.result();
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

percept_summary predict_summary(const array& a, const target_places& targets, double duration_s,
                                const plan& p, const person& who,
                                const std::function<void(const percept_sample&)>& each)
{
    const array felt_at = felt_array(a, who);
    sounding now(felt_at, p, duration_s, person_gains(a, who));
    running_speed speed;
    summing sums(targets);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        percept_sample x{.t_s = static_cast<double>(i) * percept_step_s, .target = targets.at(i)};
        now.at(x.t_s, x);
        sums.add(x);
        if (const auto v = speed.next(x.felt); v && speed.was_felt())
            sums.add_speed(*v);
        if (each)
            each(x);
    }
    return sums.result();
}

} // namespace tactor::detail
