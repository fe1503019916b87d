// SPDX-License-Identifier: MIT
#include "plot/sound_text.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::plot {
namespace {

std::string describe_range(double low_hz, double high_hz)
{
    return low_hz == high_hz ? plain_number(low_hz) + " Hz"
                             : fmt::format("{} to {} Hz", plain_number(low_hz), plain_number(high_hz));
}

std::string describe_frequency(const plan& p)
{
    if (p.course.empty())
        return describe_range(p.carrier_hz, p.carrier_hz);
    const auto [low, high] =
        std::minmax_element(p.course.begin(), p.course.end(),
                            [](const carrier_point& a, const carrier_point& b) { return a.hz < b.hz; });
    return describe_range(low->hz, high->hz);
}

std::string describe_recording(const plan& p)
{
    const std::string file = std::filesystem::path(waveform_text(p.wave)).filename().string();
    switch (p.wave.texture) {
    case texture_kind::time:
        return file + " in its own time";
    case texture_kind::length:
        return file + " along the path";
    case texture_kind::cycle:
        break;
    }
    return fmt::format("{} at {}", file, describe_frequency(p));
}

std::string describe_waveform(const plan& p)
{
    switch (p.wave.kind) {
    case waveform_kind::sine:
        return describe_frequency(p);
    case waveform_kind::noise:
        return "noise of " + describe_range(p.wave.low_hz, p.wave.high_hz);
    case waveform_kind::recording:
        return describe_recording(p);
    default:
        return fmt::format("{} of {}", to_string(p.wave.kind), describe_frequency(p));
    }
}

} // namespace

std::string describe_phantom(const plan& p)
{
    return p.faces == faces_kind::delaunay ? p.phantom
                                           : fmt::format("{} (faces {})", p.phantom, to_string(p.faces));
}

std::string describe_sound(const plan& p)
{
    std::string text = describe_waveform(p);
    if (p.am.hz > 0.0)
        text += fmt::format(", AM of {} Hz", plain_number(p.am.hz));
    if (p.am.hz > 0.0 && p.am.depth != 1.0)
        text += fmt::format(" and depth {}", plain_number(p.am.depth));
    return text;
}

} // namespace tactor::plot
