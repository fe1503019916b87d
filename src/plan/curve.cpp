// SPDX-License-Identifier: MIT
#include <tactor/plan.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/trajectory/impl.hpp"
#include "core/words.hpp"
#include "plan/curve_impl.hpp"

namespace tactor::detail {
namespace {

// Distance in steps within which a time counts as the time of a sample.
constexpr double same_step = same_time_s / continuous_step_s;

void scale(burst& b, double factor)
{
    b.intensity *= factor;
    for (drive& d : b.drives)
        d.amplitude *= factor;
}

class scaled_curve final : public curve::impl {
public:
    scaled_curve(const curve& from, double factor) : impl(from.duration_s()), from_(from), factor_(factor)
    {
        if (const trajectory* b = curve_access::of(from_).bounding_motion(max_channels))
            bounds_ = scale_intensity(*b, factor);
    }

    void fill(std::uint64_t k, same_tactors& seen, burst& out) const override
    {
        curve_access::of(from_).fill(k, seen, out);
        scale(out, factor_);
    }
    const trajectory* bounding_motion(std::size_t tactors) const noexcept override
    {
        return curve_access::of(from_).bounding_motion(tactors) != nullptr ? &*bounds_ : nullptr;
    }

private:
    curve from_;
    double factor_;
    std::optional<trajectory> bounds_;
};

} // namespace

std::uint64_t count_samples(double duration_s) noexcept
{
    return static_cast<std::uint64_t>(std::ceil(duration_s / continuous_step_s - same_step)) + 1;
}

double sample_time_s(std::uint64_t k, double duration_s) noexcept
{
    return std::min(static_cast<double>(k) * continuous_step_s, duration_s);
}

plan scale_plan(plan p, double factor)
{
    for (burst& b : p.bursts)
        scale(b, factor);
    if (p.curve)
        p.curve = curve_access::make(std::make_shared<scaled_curve>(*p.curve, factor));
    return p;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {
namespace {

class sampled final : public curve::impl {
public:
    sampled(double duration, curve_samples all) : impl(duration), all_(std::move(all)) {}

    void fill(std::uint64_t k, detail::same_tactors&, burst& out) const override
    {
        const auto i = static_cast<std::size_t>(k);
        const drive* first = all_.drives.data() + (i == 0 ? 0 : all_.ends[i - 1]);
        out.position = all_.positions[i];
        out.intensity = all_.intensities[i];
        out.drives.assign(first, all_.drives.data() + all_.ends[i]);
    }

private:
    curve_samples all_;
};

[[noreturn]] void refuse_sample(std::size_t sample, const std::string& why)
{
    throw error(error_kind::bad_input, fmt::format("curve: sample {}", sample), why);
}

void check_sample(const curve_samples& s, std::size_t i, std::size_t first)
{
    for (const double v : {s.positions[i].x_mm, s.positions[i].y_mm, s.intensities[i]})
        if (!std::isfinite(v))
            refuse_sample(i, fmt::format("{} is not a finite number", v));
    if (s.ends[i] < first || s.ends[i] > s.drives.size())
        refuse_sample(i, fmt::format("its drives end at {} of {}", s.ends[i], s.drives.size()));
    for (std::size_t k = first; k < s.ends[i]; ++k) {
        const drive& d = s.drives[k];
        if (!std::isfinite(d.amplitude))
            refuse_sample(i, fmt::format("the amplitude of tactor {} is {}", d.tactor, d.amplitude));
        if (k > first && s.drives[k - 1].tactor >= d.tactor)
            refuse_sample(i,
                          fmt::format("tactor {} comes after tactor {}", d.tactor, s.drives[k - 1].tactor));
    }
}

std::shared_ptr<const curve::impl> make_samples(double duration_s, curve_samples s)
{
    if (!(duration_s > 0.0 && duration_s <= detail::longest_stroke_s))
        throw error(error_kind::bad_input, "curve", fmt::format("it lasts {:g} s", duration_s),
                    fmt::format("use more than 0 and at most {:g} s", detail::longest_stroke_s))
            .with_field("duration_s");
    const std::uint64_t size = detail::count_samples(duration_s);
    if (s.positions.size() != size || s.intensities.size() != size || s.ends.size() != size)
        throw error(
            error_kind::bad_input, "curve",
            fmt::format("{} needs {} samples, but there are {} positions, {} intensities and {} drive ends",
                        seconds_text(duration_s), size, s.positions.size(), s.intensities.size(),
                        s.ends.size()),
            fmt::format("give {} of each", size));
    std::size_t first = 0;
    for (std::size_t i = 0; i < s.ends.size(); ++i) {
        check_sample(s, i, first);
        first = s.ends[i];
    }
    return std::make_shared<sampled>(duration_s, std::move(s));
}

// Moves `here` towards `next` by a part of the difference, 0 to 1. A tactor that only one of the bursts
// drives has amplitude 0 in the other burst.
void mix(burst& here, const burst& next, double part)
{
    std::vector<drive> drives;
    auto a = here.drives.cbegin();
    auto b = next.drives.cbegin();
    while (a != here.drives.cend() || b != next.drives.cend()) {
        if (b == next.drives.cend() || (a != here.drives.cend() && a->tactor < b->tactor)) {
            drives.push_back({a->tactor, a->amplitude * (1.0 - part)});
            ++a;
        } else if (a == here.drives.cend() || b->tactor < a->tactor) {
            drives.push_back({b->tactor, b->amplitude * part});
            ++b;
        } else {
            drives.push_back({a->tactor, std::lerp(a->amplitude, b->amplitude, part)});
            ++a;
            ++b;
        }
    }
    here.drives = std::move(drives);
    here.position = {std::lerp(here.position.x_mm, next.position.x_mm, part),
                     std::lerp(here.position.y_mm, next.position.y_mm, part)};
    here.intensity = std::lerp(here.intensity, next.intensity, part);
}

} // namespace

void curve_samples::add(const burst& b)
{
    positions.push_back(b.position);
    intensities.push_back(b.intensity);
    drives.insert(drives.end(), b.drives.begin(), b.drives.end());
    ends.push_back(drives.size());
}

curve::impl::impl(double duration) : duration_s(duration), size(detail::count_samples(duration))
{
}

void curve::impl::sample(std::uint64_t k, detail::same_tactors& seen, burst& out) const
{
    const std::uint64_t i = std::min(k, size - 1);
    fill(i, seen, out);
    out.onset_s = detail::sample_time_s(i, duration_s);
    out.duration_s = 0.0;
    out.tau_s.reset();
}

curve::curve(double duration_s, curve_samples samples) : impl_(make_samples(duration_s, std::move(samples)))
{
}

double curve::duration_s() const noexcept
{
    return impl_->duration_s;
}

std::uint64_t curve::size() const noexcept
{
    return impl_->size;
}

double curve::time_s(std::uint64_t k) const noexcept
{
    return detail::sample_time_s(k, impl_->duration_s);
}

void curve::sample(std::uint64_t k, burst& out) const
{
    detail::same_tactors nowhere{.skips = 1}; // for one sample, update_same_tactors() would waste time
    impl_->sample(k, nowhere, out);
}

void curve::at(double t_s, burst& out) const
{
    const double t = t_s > 0.0 ? std::min(t_s, impl_->duration_s) : 0.0;
    const auto k = static_cast<std::uint64_t>(t / continuous_step_s + detail::same_step);
    sample(k, out);
    const double here = detail::sample_time_s(k, impl_->duration_s);
    if (t - here <= detail::same_time_s || k + 1 >= impl_->size)
        return;
    burst next;
    sample(k + 1, next);
    mix(out, next, (t - here) / (next.onset_s - here));
    out.onset_s = t;
}

bool operator==(const curve& a, const curve& b)
{
    if (a.impl_ == b.impl_)
        return true;
    if (a.duration_s() != b.duration_s())
        return false;
    burst x;
    burst y;
    for (std::uint64_t k = 0; k < a.size(); ++k) {
        a.sample(k, x);
        b.sample(k, y);
        if (x != y)
            return false;
    }
    return true;
}

} // namespace v0
} // namespace tactor
