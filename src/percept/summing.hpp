// SPDX-License-Identifier: MIT
/// \file
/// How far a prediction is from its target, summed up sample by sample.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <tactor/percept.hpp>

#include "core/distance.hpp"

namespace tactor::detail {

/// Mean and variance in one pass (Welford 1962).
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

class summing {
public:
    /// All but the speed, which may come later: speeds are added in their own order.
    void add(const percept_sample& x)
    {
        ++count_;
        intensity_.add(x.intensity);
        shared_ += x.shared ? 1.0 : 0.0;
        if (!x.felt)
            return;
        ++felt_;
        const double off = length_mm(*x.felt, x.target);
        squares_ += off * off;
        largest_ = std::max(largest_, off);
    }

    /// Of a sample at which something is felt.
    void add_speed(double mm_s) { speed_.add(mm_s); }

    /// A sample whose speed is known where there is one.
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

} // namespace tactor::detail
