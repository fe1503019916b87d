// SPDX-License-Identifier: MIT
#include "study/calibrate/result.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "files/output_file.hpp"
#include "files/setup_text.hpp"
#include "study/bids/disk.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

template <typename T>
void add(std::string& to, std::string_view key, const std::optional<T>& v)
{
    if (v)
        to += fmt::format("{} = {}\n", key, *v);
}

std::string threshold_text(const tactor_threshold& t, bool stairs)
{
    std::string s = fmt::format("\n[[calibration.tactor]]\ntactor = {}\n", t.tactor);
    add(s, "threshold_dbfs", t.threshold_dbfs);
    add(s, "sd_db", t.sd_db);
    s += fmt::format("trials = {}\n", t.trials);
    if (stairs)
        s += fmt::format("reversals_dbfs = [{}]\n", fmt::join(t.reversals_dbfs, ", "));
    add(s, "check_right", t.check_right);
    add(s, "check_below_right", t.check_below_right);
    if (stairs)
        s += fmt::format("staircases = {}\n", t.staircases);
    return s;
}

constexpr double most_above_median_db = 12.0;

std::optional<double> find_median(std::vector<double> v)
{
    if (v.empty())
        return {};
    std::sort(v.begin(), v.end());
    const std::size_t half = v.size() / 2;
    return v.size() % 2 != 0 ? v[half] : (v[half - 1] + v[half]) / 2.0;
}

} // namespace

std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds)
{
    const bool stairs = s.method == calibration_method::staircase;
    std::string t = fmt::format("\n[calibration]\nparticipant = {}\nmethod = \"{}\"\n",
                                detail::toml_string(s.participant), to_string(s.method));
    if (stairs)
        t += fmt::format("rule = \"{}\"\n", rule_name(s));
    t += fmt::format("carrier_hz = {}\ninterval_s = {}\n", s.carrier_hz, s.interval_s);
    if (stairs)
        t += fmt::format("feedback = {}\n", s.feedback);
    t += fmt::format(
        "masker = {}\ndate = {}\nseed = {}\nsimulated = {}\n",
        detail::toml_string(s.masker.empty() ? "none" : fmt::format("{}, {}", s.masker, s.masker_pcm)),
        detail::toml_string(s.date), s.seed, !s.simulate.empty());
    for (const tactor_threshold& one : thresholds)
        t += threshold_text(one, stairs);
    return t;
}

void check_new_output(const std::filesystem::path& file)
{
    if (is_on_disk(file))
        throw error(error_kind::bad_input, file.string(), "there is such a file already",
                    "choose another name: it is not overwritten");
    const detail::output_file tried(file);
}

void write_new_output(const std::filesystem::path& file, const std::string& text)
{
    check_new_output(file);
    write_whole(file, text);
}

void check_finished(const std::filesystem::path& file, const calibration_settings& s)
{
    read_file(file); // refuses what is no file
    const auto written = load_setup(file).calibration;
    std::vector<unsigned> tactors;
    if (written)
        for (const calibrated_tactor& t : written->tactors)
            tactors.push_back(t.tactor);
    if (!written || is_foreign(*written, s) || written->method != to_string(s.method) ||
        written->carrier_hz != s.carrier_hz || written->interval_s != s.interval_s ||
        written->seed != s.seed || written->date != s.date || tactors != s.tactors)
        throw error(error_kind::bad_input, file.string(), "it is not what this session came to",
                    "choose another name: it is not overwritten");
}

bool is_foreign(const calibration_origin& earlier, const calibration_settings& s)
{
    return earlier.participant != s.participant || earlier.simulated == s.simulate.empty();
}

array with_thresholds(array a, const std::optional<calibration_origin>& earlier,
                      const calibration_settings& s, const std::vector<tactor_threshold>& thresholds)
{
    const bool foreign = earlier && is_foreign(*earlier, s);
    const bool goes_on = earlier && !foreign;
    const bool elsewhere = goes_on && earlier->carrier_hz != s.carrier_hz;
    // [calibration] is about this session now: its participant, and the carrier of a single threshold.
    for (tactor_spec& t : a.tactors) {
        if (foreign) {
            t.threshold_dbfs.reset();
            t.thresholds.clear();
        } else if (elsewhere && t.threshold_dbfs) {
            t.thresholds = {{earlier->carrier_hz, *std::exchange(t.threshold_dbfs, {})}};
        }
    }
    for (const tactor_threshold& measured : thresholds) {
        tactor_spec& t = a.tactors[measured.tactor];
        t.threshold_dbfs.reset();
        if (!goes_on)
            t.thresholds.clear();
        std::erase_if(t.thresholds, [&](const threshold_point& p) { return p.hz == s.carrier_hz; });
        if (t.thresholds.empty()) {
            t.threshold_dbfs = measured.threshold_dbfs;
            continue;
        }
        if (!measured.threshold_dbfs)
            continue;
        const threshold_point here{s.carrier_hz, *measured.threshold_dbfs};
        const auto above = std::find_if(t.thresholds.begin(), t.thresholds.end(),
                                        [&](const threshold_point& p) { return p.hz > here.hz; });
        t.thresholds.insert(above, here);
    }
    return a;
}

std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured)
{
    std::vector<std::optional<double>> all;
    std::vector<double> felt;
    for (const tactor_spec& t : a.tactors)
        if (all.push_back(threshold_at(t, s.carrier_hz)); all.back())
            felt.push_back(*all.back());
    const double median = find_median(felt).value_or(0.0);
    std::vector<doubtful_threshold> doubtful;
    for (unsigned i = 0; i < all.size(); ++i) {
        if (!all[i])
            continue;
        const auto own = std::find_if(measured.begin(), measured.end(),
                                      [i](const tactor_threshold& t) { return t.tactor == i; });
        if (const double above = *all[i] - median; above > most_above_median_db)
            doubtful.push_back(
                {i, fmt::format("it is {:.1f} dB above the median of the array's ({:.1f} dBFS)", above,
                                median)});
        else if (own != measured.end() && own->check_below_right.value_or(0) >= too_many_below)
            doubtful.push_back({i, fmt::format("{} of {} answers 6 dB below it were right, after a second "
                                               "staircase too",
                                               *own->check_below_right, check_count)});
    }
    return doubtful;
}

} // namespace tactor::study
