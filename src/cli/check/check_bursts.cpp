// SPDX-License-Identifier: MIT
// Checks of actuators against the bursts.
#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/check/finding.hpp"
#include "core/words.hpp"
#include "plot/sound_text.hpp"

namespace tactor::cli {
namespace {

// Rise times and bands: a piezo needs 4 ms or less, an LRA over 20 ms and its own resonance within about
// 5 Hz, an ERM about 116 ms and direct current instead of a carrier.
constexpr double lra_rise_s = 0.020;
constexpr double erm_rise_s = 0.116;
// Range in which vibration is felt well: Pacinian corpuscles.
constexpr double lowest_hz = 40.0;
constexpr double highest_hz = 800.0;
constexpr double fewest_cycles = 5.0;

std::vector<std::size_t> select_kind(const array& a, actuator_kind kind)
{
    return tactors_where(a, [kind](const tactor_spec& t) { return t.actuator == kind; });
}

std::string who(const array& a, const std::vector<std::size_t>& some)
{
    if (some.size() == a.tactors.size())
        return "all tactors";
    return fmt::format("tactor{} {}", some.size() == 1 ? "" : "s", fmt::join(some, ", "));
}

std::string kinds(const array& a)
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
    if (const auto erm = select_kind(a, actuator_kind::erm); !erm.empty())
        into.push_back(warning("actuators",
                               fmt::format("{}: an ERM needs about {:.0f} ms to start, too long for {}, and "
                                           "its frequency follows its voltage, not the carrier of {:.4g} Hz",
                                           who(a, erm), erm_rise_s * 1e3, burst, carrier_hz),
                               "use piezo or voice coil actuators"));
    if (const auto lra = select_kind(a, actuator_kind::lra); !lra.empty())
        into.push_back(warning(
            "actuators",
            fmt::format("{}: an LRA needs over {:.0f} ms to start, much of {}, and works only within about 5 "
                        "Hz of its own resonance; the carrier is {:.4g} Hz",
                        who(a, lra), lra_rise_s * 1e3, burst, carrier_hz),
            "set --carrier to the resonance in its data sheet, or use piezo or voice coil actuators"));
    double slowest_s = 0.0;
    const auto slow = tactors_where(a, [&](const tactor_spec& t) {
        slowest_s = std::max(slowest_s, t.rise_s.value_or(0.0));
        return t.rise_s.value_or(0.0) > 0.5 * burst_s;
    });
    if (has_bursts && !slow.empty())
        into.push_back(warning(
            "actuators",
            fmt::format("{}: rise_ms is up to {:.3g}, much of {}", who(a, slow), slowest_s * 1e3, burst),
            "make bursts longer with --burst, or use faster actuators"));
    if (into.size() != before)
        return;
    const bool unknown = !select_kind(a, actuator_kind::unknown).empty();
    into.push_back(fine("actuators", kinds(a),
                        unknown ? fmt::format("say actuator = \"piezo\", \"voice-coil\", \"lra\" or \"erm\" "
                                              "under [array]: {} need one that starts within a few ms",
                                              burst)
                                : ""));
}

// Names noise or a recording, which have no carrier, so that there are no cycles to count.
finding name_sound(const plan_options& p, double burst_s, bool has_bursts)
{
    const std::string sound = plot::describe_sound({.carrier_hz = p.carrier_hz, .wave = p.wave, .am = p.am});
    return fine("bursts", has_bursts ? fmt::format("{} ms of {}", plain_number(burst_s * 1e3, 4), sound)
                                     : "none (continuous), " + sound);
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
        return warning("bursts", fmt::format("{}: too few to be felt as vibration", found),
                       "raise --carrier, --burst or --soa");
    return fine("bursts", found);
}

} // namespace

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
    const bool has_carrier = p.wave.kind != waveform_kind::noise && p.wave.kind != waveform_kind::recording;
    all.push_back(has_carrier ? check_carrier(p.carrier_hz, burst_s, has_bursts, rate)
                              : name_sound(p, burst_s, has_bursts));
    return all;
}

} // namespace tactor::cli
