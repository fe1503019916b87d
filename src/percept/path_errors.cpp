// SPDX-License-Identifier: MIT
#include "percept/path_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "percept/observer.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

double piece_distance_squared(point p, point a, point b) noexcept
{
    const point off = p - nearest_segment_point(a, b, p);
    return dot(off, off);
}

double box_distance_squared(point p, const box& b) noexcept
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

// Chooses the pieces to search: all pieces of a short path. A long path may go round and round. Of pieces
// that begin in the same square of 0.01 mm, and also end in the same square, chooses only the first.
void target_places::choose_pieces()
{
    const std::size_t all = std::max<std::size_t>(size() - 1, 1);
    if (all <= most_pieces) {
        pieces_.resize(all);
        std::iota(pieces_.begin(), pieces_.end(), 0U);
        return;
    }
    constexpr double squares_per_mm = 100.0; // coordinates of up to 1e6 mm fit into 32 bits
    const auto number = [](double mm) { return static_cast<std::int32_t>(std::floor(mm * squares_per_mm)); };
    std::vector<std::pair<std::array<std::int32_t, 4>, std::uint32_t>> found;
    found.reserve(all);
    for (std::size_t i = 0; i < all; ++i) {
        const point a = at(i);
        const point b = piece_end(i);
        found.push_back({{number(a.x_mm), number(a.y_mm), number(b.x_mm), number(b.y_mm)},
                         static_cast<std::uint32_t>(i)});
    }
    std::sort(found.begin(), found.end());
    for (std::size_t i = 0; i < all; ++i)
        if (i == 0 || found[i].first != found[i - 1].first)
            pieces_.push_back(found[i].second);
    std::sort(pieces_.begin(), pieces_.end());
}

void target_places::make_boxes()
{
    choose_pieces();
    const auto joined = [](const box& a, const box& b) {
        return box{{std::min(a.low.x_mm, b.low.x_mm), std::min(a.low.y_mm, b.low.y_mm)},
                   {std::max(a.high.x_mm, b.high.x_mm), std::max(a.high.y_mm, b.high.y_mm)}};
    };
    std::vector<box> below;
    for (const std::uint32_t i : pieces_)
        below.push_back(bounding_box({at(i), piece_end(i)}));
    do {
        std::vector<box> level;
        for (std::size_t i = 0; i < below.size(); ++i)
            if (i % fan == 0)
                level.push_back(below[i]);
            else
                level.back() = joined(level.back(), below[i]);
        boxes_.push_back(level);
        below = std::move(level);
    } while (below.size() > 1);
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
    if (!(box_distance_squared(p, boxes_[level][i]) < square))
        return;
    if (level > 0) {
        for (std::size_t k = fan * i; k < std::min(fan * (i + 1), boxes_[level - 1].size()); ++k)
            search(level - 1, k, p, square);
        return;
    }
    for (std::size_t k = fan * i; k < std::min(fan * (i + 1), pieces_.size()); ++k)
        square = std::min(square, piece_distance_squared(p, at(pieces_[k]), piece_end(pieces_[k])));
}

double target_places::path_distance_mm(point p, point near) const noexcept
{
    double square = dot(p - near, p - near);
    if (square > same_place_mm * same_place_mm)
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
        last_off_mm_ = targets_.path_distance_mm(felt, targets_.at(i));
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
    // If sums are equal, keep the last: it has the smallest lag.
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
