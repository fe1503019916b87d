// SPDX-License-Identifier: MIT
#include "holds.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include <tactor/phantom.hpp>

namespace tactor::fuzz {
namespace {

constexpr double farthest_mm = 1e6 * (1.0 + 1e-9);

void check_place(point p)
{
    HOLDS(std::abs(p.x_mm) <= farthest_mm);
    HOLDS(std::abs(p.y_mm) <= farthest_mm);
}

void check_ascending(const std::vector<double>& v, double last)
{
    HOLDS(std::is_sorted(v.begin(), v.end()));
    HOLDS(v.empty() || (v.front() >= 0.0 && v.back() <= last));
}

void check_drives(const std::vector<drive>& drives, std::size_t tactors, double intensity)
{
    for (std::size_t i = 0; i < drives.size(); ++i) {
        HOLDS(drives[i].tactor < tactors);
        HOLDS(i == 0 || drives[i - 1].tactor < drives[i].tactor);
        HOLDS(drives[i].amplitude > 0.0);
        HOLDS(drives[i].amplitude <= intensity * (1.0 + 1e-9));
    }
}

void check_burst(const burst& b, std::size_t tactors)
{
    HOLDS(b.onset_s >= 0.0 && std::isfinite(b.onset_s));
    HOLDS(b.duration_s > 0.0 && std::isfinite(b.duration_s));
    HOLDS(b.intensity >= 0.0 && std::isfinite(b.intensity));
    HOLDS(!b.tau_s || std::isfinite(*b.tau_s));
    check_place(b.position);
    check_drives(b.drives, tactors, b.intensity);
}

void check_faces(const layout& l)
{
    for (const auto& face : l.faces()) {
        HOLDS(!face.empty());
        for (const unsigned t : face)
            HOLDS(t < l.places().size());
    }
}

} // namespace

void check_array(const array& a)
{
    validate(a);
    HOLDS(a.channels() >= a.tactors.size());
    if (a.tactors.size() > 300)
        return;
    const auto made = accepted([&] { return std::optional(layout(a)); });
    if (!made)
        return; // two tactors too near for an array of this extent
    const layout& l = *made;
    check_faces(l);
    HOLDS(l.pitch_mm() >= 0.0 && std::isfinite(l.pitch_mm()));
    std::vector<drive> drives;
    for (const phantom_kind k : {phantom_kind::inverse_distance, phantom_kind::barycentric,
                                 phantom_kind::linear, phantom_kind::log, phantom_kind::gaussian}) {
        const auto model = make_phantom(k, l);
        for (const point p : l.places()) {
            HOLDS(l.contains(p));
            model->weights(p, 1.0, drives);
            HOLDS(!drives.empty());
            check_drives(drives, a.tactors.size(), 1.0);
        }
    }
}

void check_path(const path& p)
{
    HOLDS(p.length_mm() >= 0.0 && std::isfinite(p.length_mm()));
    for (int i = 0; i <= 8; ++i) {
        const point at = p.at(p.length_mm() * i / 8.0);
        check_place(at);
        check_ascending(p.meets_x(at.x_mm), p.length_mm());
        check_ascending(p.meets_y(at.y_mm), p.length_mm());
    }
}

void check_stroke(const stroke& s)
{
    const trajectory& m = s.motion;
    HOLDS(m.duration_s() > 0.0 && m.duration_s() <= 86400.0);
    HOLDS(m.length_mm() >= 0.0 && std::isfinite(m.length_mm()));
    HOLDS(!s.start_s || std::isfinite(*s.start_s));
    HOLDS(!s.start_s || *s.start_s >= 0.0 || s.anchor.from != start_from_kind::piece);
    HOLDS(s.anchor.back >= 1);
    HOLDS(!s.sound.carrier_hz || (*s.sound.carrier_hz > 0.0 && std::isfinite(*s.sound.carrier_hz)));
    for (int i = 0; i <= 8; ++i) {
        const double t = m.duration_s() * i / 8.0;
        const point at = m.position(t);
        check_place(at);
        HOLDS(m.intensity(t) >= 0.0 && std::isfinite(m.intensity(t)));
        check_ascending(m.meets_x(at.x_mm), m.duration_s());
        check_ascending(m.meets_y(at.y_mm), m.duration_s());
    }
}

void check_plan(const array& a, const stroke& s, const plan_options& o, const plan& p)
{
    HOLDS(p.stroke_duration_s == s.motion.duration_s());
    HOLDS(p.total_s > 0.0 && std::isfinite(p.total_s));
    for (std::size_t i = 0; i < p.bursts.size(); ++i) {
        const burst& b = p.bursts[i];
        check_burst(b, a.tactors.size());
        HOLDS(i == 0 || p.bursts[i - 1].onset_s <= b.onset_s);
        HOLDS(b.onset_s + b.duration_s <= p.total_s + 1e-9);
    }
    for (const conflict& c : p.conflicts) {
        HOLDS(c.tactor < a.tactors.size());
        HOLDS(c.from_s < c.to_s && c.from_s >= 0.0 && c.to_s <= p.total_s + 1e-9);
    }
    if (o.algorithm == algorithm_kind::park2016) {
        HOLDS(p.conflicts.empty());
        HOLDS(!p.bursts.empty());
    }
    HOLDS((o.algorithm == algorithm_kind::continuous) == p.curve.has_value());
    if (!p.curve)
        return;
    burst now;
    for (int i = 0; i <= 8; ++i) {
        p.curve->at(p.stroke_duration_s * i / 8.0, now);
        HOLDS(now.intensity >= 0.0 && std::isfinite(now.intensity));
        check_place(now.position);
        check_drives(now.drives, a.tactors.size(), now.intensity);
    }
}

void check_samples(const score& s)
{
    renderer r(s, format_kind::float32);
    constexpr std::size_t block = 256;
    std::vector<std::byte> bytes(block * s.channels() * sizeof(float));
    for (int i = 0; i < 8; ++i) {
        r.process(bytes);
        for (std::size_t at = 0; at < bytes.size(); at += sizeof(float)) {
            float x = 0.0F;
            std::memcpy(&x, bytes.data() + at, sizeof x);
            HOLDS(std::abs(x) <= 1.0F);
        }
    }
}

} // namespace tactor::fuzz
