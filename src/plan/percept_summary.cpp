// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <tactor/percept.hpp>

namespace tactor {
namespace {

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

} // namespace

percept_summary summarise(const std::vector<percept_sample>& samples)
{
    percept_summary r;
    moments speed;
    moments intensity;
    double squares = 0.0;
    double felt = 0.0;
    double shared = 0.0;
    for (const percept_sample& x : samples) {
        intensity.add(x.intensity);
        shared += x.shared ? 1.0 : 0.0;
        if (!x.felt)
            continue;
        ++felt;
        const double error = distance_mm(*x.felt, x.target);
        squares += error * error;
        r.largest_error_mm = std::max(r.largest_error_mm.value_or(0.0), error);
        if (x.speed_mm_s)
            speed.add(*x.speed_mm_s);
    }
    if (samples.empty())
        return r;
    const double count = static_cast<double>(samples.size());
    if (felt > 0.0)
        r.rms_error_mm = std::sqrt(squares / felt);
    r.speed_cv = speed.coefficient_of_variation();
    r.intensity_cv = intensity.coefficient_of_variation();
    r.silent_share = (count - felt) / count;
    r.shared_share = shared / count;
    return r;
}

} // namespace tactor
