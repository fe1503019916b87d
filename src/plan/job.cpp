// SPDX-License-Identifier: MIT
#include "plan/job.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/words.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

bool is_collinear(point a, point b, point c)
{
    const double longest = std::max({length_mm(a, b), length_mm(b, c), length_mm(c, a)});
    return std::abs(turn(a, b, c)) <= same_place_mm * longest;
}

// Returns true if p is in the triangle or on an edge, with a tolerance for rounding.
bool holds(point a, point b, point c, point p)
{
    if (turn(a, b, c) < 0.0)
        std::swap(b, c);
    return triangle_distance_mm(a, b, c, p) <= 2.0 * same_place_mm;
}

// Distance, ns, within which a time counts as a whole number of nanoseconds.
constexpr double slack = 1e-4;

std::string seconds(double nanoseconds)
{
    std::string s = fmt::format("{:.9f}", nanoseconds * 1e-9);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.')
        s.pop_back();
    return s;
}

} // namespace

void missed_places::add(const layout& l, const burst& b)
{
    ++all_;
    if (b.drives.size() != 3)
        return;
    const auto at = [&](std::size_t i) { return l.places()[b.drives[i].tactor]; };
    const bool line = is_collinear(at(0), at(1), at(2));
    if (!line && holds(at(0), at(1), at(2), b.position))
        return;
    if (missed_ == 0)
        first_ = b.position;
    ++missed_;
    in_line_ += line ? 1 : 0;
}

std::string missed_places::warning(std::string_view what) const
{
    if (missed_ == 0)
        return {};
    const std::string line =
        in_line_ == 0 ? "" : fmt::format("; for {} of them the three are in one line", in_line_);
    return fmt::format("{} of {} {} outside the triangle of the three closest tactors, first at {}{}: people "
                       "feel them elsewhere (use faces = delaunay)",
                       missed_, counted(all_, what), missed_ == 1 ? "lies" : "lie", place(first_), line);
}

std::string job::name() const
{
    return motion.name.empty() ? "stroke" : fmt::format("stroke \"{}\"", motion.name);
}

void check_burst_count(const job& j, double bursts)
{
    if (bursts > most_bursts)
        throw error(
            error_kind::bad_input, j.name(), fmt::format("it needs {:.3g} bursts", bursts),
            fmt::format("use at most {:.0f}: make the stroke shorter or the SOA longer", most_bursts));
}

burst make_burst(const job& j, double onset_s, double duration_s, point p, double t_s)
{
    burst b;
    b.onset_s = onset_s;
    b.duration_s = duration_s;
    b.position = p;
    b.intensity = j.options.scale.amplitude(j.motion.motion.intensity(t_s));
    compute_drives(*j.model, j.faces, p, b.intensity, j.scratch);
    b.drives.assign(j.scratch.begin(), j.scratch.end());
    return b;
}

point follower::at(double t_s)
{
    const point p = job_.motion.motion.position(t_s);
    if (job_.faces.contains(p)) {
        inside_s_ = t_s;
        return p;
    }
    const point edge = job_.faces.nearest(p);
    if (job_.options.outside == outside_kind::error && distance_mm(p, edge) > edge_tolerance_mm)
        refuse(t_s);
    return edge;
}

double follower::farthest_outside_mm(double from_s) const
{
    constexpr int samples = 2000;
    const trajectory& motion = job_.motion.motion;
    double farthest = 0.0;
    for (int i = 0; i <= samples; ++i) {
        const point p = motion.position(from_s + (motion.duration_s() - from_s) * i / samples);
        farthest = std::max(farthest, distance_mm(p, job_.faces.nearest(p)));
    }
    return farthest;
}

void follower::refuse(double t_s) const
{
    const trajectory& motion = job_.motion.motion;
    const std::string& made_for = job_.motion.made_for;
    const std::string hint =
        "use " + (made_for.empty() ? "" : fmt::format("{{array={}|, or }}", made_for)) +
        "{fit=true| to scale the stroke, or }{outside=clamp} to play the nearest point of the array";
    if (inside_s_ < 0.0)
        throw error(error_kind::bad_input, job_.name(),
                    fmt::format("the path starts outside the array, at {}, and goes {} mm outside",
                                place(motion.position(t_s)), plain_number(farthest_outside_mm(t_s), 3)),
                    hint);
    double in = inside_s_;
    double out = t_s;
    // Bisects until there is no double between the two times, which is well within a micrometre.
    for (double middle = in + (out - in) / 2.0; in < middle && middle < out; middle = in + (out - in) / 2.0)
        (job_.faces.contains(motion.position(middle)) ? in : out) = middle;
    throw error(error_kind::bad_input, job_.name(),
                fmt::format("the path leaves the array at {} after {}, and goes {} mm outside",
                            place(motion.position(in)), seconds_text(in),
                            plain_number(farthest_outside_mm(out), 3)),
                hint);
}

std::vector<conflict> find_conflicts(const std::vector<burst>& bursts)
{
    std::vector<conflict> found;
    struct state {
        double sounds_until_s;
        std::ptrdiff_t last = -1; // index into `found`; -1 for none
    };
    std::vector<std::optional<state>> tactors;
    for (const burst& b : bursts)
        for (const drive& d : b.drives) {
            const double end = b.onset_s + b.duration_s;
            if (d.tactor >= tactors.size())
                tactors.resize(d.tactor + std::size_t{1});
            std::optional<state>& known = tactors[d.tactor];
            if (!known) {
                known = state{end};
                continue;
            }
            state& s = *known;
            const double until = std::min(end, s.sounds_until_s);
            if (until - b.onset_s > same_time_s) {
                if (s.last >= 0 && b.onset_s <= found[static_cast<std::size_t>(s.last)].to_s + same_time_s) {
                    double& to = found[static_cast<std::size_t>(s.last)].to_s;
                    to = std::max(to, until);
                } else {
                    s.last = static_cast<std::ptrdiff_t>(found.size());
                    found.push_back({d.tactor, b.onset_s, until});
                }
            }
            s.sounds_until_s = std::max(s.sounds_until_s, end);
        }
    std::sort(found.begin(), found.end(), [](const conflict& a, const conflict& b) {
        return std::tie(a.from_s, a.tactor) < std::tie(b.from_s, b.tactor);
    });
    return found;
}

std::string format_seconds_up(double t_s)
{
    return seconds(std::ceil(t_s * 1e9 - slack));
}

std::string format_seconds_down(double t_s)
{
    return seconds(std::floor(t_s * 1e9 + slack));
}

std::string place(point p)
{
    // Adding 0 turns -0 into 0.
    const auto micrometres = [](double v) { return std::round(v * 1e3) / 1e3 + 0.0; };
    return fmt::format("({:.3f}, {:.3f}) mm", micrometres(p.x_mm), micrometres(p.y_mm));
}

} // namespace tactor::detail
