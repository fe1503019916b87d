// SPDX-License-Identifier: MIT
// Settings of `calibrate` on an array, and their limits.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/calibrate/calibrate_options.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "session/device.hpp"
#include "study/bids/study_folder.hpp"
#include "study/experiment/sequence.hpp"

namespace tactor::cli {
namespace {

// Levels stay so far below a limit of the power: one that is met to the last digit may act.
constexpr double power_margin_db = 1e-3;

unsigned tactor_in(std::string_view text, const std::string& all, std::size_t n)
{
    unsigned i = 0;
    const auto [stop, failed] = std::from_chars(text.data(), text.data() + text.size(), i);
    if (failed == std::errc::invalid_argument || stop != text.data() + text.size())
        refuse_option("--tactors", fmt::format("\"{}\" is no list of tactors", all), "as 0,3-5");
    if (failed != std::errc() || i >= n)
        refuse_option("--tactors", fmt::format("there is no tactor {}", text),
                      n == 1 ? std::string("the array has tactor 0 only")
                             : fmt::format("the array has 0 to {}", n - 1));
    return i;
}

std::vector<unsigned> tactors_in(const std::string& text, std::size_t n)
{
    std::vector<unsigned> all;
    for (const std::string_view part : detail::split(text, ',')) {
        const std::size_t dash = part.find('-');
        const unsigned first = tactor_in(part.substr(0, dash), text, n);
        const unsigned last = dash == part.npos ? first : tactor_in(part.substr(dash + 1), text, n);
        if (last < first)
            refuse_option("--tactors", fmt::format("\"{}\" runs backwards", part),
                          fmt::format("as {}-{}", last, first));
        for (unsigned i = first; i <= last; ++i) {
            if (std::find(all.begin(), all.end(), i) != all.end())
                refuse_option("--tactors", fmt::format("tactor {} is named twice", i),
                              "each is measured once");
            all.push_back(i);
        }
    }
    return all;
}

std::string today()
{
    constexpr std::size_t day = 10; // 2026-11-21
    return study::acq_time_text(study::utc_now_ns()).substr(0, day);
}

void check_staircase(const study::calibration_settings& c)
{
    if (c.staircase.reversals < c.staircase.discard + 2)
        refuse_option(
            "--discard",
            fmt::format("of {} reversals {} are discarded", c.staircase.reversals, c.staircase.discard),
            "two at least must be left");
}

// Returns the masker in the files' words.
std::string masker_text(const calibrate_options& o)
{
    if (o.masker.empty())
        return {};
    return fmt::format("{} noise, {} dBFS", o.masking.color == study::noise_color::white ? "white" : "pink",
                       o.masking.level_dbfs);
}

void check_masker(const calibrate_options& o)
{
    if (o.masker.empty() && !o.of_masker.empty())
        refuse_option(o.of_masker.front(), "there is no device for the noise",
                      "--masker PCM, or leave it out");
    const double most = study::greatest_noise_dbfs(o.masking.color);
    if (o.masking.level_dbfs > most)
        refuse_option("--masker-dbfs",
                      fmt::format("{} dBFS, and the peaks of this noise are at full scale from {} dBFS on",
                                  o.masking.level_dbfs, most),
                      "less here, and more at the amplifier of the headphones");
}

// The levels that a tactor may have.
double find_ceiling(const array& a, std::size_t tactor, const drive_limits& l)
{
    return std::min({0.0, a.tactors[tactor].max_dbfs, l.power_dbfs - power_margin_db});
}

// Lists the measured tactors by their ceilings, in the order of the first of each.
std::vector<std::pair<double, std::vector<unsigned>>> group_by_ceiling(const study::calibration_settings& c)
{
    std::vector<std::pair<double, std::vector<unsigned>>> groups;
    for (std::size_t i = 0; i < c.tactors.size(); ++i) {
        auto at = std::find_if(groups.begin(), groups.end(),
                               [&](const auto& g) { return g.first == c.ceilings_dbfs[i]; });
        if (at == groups.end())
            at = groups.insert(at, {c.ceilings_dbfs[i], {}});
        at->second.push_back(c.tactors[i]);
    }
    return groups;
}

std::string name_tactors(const std::vector<unsigned>& tactors)
{
    return fmt::format("{} {}", tactors.size() == 1 ? "tactor" : "tactors", fmt::join(tactors, ", "));
}

// Returns the longest time that a tactor is driven in any window: in one trial of a staircase, before which
// there may be a pause, or in the steady pulses of an adjustment.
double longest_drive_s(const study::calibration_settings& c, const drive_limits& l)
{
    if (c.method == study::calibration_method::staircase)
        return std::min(c.interval_s, l.window_s);
    const double period_s = c.interval_s + study::interval_gap_s;
    const double whole = std::floor(l.window_s / period_s);
    return whole * c.interval_s + std::min(c.interval_s, l.window_s - whole * period_s);
}

void check_drive_time(const study::calibration_settings& c, const drive_limits& l)
{
    constexpr double rounding_s = 1e-9;
    const double longest_s = longest_drive_s(c, l);
    if (l.max_drive_s < l.window_s && longest_s > l.max_drive_s + rounding_s)
        refuse_option(
            "--interval",
            fmt::format("{} of {} s would drive a tactor {:.4g} s in {:.4g} s, and [limits] allow {:.4g} s "
                        "(max_drive_s)",
                        c.method == study::calibration_method::staircase ? "intervals" : "steady pulses",
                        c.interval_s, longest_s, l.window_s, l.max_drive_s),
            "shorter ones, or another max_drive_s");
}

void check_carrier(double carrier_hz, unsigned rate)
{
    if (carrier_hz >= 0.5 * rate)
        refuse_option("--carrier", fmt::format("{} Hz cannot be played at a rate of {} Hz", carrier_hz, rate),
                      fmt::format("below {} Hz, half the rate", 0.5 * rate));
}

} // namespace

study::calibration_settings settle_calibration(const calibrate_options& o, const settings& s,
                                               const environment& e)
{
    study::calibration_settings c = o.settings;
    const array& a = e.tactors;
    const drive_limits limits = session::settle_limits({}, e);
    if (c.method == study::calibration_method::adjustment && !o.of_staircase.empty())
        refuse_option(o.of_staircase.front(), "an adjustment does not have that",
                      "leave it out, or use --method staircase");
    check_staircase(c);
    check_masker(o);
    check_page_options(o.page, o.simulate.has_value());
    if (o.words && !o.page.shown())
        refuse_option("--page-words", "there is no page", "--display page, or leave it out");
    if (const std::string asked = asked_of_stream(s); o.simulate && !asked.empty())
        refuse_option(asked, "nothing is played", "leave it out, or --simulate");
    if (o.simulate && !o.keypads.empty())
        refuse_option("--keypad", "nobody is asked", "leave it out, or --simulate");
    c.masker = masker_text(o);
    c.masker_pcm = o.masker;
    c.carrier_hz = s.plan.carrier_hz;
    check_carrier(c.carrier_hz, session::settle_render(s, e).rate);
    check_drive_time(c, limits);
    if (o.tactors) {
        c.tactors = tactors_in(*o.tactors, a.tactors.size());
    } else {
        c.tactors.resize(a.tactors.size());
        std::iota(c.tactors.begin(), c.tactors.end(), 0U);
    }
    for (const unsigned t : c.tactors) {
        const double ceiling = find_ceiling(a, t, limits);
        if (o.start_asked && c.start_dbfs() > ceiling)
            refuse_option(
                "--start-dbfs",
                fmt::format("tactor {} may have {:.4g} dBFS at most ({}), and {:.4g} dBFS is the start", t,
                            ceiling, ceiling < a.tactors[t].max_dbfs ? "power_dbfs in [limits]" : "max_dbfs",
                            c.start_dbfs()),
                "start lower");
        c.ceilings_dbfs.push_back(ceiling);
    }
    c.simulate = o.simulate.value_or("");
    c.seed = o.seed.value_or(static_cast<std::uint32_t>(study::default_seed(c.participant)));
    c.date = today();
    return c;
}

void tell_of_ceilings(const study::calibration_settings& c, const environment& e)
{
    std::string all;
    for (const auto& [ceiling_dbfs, tactors] : group_by_ceiling(c))
        all +=
            fmt::format("{}{:.4g} dBFS at {}", all.empty() ? "" : "; ", ceiling_dbfs, name_tactors(tactors));
    say(stderr, "tactor: highest level: {}\n", all);
    std::vector<unsigned> unlimited;
    std::vector<unsigned> lower;
    for (std::size_t i = 0; i < c.tactors.size(); ++i) {
        const double most_dbfs = std::min(0.0, e.tactors.tactors[c.tactors[i]].max_dbfs);
        if (c.ceilings_dbfs[i] < most_dbfs)
            lower.push_back(c.tactors[i]);
        else if (most_dbfs == 0.0)
            unlimited.push_back(c.tactors[i]);
    }
    if (!unlimited.empty())
        say(stderr,
            "tactor: warning: no max_dbfs below 0 limits {}: the level may go to full scale (set max_dbfs in "
            "[[tactor]] of the array file)\n",
            name_tactors(unlimited));
    if (!lower.empty())
        say(stderr,
            "tactor: warning: no level is above {:.4g} dBFS, which power_dbfs in [limits] allows, and "
            "max_dbfs does not, of {}\n",
            session::settle_limits({}, e).power_dbfs, name_tactors(lower));
}

} // namespace tactor::cli
