// SPDX-License-Identifier: MIT
// AHAP files of Core Haptics: events over time, and curves that multiply their intensity and shift their
// sharpness. The intensity is quadratic. Sharpness 0 to 1 is 65 to 300 Hz, and a transient lasts 22 ms, as in
// MPEG's reference encoder (ISO/IEC 23090-31).
#include "files/vibration_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/suggest.hpp"
#include "files/json/json_value.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

using files::json_value;

constexpr const char* ahap_hint = "see Apple's description of AHAP";
constexpr double transient_s = 0.022;
constexpr std::size_t most_events = 10'000;
constexpr bounds ahap_times_s{0.0, longest_stroke_s};
constexpr bounds any_value{-1e6, 1e6};

/// Curve of a control parameter over the whole pattern; `neutral` before its first point.
class control {
public:
    control(double neutral, double low, double high) : neutral_(neutral), low_(low), high_(high) {}

    /// Adds the points of a curve. Until it begins, the value before holds.
    void add(std::vector<timed_value> points)
    {
        if (!points.empty())
            curves_.push_back(std::move(points));
    }

    /// Joins the curves in order of time. Call it before at().
    void join()
    {
        std::stable_sort(curves_.begin(), curves_.end(),
                         [](const auto& a, const auto& b) { return a.front().t_s < b.front().t_s; });
        for (const std::vector<timed_value>& c : curves_) {
            points_.push_back({c.front().t_s, points_.empty() ? neutral_ : points_.back().value});
            points_.insert(points_.end(), c.begin(), c.end());
        }
        std::stable_sort(points_.begin(), points_.end(),
                         [](const timed_value& a, const timed_value& b) { return a.t_s < b.t_s; });
    }

    const std::vector<timed_value>& points() const noexcept { return points_; }

    /// Returns the value at a time; at a step that after it, or with `before` that before it.
    double at(double t_s, bool before = false) const
    {
        const auto later = [](double t, const timed_value& p) { return t < p.t_s; };
        const auto earlier = [](const timed_value& p, double t) { return p.t_s < t; };
        const auto above = before ? std::lower_bound(points_.begin(), points_.end(), t_s, earlier)
                                  : std::upper_bound(points_.begin(), points_.end(), t_s, later);
        double v = neutral_;
        if (above == points_.end() && !points_.empty())
            v = points_.back().value;
        else if (above != points_.begin()) {
            const timed_value& below = *(above - 1);
            v = std::lerp(below.value, above->value, (t_s - below.t_s) / (above->t_s - below.t_s));
        }
        return std::clamp(v, low_, high_);
    }

private:
    double neutral_;
    double low_;
    double high_;
    std::vector<std::vector<timed_value>> curves_;
    std::vector<timed_value> points_;
};

struct continuous_event {
    double from_s = 0.0;
    double to_s = 0.0;
    double intensity = 1.0;
    double sharpness = 0.5;
};

class ahap_reader {
public:
    ahap_reader(std::string_view text, const std::string& name)
        : name_(name), document_(files::read_foreign_object(text, name))
    {
    }

    vibration read()
    {
        const json_value root(document_, name_, ahap_hint);
        warn_of_unknown_keys(root, {"Version", "Metadata", "Pattern"});
        for (const json_value& entry : root["Pattern"].need_list())
            add_entry(entry);
        intensity_.join();
        sharpness_.join();
        if (events_.empty() && transients_.empty())
            throw error(error_kind::bad_input, source_place{name_}, "it has no haptic event",
                        "name another file");
        add_transients();
        add_envelope();
        out_.actuator = {.ducking = 1.0,
                         .low_hz = 65.0,
                         .high_hz = 300.0,
                         .emphasis_low_hz = 65.0,
                         .emphasis_high_hz = 300.0,
                         .emphasis_low_s = transient_s,
                         .emphasis_high_s = transient_s,
                         .emphasis_high_wave = waveform_kind::sine};
        out_.own_actuator = true;
        return std::move(out_);
    }

private:
    void note(std::string what)
    {
        constexpr std::size_t most = 20;
        if (out_.notes.size() <= most &&
            std::find(out_.notes.begin(), out_.notes.end(), what) == out_.notes.end())
            out_.notes.push_back(out_.notes.size() < most ? std::move(what)
                                                          : fmt::format("{}: more is left out", name_));
    }

    void warn_of_ignored(std::string_view what)
    {
        note(fmt::format("{}: {} is left out", name_, quoted(what)));
    }

    void warn_of_unknown_keys(const json_value& v, std::initializer_list<std::string_view> known)
    {
        for (const std::string& key : v.keys())
            if (std::find(known.begin(), known.end(), key) == known.end())
                warn_of_ignored(key);
    }

    void add_entry(const json_value& entry)
    {
        if (entry["ParameterCurves"].exists())
            entry["ParameterCurves"].refuse("there is no such key", "write ParameterCurve");
        warn_of_unknown_keys(entry, {"Event", "Parameter", "ParameterCurve"});
        if (const json_value e = entry["Event"]; e.exists())
            add_event(e);
        if (const json_value p = entry["Parameter"]; p.exists()) {
            warn_of_unknown_keys(p, {"ParameterID", "ParameterValue", "Time"});
            add_control(p["ParameterID"].need_text(),
                        {{p["Time"].need_number(ahap_times_s), p["ParameterValue"].need_number(any_value)}});
        }
        if (const json_value c = entry["ParameterCurve"]; c.exists())
            add_curve(c);
    }

    void add_event(const json_value& e)
    {
        const std::string type = e["EventType"].need_text();
        if (type != "HapticTransient" && type != "HapticContinuous")
            return warn_of_ignored(type);
        warn_of_unknown_keys(e, {"Time", "EventType", "EventDuration", "EventParameters"});
        if (events_.size() + transients_.size() == most_events)
            e.refuse(fmt::format("there are more than {} events", most_events), "split the file");
        continuous_event made{.from_s = e["Time"].need_number(ahap_times_s)};
        for (const json_value& p : e["EventParameters"].list()) {
            warn_of_unknown_keys(p, {"ParameterID", "ParameterValue"});
            const std::string id = p["ParameterID"].need_text();
            const double v = p["ParameterValue"].need_number(any_value);
            if (id == "HapticIntensity")
                made.intensity = std::clamp(v, 0.0, 1.0);
            else if (id == "HapticSharpness")
                made.sharpness = std::clamp(v, 0.0, 1.0);
            else
                warn_of_ignored(id);
        }
        if (type == "HapticTransient") {
            transients_.push_back(made);
            return;
        }
        const double lasts_s = e["EventDuration"].need_number(ahap_times_s);
        if (lasts_s == 0.0)
            return note(fmt::format("{}: an event with an EventDuration of 0 is left out", name_));
        made.to_s = made.from_s + lasts_s;
        events_.push_back(made);
    }

    void add_curve(const json_value& c)
    {
        warn_of_unknown_keys(c, {"ParameterID", "ParameterCurveControlPoints", "Time"});
        const double start_s = c["Time"].exists() ? c["Time"].need_number(ahap_times_s) : 0.0;
        std::vector<timed_value> points;
        for (const json_value& p : c["ParameterCurveControlPoints"].need_list()) {
            warn_of_unknown_keys(p, {"ParameterValue", "Time"});
            points.push_back(
                {p["Time"].need_number(ahap_times_s), p["ParameterValue"].need_number(any_value)});
            if (points.size() > 1 && points.back().t_s < points[points.size() - 2].t_s)
                p["Time"].refuse("it is before that of the previous point", "put times in ascending order");
        }
        const bool absolute = start_s > 0.0 && !points.empty() && points.front().t_s == start_s;
        if (absolute)
            note(fmt::format(
                "{}: control points count from the start of the file, because the first is at the "
                "time of its curve",
                name_));
        else
            for (timed_value& p : points)
                p.t_s += start_s;
        add_control(c["ParameterID"].need_text(), std::move(points));
    }

    void add_control(const std::string& id, std::vector<timed_value> points)
    {
        controls_ += points.size();
        if (controls_ > most_vibration_values)
            throw error(error_kind::bad_input, source_place{name_},
                        fmt::format("it has more than {} control points", most_vibration_values),
                        "split the file");
        if (id == "HapticIntensityControl")
            intensity_.add(std::move(points));
        else if (id == "HapticSharpnessControl")
            sharpness_.add(std::move(points));
        else
            warn_of_ignored(id);
    }

    void add_transients()
    {
        std::stable_sort(transients_.begin(), transients_.end(),
                         [](const auto& a, const auto& b) { return a.from_s < b.from_s; });
        for (const continuous_event& e : transients_) {
            const double strength = e.intensity * intensity_.at(e.from_s);
            out_.emphases.push_back(
                {e.from_s, strength * strength, std::clamp(e.sharpness + sharpness_.at(e.from_s), 0.0, 1.0)});
            out_.duration_s = std::max(out_.duration_s, e.from_s + transient_s);
        }
    }

    // Adds the envelope of the continuous events: between two times at which anything changes, intensities
    // are linear, so their squares get so many points that they are off by at most 1/1024.
    void add_envelope()
    {
        constexpr int parts = 16;
        std::vector<double> times{0.0};
        for (const continuous_event& e : events_) {
            times.push_back(e.from_s);
            times.push_back(e.to_s);
            out_.duration_s = std::max(out_.duration_s, e.to_s);
        }
        for (const control* c : {&intensity_, &sharpness_})
            for (const timed_value& p : c->points())
                if (p.t_s < out_.duration_s)
                    times.push_back(p.t_s);
        times.push_back(out_.duration_s);
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        std::stable_sort(events_.begin(), events_.end(),
                         [](const auto& a, const auto& b) { return a.from_s < b.from_s; });
        std::vector<continuous_event> active;
        auto next = events_.begin();
        for (std::size_t i = 0; i + 1 < times.size(); ++i) {
            std::erase_if(active, [&](const continuous_event& e) { return e.to_s <= times[i]; });
            for (; next != events_.end() && next->from_s <= times[i]; ++next)
                if (next->to_s > times[i])
                    active.push_back(*next);
            const bool straight =
                active.empty() || intensity_.at(times[i]) == intensity_.at(times[i + 1], true);
            const int n = straight ? 1 : parts;
            for (int k = 0; k <= n; ++k)
                add_point(active, std::lerp(times[i], times[i + 1], static_cast<double>(k) / n), k == n);
        }
    }

    void add_point(const std::vector<continuous_event>& active, double t_s, bool before)
    {
        meetings_ += active.size();
        if (out_.amplitude.size() > 10 * most_vibration_values || meetings_ > most_meetings)
            throw error(error_kind::bad_input, source_place{name_},
                        "too many events and control points overlap", "split the file");
        const double factor = intensity_.at(t_s, before);
        const double more = sharpness_.at(t_s, before);
        double sum = 0.0;
        double weighted = 0.0;
        for (const continuous_event& e : active) {
            const double strength = e.intensity * factor;
            sum += strength * strength;
            weighted += strength * strength * std::clamp(e.sharpness + more, 0.0, 1.0);
        }
        out_.amplitude.push_back({t_s, std::min(sum, 1.0)});
        if (sum > 0.0)
            out_.frequency.push_back({t_s, std::clamp(weighted / sum, 0.0, 1.0)});
    }

    const std::string& name_;
    nlohmann::ordered_json document_;
    control intensity_{1.0, 0.0, 1.0};
    control sharpness_{0.0, -1.0, 1.0};
    std::vector<continuous_event> events_;
    std::vector<continuous_event> transients_;
    std::size_t controls_ = 0;
    std::size_t meetings_ = 0;
    vibration out_;
};

constexpr std::string_view ahap_extensions[] = {".ahap"};

} // namespace

vibration read_ahap(std::string_view text, const std::string& name)
{
    return ahap_reader(text, name).read();
}

extern const stroke_format ahap_strokes{
    .name = "ahap",
    .title = "AHAP",
    .extensions = ahap_extensions,
    .media_type = "application/json",
    .begins =
        [](std::string_view text) {
            return find_text_form(text) == text_form::json && text.find("\"Pattern\"") != text.npos;
        },
    .parse =
        [](const stroke_file_text& s) { return make_vibration_strokes(read_ahap(s.text, s.name), s.name); },
    .most_bytes = max_foreign_bytes,
};

} // namespace tactor::detail
