// SPDX-License-Identifier: MIT
#include "study/calibrate/observer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "core/words.hpp"

namespace tactor::study {

namespace {

constexpr const char* subject = "--simulate";
constexpr const char* shape = "as seed=1,threshold=-45,spread=2,lapse=0.02";

[[noreturn]] void refuse(const std::string& why, std::string_view hint = shape)
{
    throw error(error_kind::bad_input, subject, why, hint);
}

double number(std::string_view key, std::string_view text, double low, double high)
{
    const auto v = detail::number_in<double>(text);
    if (!v)
        refuse(fmt::format("{}: \"{}\" is not a number", key, text));
    if (!(*v >= low && *v <= high))
        refuse(fmt::format("{} is {}", key, text),
               fmt::format("{} to {}", plain_number(low), plain_number(high)));
    return *v;
}

std::uint64_t whole(std::string_view key, std::string_view text)
{
    const double v = number(key, text, 0.0, 0x1p53);
    if (v != std::floor(v))
        refuse(fmt::format("{} is {}", key, text), "a whole number");
    return static_cast<std::uint64_t>(v);
}

void take(observer_settings& o, std::string_view key, std::string_view value)
{
    if (key == "threshold")
        o.thresholds_dbfs.push_back(number(key, value, -200.0, 1000.0));
    else if (key == "spread")
        o.spread_db = number(key, value, 0.0, 100.0);
    else if (key == "lapse")
        o.lapse = number(key, value, 0.0, 0.5);
    else if (key == "seed")
        o.seed = whole(key, value);
    else
        refuse(fmt::format("\"{}\" is not known", key));
}

// Keeps the entries of the measured tactors, if the list has one for each tactor of the array.
void choose_measured(observer_settings& o, const std::vector<unsigned>& measured, std::size_t all)
{
    const std::size_t n = o.thresholds_dbfs.size();
    if (n == 1 || n == measured.size())
        return;
    if (n != all)
        refuse(fmt::format("{} for {}", counted(n, "threshold"), counted(measured.size(), "tactor")),
               "one for all, or one for each");
    std::vector<double> own;
    for (const unsigned t : measured)
        own.push_back(o.thresholds_dbfs[t]);
    o.thresholds_dbfs = std::move(own);
}

constexpr double usual_answer_s = 1.5; // from the last interval on
constexpr double before_s = 0.5;
constexpr double series_s = 20.0; // of an adjustment

} // namespace

observer_settings parse_observer(std::string_view text, const std::vector<unsigned>& measured,
                                 std::size_t all)
{
    observer_settings o;
    std::vector<std::string_view> seen;
    for (std::string_view item : detail::split(text, ',')) {
        if (const std::size_t equals = item.find('='); equals != item.npos) {
            if (std::find(seen.begin(), seen.end(), item.substr(0, equals)) != seen.end())
                refuse(fmt::format("{} is said twice", item.substr(0, equals)));
            seen.push_back(item.substr(0, equals));
            item.remove_prefix(equals + 1);
        } else if (seen.empty() || seen.back() != "threshold") {
            refuse(fmt::format("\"{}\" has no =", item));
        }
        take(o, seen.back(), item);
    }
    if (o.thresholds_dbfs.empty())
        refuse("threshold is missing");
    choose_measured(o, measured, all);
    return o;
}

double right_at(const observer_settings& o, double threshold_dbfs, double level_dbfs)
{
    if (o.spread_db == 0.0) // a step
        return level_dbfs < threshold_dbfs ? 0.5 : 1.0 - o.lapse;
    const double z = (level_dbfs - threshold_dbfs) / o.spread_db;
    return 0.5 + (0.5 - o.lapse) * 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

observer::observer(observer_settings o, const calibration_settings& s)
    : o_(std::move(o)),
      tactors_(s.tactors),
      r_(fmt::format("{}/calibrate/{}/observer", o_.seed.value_or(s.seed), s.participant))
{
}

double observer::find_threshold(unsigned tactor) const
{
    if (o_.thresholds_dbfs.size() == 1)
        return o_.thresholds_dbfs.front();
    const auto at = std::find(tactors_.begin(), tactors_.end(), tactor) - tactors_.begin();
    return o_.thresholds_dbfs[static_cast<std::size_t>(at)];
}

calibration_answer observer::answer(const calibration_trial& t)
{
    if (t.interval == 0)
        return adjust(t);
    const bool right = r_.unit() < right_at(o_, find_threshold(t.tactor), t.level_dbfs);
    return {.interval = right ? t.interval : 3 - t.interval};
}

// Goes by 2 dB until it is near to what it feels as the threshold this time, then by half a dB.
calibration_answer observer::adjust(const calibration_trial& t)
{
    const double aim = find_threshold(t.tactor) + o_.spread_db * r_.normal();
    if (aim > t.ceiling_dbfs)
        return {};
    double level = t.level_dbfs;
    for (const double by : {2.0, 0.5})
        while (std::abs(level - aim) > by / 2.0) {
            const double to = std::clamp(level < aim ? level + by : level - by, floor_dbfs, t.ceiling_dbfs);
            if (to == level || std::abs(to - aim) >= std::abs(level - aim))
                break;
            level = to;
        }
    return {.set_dbfs = level};
}

std::string time_text(const calibration& c)
{
    const calibration_settings& s = c.settings();
    calibration rest = c;
    observer typical({.thresholds_dbfs = {-45.0}}, s);
    const double trial_s = before_s + 2.0 * s.interval_s + interval_gap_s + usual_answer_s;
    double seconds = 0.0;
    std::size_t trials = 0;
    std::set<unsigned> tactors;
    for (; !rest.done(); ++trials) {
        const calibration_trial t = rest.next();
        tactors.insert(t.tactor);
        seconds += t.interval != 0 ? trial_s : series_s;
        static_cast<void>(rest.answer(typical.answer(t)));
    }
    const auto minutes = static_cast<std::uint64_t>(std::max(1.0, std::round(seconds / 60.0)));
    return fmt::format("{}, about {}: some {}", counted(tactors.size(), "tactor"), counted(trials, "trial"),
                       counted(minutes, "minute"));
}

} // namespace tactor::study
