// SPDX-License-Identifier: MIT
#include "cli/check/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/figure.hpp"
#include "session/device.hpp"
#include "session/environment.hpp"
#include "session/walk.hpp"

namespace tactor::cli {
namespace {

// Smallest plausible distance. Tactors are discs of at least 5 mm, so smaller distances are probably not in
// mm.
constexpr double closest_mm = 4.0;
constexpr double widest_mm = 2000.0;
// Width of a trunk or a leg, which is greater than that of any hand or forearm.
constexpr double trunk_mm = 150.0;

struct spread {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();

    void add(double v)
    {
        least = std::min(least, v);
        most = std::max(most, v);
    }
    // Returns the range as text, or a single value if both ends are practically equal.
    std::string text(const char* unit) const
    {
        return most - least < 0.05 ? fmt::format("{:.4g} {}", least, unit)
                                   : fmt::format("{:.4g} to {:.4g} {}", least, most, unit);
    }
};

// Returns the range of the distances between tactors and their nearest neighbours.
spread neighbours(const array& a)
{
    spread all;
    for (const tactor_spec& t : a.tactors) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const tactor_spec& other : a.tactors)
            if (&other != &t)
                nearest = std::min(nearest, distance_mm(other.position, t.position));
        all.add(nearest);
    }
    return all;
}

std::string shape(const array& a)
{
    if (const auto grid = find_grid(a))
        return fmt::format("{} x {}", grid->y_mm.size(), grid->x_mm.size());
    return "no grid";
}

finding check_places(const array& a)
{
    const auto [low, high] = session::find_bounds(a);
    const std::size_t n = a.tactors.size();
    if (n == 1)
        return warning("array", fmt::format("{}: 1 tactor, so nothing moves", a.name),
                       "a stroke needs two or more");
    const spread d = neighbours(a);
    const double width = high.x_mm - low.x_mm;
    const double height = high.y_mm - low.y_mm;
    const std::string found = fmt::format("{}: {} tactors, {}, {:.4g} x {:.4g} mm, neighbours {} apart",
                                          a.name, n, shape(a), width, height, d.text("mm"));
    if (d.least < closest_mm || std::max(width, height) > widest_mm)
        return warning("array", found, "places are in millimetres: see x_mm, y_mm and pitch_mm");
    // Sources: Plaisier et al., Perception 2024; Lee, Scientific Reports 2025.
    if (std::min(width, height) >= trunk_mm)
        return passed(
            "array", found,
            "people distinguish places on the back about twice as well across the body as along it, "
            "so rows may be further apart than columns; on trunk and shank people followed a circle "
            "best with --phantom linear");
    return passed("array", found);
}

finding check_channels(const render_options& r, const array& a)
{
    std::vector<unsigned> used;
    for (const tactor_spec& t : a.tactors)
        used.push_back(t.channel);
    std::sort(used.begin(), used.end());
    const bool no_gap = used.back() - used.front() + 1 == used.size();
    std::string found =
        fmt::format("{} of {} {}: {}", used.size(), counted(r.channels, "channel"),
                    used.size() == 1 ? "drives a tactor" : "drive tactors",
                    no_gap && used.size() > 2 ? fmt::format("{} to {}", used.front(), used.back())
                                              : fmt::format("{}", fmt::join(used, ", ")));
    if (r.marker_channel)
        found += fmt::format("; {} marks strokes", *r.marker_channel);
    return passed("channels", found);
}

// Frequency at which thresholds are compared with levels, Hz. A tactor may have thresholds at several
// frequencies.
constexpr double usual_hz = 250.0;

// Returns the range of the tactors' peaks for intensity 1, dBFS.
spread peaks(const render_options& r, const array& a)
{
    spread s;
    for (const tactor_spec& t : a.tactors)
        s.add(r.sl_db ? threshold_at(t, usual_hz).value_or(0.0) + *r.sl_db : r.level_dbfs + t.gain_db);
    return s;
}

// Returns the numbers of the tactors for which `take` returns true.
template <class F>
std::vector<std::size_t> select_tactors(const array& a, F&& take)
{
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (take(a.tactors[i]))
            all.push_back(i);
    return all;
}

finding check_levels(const render_options& r, const array& a, const plan_options& p)
{
    try {
        // Throws the same error as play if the level is refused. Another function checks the carrier.
        score(a, session::walk_plans(a, std::min(p.carrier_hz, r.rate / 4.0)), r);
    } catch (const error& e) {
        return failure("levels", e);
    }
    const std::string found = fmt::format("peaks of {}{}", peaks(r, a).text("dBFS"),
                                          r.sl_db ? fmt::format(", {} dB SL", *r.sl_db) : "");
    const auto unmeasured =
        select_tactors(a, [](const tactor_spec& t) { return !threshold_at(t, usual_hz); });
    if (unmeasured.size() != a.tactors.size() && !unmeasured.empty())
        return warning("levels",
                       fmt::format("{}; tactors {} have no threshold", found, fmt::join(unmeasured, ", ")),
                       "measure threshold_dbfs of all tactors: --sl refuses strokes that drive these");
    const auto unfelt = select_tactors(a, [&](const tactor_spec& t) {
        return !r.sl_db && r.level_dbfs + t.gain_db <= threshold_at(t, usual_hz).value_or(-HUGE_VAL);
    });
    if (!unfelt.empty())
        return warning(
            "levels",
            fmt::format("{}; not above the threshold of tactors {}", found, fmt::join(unfelt, ", ")),
            "raise --level-dbfs or gain_db, or use --sl");
    return passed("levels", found);
}

// Returns the default values of those limits that a file or an option has weakened.
std::vector<std::string> list_raised_limits(const drive_limits& l, std::size_t tactors)
{
    const drive_limits usual;
    std::vector<std::string> all;
    const double all_full = 10.0 * std::log10(static_cast<double>(tactors)); // all tactors at full scale
    if (std::min(l.power_dbfs, all_full) > usual.power_dbfs)
        all.push_back(fmt::format("power_dbfs = {:.3g}", usual.power_dbfs));
    if (l.max_drive_s > usual.max_drive_s || l.max_drive_s / l.window_s > usual.max_drive_s / usual.window_s)
        all.push_back(
            fmt::format("max_drive_s = {:.4g}, window_s = {:.4g}", usual.max_drive_s, usual.window_s));
    return all;
}

std::string limit_text(const drive_limits& l)
{
    const std::string power =
        fmt::format("all together at most {:+.3g} dB above one at full scale", l.power_dbfs);
    return l.max_drive_s < l.window_s
               ? fmt::format("{}; each at most {:.4g} s in {:.4g} s", power, l.max_drive_s, l.window_s)
               : fmt::format("{}; no limit on time", power);
}

finding check_limits(const drive_limits& l, std::size_t tactors)
{
    const std::vector<std::string> usual = list_raised_limits(l, tactors);
    if (usual.empty())
        return passed("limits", limit_text(l));
    return warning(
        "limits", limit_text(l) + ": more than by default",
        fmt::format("set [limits] {}, unless you know that actuators, amplifier and skin bear more",
                    fmt::join(usual, ", ")));
}

// Actuators that start too slowly for bursts. For comparison: a piezo starts within 4 ms.
struct slow_kind {
    actuator_kind kind;
    const char* why;
    const char* cure;
};
constexpr std::array slow_kinds{
    slow_kind{actuator_kind::erm,
              "an ERM needs about 116 ms to start, and its frequency follows its voltage, not the carrier",
              "use piezo or voice coil actuators"},
    slow_kind{actuator_kind::lra,
              "an LRA needs over 20 ms to start, and works only within about 5 Hz of its own resonance",
              "set --carrier to the resonance in its data sheet, or use piezo or voice coil actuators"}};
// Range of frequencies to which Pacinian corpuscles are sensitive.
constexpr double lowest_hz = 40.0;
constexpr double highest_hz = 800.0;
constexpr double fewest_cycles = 5.0;

std::vector<std::size_t> select_by_actuator(const array& a, actuator_kind kind)
{
    return select_tactors(a, [kind](const tactor_spec& t) { return t.actuator == kind; });
}

std::string tactor_numbers(const array& a, const std::vector<std::size_t>& some)
{
    if (some.size() == a.tactors.size())
        return "all tactors";
    return fmt::format("tactor{} {}", some.size() == 1 ? "" : "s", fmt::join(some, ", "));
}

std::string tactor_kinds_text(const array& a)
{
    std::map<std::string, std::size_t> counts;
    for (const tactor_spec& t : a.tactors)
        ++counts[std::string(to_string(t.actuator))];
    std::vector<std::string> words;
    for (const auto& [kind, n] : counts)
        words.push_back(counts.size() == 1 ? kind : fmt::format("{} {}", n, kind));
    return fmt::format("{}", fmt::join(words, ", "));
}

void check_actuators(const array& a, double carrier_hz, double burst_s, bool has_bursts,
                     std::vector<finding>& into)
{
    const std::size_t before = into.size();
    const std::string burst =
        has_bursts ? fmt::format("bursts of {:.3g} ms", burst_s * 1e3) : std::string("a moving phantom");
    for (const slow_kind& k : slow_kinds)
        if (const auto some = select_by_actuator(a, k.kind); !some.empty())
            into.push_back(warning("actuators",
                                   fmt::format("{}: {}; it plays {}, and the carrier is {:.4g} Hz",
                                               tactor_numbers(a, some), k.why, burst, carrier_hz),
                                   k.cure));
    double slowest_s = 0.0;
    const auto slow = select_tactors(a, [&](const tactor_spec& t) {
        slowest_s = std::max(slowest_s, t.rise_s.value_or(0.0));
        return t.rise_s.value_or(0.0) > 0.5 * burst_s;
    });
    if (has_bursts && !slow.empty())
        into.push_back(warning("actuators",
                               fmt::format("{}: rise_ms is up to {:.3g}, a large part of {}",
                                           tactor_numbers(a, slow), slowest_s * 1e3, burst),
                               "make bursts longer with --burst, or use faster actuators"));
    if (into.size() != before)
        return;
    const bool unknown = !select_by_actuator(a, actuator_kind::unknown).empty();
    into.push_back(passed("actuators", tactor_kinds_text(a),
                          unknown
                              ? fmt::format("set actuator = \"piezo\", \"voice-coil\", \"lra\" or \"erm\" "
                                            "under [array]: {} need one that starts within a few ms",
                                            burst)
                              : ""));
}

finding check_carrier(double carrier_hz, double burst_s, bool has_bursts, unsigned rate)
{
    const double cycles = carrier_hz * burst_s;
    const std::string found = has_bursts
                                  ? fmt::format("{} ms at {} Hz, {} {}", plain_number(burst_s * 1e3, 4),
                                                plain_number(carrier_hz, 4), plain_number(cycles, 4),
                                                plain_number(cycles, 4) == "1" ? "cycle" : "cycles")
                                  : fmt::format("none (continuous), {:.4g} Hz", carrier_hz);
    if (2.0 * carrier_hz >= rate)
        return {"bursts", level::error, fmt::format("{}: not below half the rate of {} Hz", found, rate),
                "lower --carrier", error_kind::bad_input};
    if (carrier_hz < lowest_hz || carrier_hz > highest_hz)
        return warning("bursts", found,
                       fmt::format("skin feels {:.0f} to {:.0f} Hz, about 250 Hz best: set --carrier",
                                   lowest_hz, highest_hz));
    if (has_bursts && cycles < fewest_cycles)
        return warning("bursts", fmt::format("{}: too few cycles to feel as vibration", found),
                       "raise --carrier, --burst or --soa");
    return passed("bursts", found);
}

} // namespace

std::vector<finding> check_array(const settings& s, const environment& e)
{
    const render_options r = session::find_render_options(s, e);
    std::vector<finding> all{check_places(e.tactors), check_channels(r, e.tactors),
                             check_levels(r, e.tactors, s.plan)};
    for (finding& f : check_bursts(s.plan, e.tactors, r.rate))
        all.push_back(std::move(f));
    all.push_back(check_limits(session::find_limits(s.stream, e), e.tactors.tactors.size()));
    all.push_back(passed("service", "clients of tactor serve get at most " +
                                        session::ceiling_text(session::find_ceiling(e))));
    return all;
}

std::vector<finding> check_bursts(const plan_options& p, const array& a, unsigned rate)
{
    std::vector<finding> all;
    const bool has_bursts = p.algorithm != algorithm_kind::continuous;
    double burst_s = 0.0;
    try {
        if (p.algorithm == algorithm_kind::tactile_brush && !find_grid(a))
            throw error(error_kind::bad_input, "tactile-brush", "it needs a rectangular grid of tactors",
                        "choose another --algorithm for this array");
        if (has_bursts)
            burst_s = burst_duration_s(p);
    } catch (const error& e) {
        return {failure("bursts", e)};
    }
    check_actuators(a, p.carrier_hz, burst_s, has_bursts, all);
    // Noise and recordings have no carrier, so there are no cycles to count.
    if (p.wave.kind == waveform_kind::noise || p.wave.kind == waveform_kind::recording)
        all.push_back(
            passed("bursts", plot::describe_sound({.carrier_hz = p.carrier_hz, .wave = p.wave, .am = p.am})));
    else
        all.push_back(check_carrier(p.carrier_hz, burst_s, has_bursts, rate));
    return all;
}

} // namespace tactor::cli
