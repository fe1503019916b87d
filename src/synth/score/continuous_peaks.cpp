// SPDX-License-Identifier: MIT
#include "synth/score/continuous_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/trajectory/spans.hpp"
#include "core/words.hpp"
#include "plan/curve_impl.hpp"

namespace tactor::synth {
namespace {

void check_drives(const burst& b, std::size_t tactors)
{
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, "stroke at " + seconds_text(b.onset_s), why);
    };
    for (std::size_t i = 0; i < b.drives.size(); ++i) {
        const drive& d = b.drives[i];
        if (d.tactor >= tactors || !std::isfinite(d.amplitude))
            refuse(fmt::format("tactor {} at amplitude {} cannot be rendered", d.tactor, d.amplitude));
        if (i > 0 && b.drives[i - 1].tactor >= d.tactor)
            refuse(fmt::format("tactor {} after tactor {}", d.tactor, b.drives[i - 1].tactor));
    }
}

} // namespace

std::vector<double> continuous_bounds(const plan& p, std::size_t tactors)
{
    const trajectory* motion = curve_access::of(*p.curve).bounds(tactors);
    if (motion == nullptr)
        return {};
    double greatest = 0.0;
    detail::for_each_span(*motion, [&](const detail::trajectory_span& s) {
        greatest = s.intensity <= greatest ? greatest : s.intensity;
        return std::isfinite(greatest);
    });
    return std::isfinite(greatest) ? std::vector<double>(tactors, greatest) : std::vector<double>{};
}

std::vector<double> continuous_peaks(const plan& p, std::size_t tactors)
{
    std::vector<double> peaks(tactors, 0.0);
    burst now;
    detail::same_tactors seen;
    for (std::uint64_t k = 0; k < p.curve->size(); ++k) {
        curve_access::of(*p.curve).sample(k, seen, now);
        check_drives(now, tactors);
        for (const drive& d : now.drives)
            peaks[d.tactor] = std::max(peaks[d.tactor], std::abs(d.amplitude));
    }
    return peaks;
}

} // namespace tactor::synth
