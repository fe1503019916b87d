// SPDX-License-Identifier: MIT
// The view peaks: how strongly each tactor plays at which time, for strokes of any length.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/view/number_list.hpp"
#include "server/view/parts.hpp"

namespace tactor::server {
namespace {

constexpr double edge = 1e-9; // of a bin: nearer is at its edge

// Largest amplitude of each tactor in each of some equal parts of the time.
class peak_bins {
public:
    peak_bins(std::size_t tactors, std::size_t bins, double total_s)
        : tactors_(tactors), bins_(bins), step_s_(total_s / static_cast<double>(bins)), peaks_(tactors * bins)
    {
    }

    void add(const burst& b, double onset_s)
    {
        raise(b.drives, std::floor(onset_s / step_s_ + edge),
              std::ceil((onset_s + b.duration_s) / step_s_ - edge) - 1.0);
    }
    // Adds the samples of a curve, and its values at the edges of bins.
    void add(const curve& c, double start_s)
    {
        burst b;
        for (std::uint64_t k = 0; k < c.size(); ++k) {
            c.sample(k, b);
            add_point(b, start_s + c.time_s(k));
        }
        for (auto bin = static_cast<std::size_t>(start_s / step_s_); bin < bins_; ++bin) {
            const double t_s = static_cast<double>(bin) * step_s_ - start_s;
            if (t_s > c.duration_s())
                break;
            if (t_s < 0.0)
                continue;
            c.at(t_s, b);
            add_point(b, start_s + t_s);
        }
    }
    double step_s() const noexcept { return step_s_; }
    const std::vector<double>& peaks() const noexcept { return peaks_; }

private:
    // Adds values at one time. At the edge of two bins they belong to both.
    void add_point(const burst& b, double t_s)
    {
        raise(b.drives, std::ceil(t_s / step_s_ - edge) - 1.0, std::floor(t_s / step_s_ + edge));
    }
    void raise(const std::vector<drive>& drives, double first, double last)
    {
        const auto end = static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, static_cast<double>(bins_)));
        for (auto bin = static_cast<std::size_t>(std::max(0.0, first)); bin < end; ++bin)
            for (const drive& d : drives) {
                double& peak = peaks_[bin * tactors_ + d.tactor];
                peak = std::max(peak, d.amplitude);
            }
    }

    std::size_t tactors_;
    std::size_t bins_;
    double step_s_;
    std::vector<double> peaks_; // a row for each bin
};

} // namespace

std::string add_peaks(net::reply_json& head, const planned& p, std::size_t tactors, std::size_t bins)
{
    peak_bins all(tactors, bins, p.total_s());
    const std::vector<double> starts = p.starts_s();
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        for (const burst& b : one.bursts)
            all.add(b, starts[i] + b.onset_s);
        if (one.curve)
            all.add(*one.curve, starts[i]);
    }
    head["step_s"] = all.step_s();
    number_list peaks("peaks");
    for (const double v : all.peaks())
        peaks.add(v, amplitude_parts);
    return peaks.end();
}

} // namespace tactor::server
