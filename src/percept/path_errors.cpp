// SPDX-License-Identifier: MIT
#include "percept/path_errors.hpp"

#include <algorithm>
#include <cmath>

#include "percept/observer.hpp"

namespace tactor::detail {
namespace {

double square_to_piece(point p, point a, point b) noexcept
{
    const point ab = b - a;
    const double length = dot(ab, ab);
    const double u = length > 0.0 ? std::clamp(dot(p - a, ab) / length, 0.0, 1.0) : 0.0;
    const point off = p - (a + u * ab);
    return dot(off, off);
}

double square_to_box(point p, const box& b) noexcept
{
    const double x = std::max({b.low.x_mm - p.x_mm, 0.0, p.x_mm - b.high.x_mm});
    const double y = std::max({b.low.y_mm - p.y_mm, 0.0, p.y_mm - b.high.y_mm});
    return x * x + y * y;
}

} // namespace

target_places::target_places(const trajectory& m)
{
    const std::size_t count = count_percept_samples(m.duration_s());
    x_mm_.reserve(count + lag_count - 1);
    y_mm_.reserve(count + lag_count - 1);
    for (std::size_t i = 0; i < count; ++i)
        add(m.position(static_cast<double>(i) * percept_step_s));
    make_boxes();
}

target_places::target_places(const std::vector<percept_sample>& samples)
{
    x_mm_.reserve(samples.size() + lag_count - 1);
    y_mm_.reserve(samples.size() + lag_count - 1);
    for (const percept_sample& x : samples)
        add(x.target);
    make_boxes();
}

void target_places::add(point p)
{
    const std::size_t times = x_mm_.empty() ? lag_count : 1;
    x_mm_.insert(x_mm_.end(), times, p.x_mm);
    y_mm_.insert(y_mm_.end(), times, p.y_mm);
}

void target_places::make_boxes()
{
    std::vector<box> level;
    // Neighbouring boxes share the place between them.
    for (std::size_t first = 0; first == 0 || first + 1 < size(); first += fan) {
        box b{at(first), at(first)};
        for (std::size_t i = first; i < std::min(first + fan + 1, size()); ++i) {
            b.low = {std::min(b.low.x_mm, at(i).x_mm), std::min(b.low.y_mm, at(i).y_mm)};
            b.high = {std::max(b.high.x_mm, at(i).x_mm), std::max(b.high.y_mm, at(i).y_mm)};
        }
        level.push_back(b);
    }
    boxes_.push_back(std::move(level));
    while (boxes_.back().size() > 1) {
        std::vector<box> above;
        for (std::size_t i = 0; i < boxes_.back().size(); ++i) {
            const box& b = boxes_.back()[i];
            if (i % fan == 0)
                above.push_back(b);
            box& all = above.back();
            all.low = {std::min(all.low.x_mm, b.low.x_mm), std::min(all.low.y_mm, b.low.y_mm)};
            all.high = {std::max(all.high.x_mm, b.high.x_mm), std::max(all.high.y_mm, b.high.y_mm)};
        }
        boxes_.push_back(std::move(above));
    }
}

std::optional<point> target_places::direction(std::size_t i) const noexcept
{
    const point step = at(std::min(i + 1, size() - 1)) - at(i > 0 ? i - 1 : 0);
    const double length = std::sqrt(dot(step, step));
    if (!(length > same_place_mm))
        return {};
    return point{step.x_mm / length, step.y_mm / length};
}

void target_places::search(std::size_t level, std::size_t i, point p, double& square) const noexcept
{
    if (!(square_to_box(p, boxes_[level][i]) < square))
        return;
    if (level > 0) {
        for (std::size_t k = fan * i; k < std::min(fan * (i + 1), boxes_[level - 1].size()); ++k)
            search(level - 1, k, p, square);
        return;
    }
    for (std::size_t k = fan * i; k < std::min(fan * (i + 1), size() - 1); ++k)
        square = std::min(square, square_to_piece(p, at(k), at(k + 1)));
}

double target_places::off_path_mm(point p, point near) const noexcept
{
    double square = dot(p - near, p - near);
    search(boxes_.size() - 1, 0, p, square);
    return std::sqrt(square);
}

std::optional<point> path_errors::last_direction(std::size_t i)
{
    for (; next_ <= i || (!direction_ && next_ < targets_.size()); ++next_)
        if (const std::optional<point> d = targets_.direction(next_))
            direction_ = d;
    return direction_;
}

void path_errors::add(std::size_t i, target_window window, point felt)
{
    for (std::size_t k = 0; k < lag_count; ++k) {
        const double x = felt.x_mm - window.x_mm[k];
        const double y = felt.y_mm - window.y_mm[k];
        lagged_[k] += x * x + y * y;
    }
    ++felt_;
    const point target{window.x_mm[lag_count - 1], window.y_mm[lag_count - 1]};
    largest_ = std::max(largest_, length_mm(felt, target));
    if (const std::optional<point> d = last_direction(i)) {
        const point off = felt - target;
        const double along = dot(off, *d);
        const double across = off.x_mm * d->y_mm - off.y_mm * d->x_mm;
        along_ += along * along;
        across_ += across * across;
        along_max_ = std::max(along_max_, std::abs(along));
        across_max_ = std::max(across_max_, std::abs(across));
    }
    if (last_felt_ != felt) {
        last_felt_ = felt;
        last_off_mm_ = targets_.off_path_mm(felt, targets_.at(i));
    }
    off_path_ += last_off_mm_ * last_off_mm_;
}

void path_errors::report(percept_summary& r) const
{
    if (!(felt_ > 0.0))
        return;
    const auto rms = [this](double squares) { return std::sqrt(squares / felt_); };
    r.rms_error_mm = rms(lagged_.back());
    r.largest_error_mm = largest_;
    // The last of equal sums has the smallest lag.
    std::size_t best = lag_count - 1;
    for (std::size_t k = lag_count - 1; k-- > 0;)
        if (lagged_[k] < lagged_[best])
            best = k;
    r.lag_s = static_cast<double>(lag_count - 1 - best) * percept_step_s;
    r.rms_at_lag_mm = rms(lagged_[best]);
    r.rms_to_path_mm = rms(off_path_);
    if (!direction_)
        return;
    r.along_rms_mm = rms(along_);
    r.along_max_mm = along_max_;
    r.across_rms_mm = rms(across_);
    r.across_max_mm = across_max_;
}

} // namespace tactor::detail
