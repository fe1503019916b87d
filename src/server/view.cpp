// SPDX-License-Identifier: MIT
#include "server/view.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <new>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/path.hpp>

#include "files/plan/plan_json.hpp"
#include "percept/compare.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

constexpr std::pair<std::string_view, view_kind> views[] = {{"full", view_kind::full},
                                                            {"bursts", view_kind::bursts},
                                                            {"percept", view_kind::percept},
                                                            {"peaks", view_kind::peaks}};

// Parts of a second, of a millimetre, and of the level asked for, to which numbers are rounded.
constexpr double time_parts = 1e5;
constexpr double mm_parts = 1e3;
constexpr double amplitude_parts = 1e4;

double rounded(double v, double parts)
{
    return std::round(v * parts) / parts + 0.0; // which turns -0 into 0
}

// A member that is a list of numbers, or of rows of numbers, as text with a comma before it. By hand: a
// document of so many values takes longer than the plan.
class number_list {
public:
    explicit number_list(std::string_view name) : text_(fmt::format(",\"{}\":[", name)) {}

    void add(double v, double parts)
    {
        if (const double r = rounded(v, parts); r == 0.0)
            text_ += "0,"; // as most amplitudes are
        else
            fmt::format_to(std::back_inserter(text_), "{},", r);
    }
    void add_row(double t_s, point at, double intensity)
    {
        text_ += '[';
        add(t_s, time_parts);
        add(at.x_mm, mm_parts);
        add(at.y_mm, mm_parts);
        add(intensity, amplitude_parts);
        text_.back() = ']';
        text_ += ',';
        ++rows_;
    }
    std::size_t rows() const noexcept { return rows_; }
    // Ends the list and returns it.
    const std::string& end()
    {
        if (text_.back() == ',')
            text_.pop_back();
        return text_ += ']';
    }

private:
    std::string text_;
    std::size_t rows_ = 0;
};

// Most rows of samples, and of felt places, in a view of all strokes together; least time from one to the
// next of a stroke, s.
constexpr double most_view_rows = 2000.0;
constexpr double view_step_s = 0.002;
constexpr double time_edge = 1e-6; // of a step: a duration so little above is none

// Returns the rows that a curve, or the felt places, of a stroke can have.
std::size_t count_steps(const plan& p)
{
    return static_cast<std::size_t>(std::ceil(p.stroke_duration_s / view_step_s - time_edge));
}

// Shares the rows of a view among strokes that would need so many. A stroke that needs any has at least one.
std::vector<std::size_t> share_rows(const std::vector<std::size_t>& needed)
{
    const auto all = static_cast<double>(std::accumulate(needed.begin(), needed.end(), std::size_t{0}));
    const double free = std::max(0.0, most_view_rows - static_cast<double>(needed.size()));
    std::vector<std::size_t> shared;
    for (const std::size_t n : needed)
        shared.push_back(
            n == 0 ? 0 : std::min(n, 1 + static_cast<std::size_t>(free * static_cast<double>(n) / all)));
    return shared;
}

// Returns an upper bound for the felt places of a plan.
std::size_t count_felt(const plan& p, observer_kind by)
{
    return by == observer_kind::low_speed
               ? p.bursts.size()
               : 2 + static_cast<std::size_t>(p.stroke_duration_s / percept_step_s);
}

// Felt places of one stroke, thinned out evenly to so many rows.
class felt_rows {
public:
    felt_rows(number_list& to, double start_s, std::size_t places, std::size_t rows)
        : to_(to), start_s_(start_s), stride_(rows == 0 ? 1 : (places + rows - 1) / rows)
    {
    }

    // In silence the last place stays, with intensity 0.
    void add(double t_s, const std::optional<point>& felt, double intensity)
    {
        if (felt)
            last_ = felt;
        if (last_ && count_ % stride_ == 0)
            to_.add_row(start_s_ + t_s, *last_, intensity);
        ++count_;
    }

private:
    number_list& to_;
    double start_s_;
    std::size_t stride_;
    std::size_t count_ = 0;
    std::optional<point> last_ = {};
};

detail::prediction predict(felt_rows to, const planned& p, const array& a, std::size_t i)
{
    const plan& one = p.plans[i].plan;
    detail::prediction r = detail::predict(a, p.strokes[i], one, p.observer, [&to](const percept_sample& x) {
        to.add(x.t_s, x.felt, x.intensity);
    });
    auto b = one.bursts.begin();
    for (const tap& t : r.taps) { // one a burst that is not silent
        b = std::find_if(b, one.bursts.end(), [](const burst& x) { return !x.drives.empty(); });
        to.add(t.onset_s, t.felt, b++->intensity);
    }
    return r;
}

// Adds the prediction to `head` and to its "strokes". Returns the felt places: a member with a comma before
// it.
std::string add_percept(reply_json& head, const planned& p, const array& a)
{
    std::vector<std::size_t> places;
    std::vector<std::size_t> needed;
    for (const placed_plan& one : p.plans) {
        places.push_back(count_felt(one.plan, p.observer.kind));
        needed.push_back(std::min(places.back(), 1 + count_steps(one.plan)));
    }
    const std::vector<std::size_t> rows = share_rows(needed);
    const std::vector<double> starts = p.starts_s();
    number_list felt("felt");
    head["observer"] = to_string(p.observer.kind);
    double largest = -1.0;
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const std::size_t first = felt.rows();
        const detail::prediction r = predict({felt, starts[i], places[i], rows[i]}, p, a, i);
        reply_json& stroke = head["strokes"][i];
        stroke["felt_first"] = first;
        stroke["felt_count"] = felt.rows() - first;
        stroke["errors"] = files::errors_json(r, p.observer.kind);
        if (const double rms = r.felt.rms_error_mm.value_or(0.0); rms > largest) {
            largest = rms;
            head["errors"] = stroke["errors"];
        }
    }
    return felt.end();
}

constexpr double edge = 1e-9; // of a bin: nearer is at its edge

// Largest amplitude of each tactor in each of some equal parts of the time.
class peak_bins {
public:
    peak_bins(std::size_t tactors, std::size_t bins, double total_s)
        : tactors_(tactors), bins_(bins), step_s_(total_s / static_cast<double>(bins)), peaks_(tactors * bins)
    {
    }

    void add(const burst& b, double onset_s)
    {
        raise(b.drives, std::floor(onset_s / step_s_ + edge),
              std::ceil((onset_s + b.duration_s) / step_s_ - edge) - 1.0);
    }
    // Adds the samples of a curve, and its values at the edges of bins.
    void add(const curve& c, double start_s)
    {
        burst b;
        for (std::uint64_t k = 0; k < c.size(); ++k) {
            c.sample(k, b);
            add_point(b, start_s + c.time_s(k));
        }
        for (auto bin = static_cast<std::size_t>(start_s / step_s_); bin < bins_; ++bin) {
            const double t_s = static_cast<double>(bin) * step_s_ - start_s;
            if (t_s > c.duration_s())
                break;
            if (t_s < 0.0)
                continue;
            c.at(t_s, b);
            add_point(b, start_s + t_s);
        }
    }
    double step_s() const noexcept { return step_s_; }
    const std::vector<double>& peaks() const noexcept { return peaks_; }

private:
    // Adds values at one time. At the edge of two bins they belong to both.
    void add_point(const burst& b, double t_s)
    {
        raise(b.drives, std::ceil(t_s / step_s_ - edge) - 1.0, std::floor(t_s / step_s_ + edge));
    }
    void raise(const std::vector<drive>& drives, double first, double last)
    {
        const auto end = static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, static_cast<double>(bins_)));
        for (auto bin = static_cast<std::size_t>(std::max(0.0, first)); bin < end; ++bin)
            for (const drive& d : drives) {
                double& peak = peaks_[bin * tactors_ + d.tactor];
                peak = std::max(peak, d.amplitude);
            }
    }

    std::size_t tactors_;
    std::size_t bins_;
    double step_s_;
    std::vector<double> peaks_; // a row for each bin
};

// Adds the width of the bins to `head`. Returns the largest amplitudes: a member with a comma before it.
std::string add_peaks(reply_json& head, const planned& p, std::size_t tactors, std::size_t bins)
{
    peak_bins all(tactors, bins, p.total_s());
    const std::vector<double> starts = p.starts_s();
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        for (const burst& b : one.bursts)
            all.add(b, starts[i] + b.onset_s);
        if (one.curve)
            all.add(*one.curve, starts[i]);
    }
    head["step_s"] = all.step_s();
    number_list peaks("peaks");
    for (const double v : all.peaks())
        peaks.add(v, amplitude_parts);
    return peaks.end();
}

constexpr double number_bytes = 2.0; // least size of a number with the comma after it
constexpr double level_parts = 100.0;

// Bursts of all strokes, list by list.
class burst_lists {
public:
    burst_lists(std::size_t tactors, std::size_t most_bytes)
        : amplitude_(tactors), most_(static_cast<double>(most_bytes) / number_bytes)
    {
    }

    // Throws std::bad_alloc for too many.
    void add(const burst& b, double onset_s, double duration_s)
    {
        ++count_;
        if (static_cast<double>(count_ * amplitude_.size()) > most_)
            throw std::bad_alloc();
        onsets_.add(onset_s, time_parts);
        durations_.add(duration_s, time_parts);
        positions_.add(b.position.x_mm, mm_parts);
        positions_.add(b.position.y_mm, mm_parts);
        intensities_.add(b.intensity, amplitude_parts);
        std::fill(amplitude_.begin(), amplitude_.end(), 0.0);
        for (const drive& d : b.drives)
            amplitude_[d.tactor] = d.amplitude;
        for (const double a : amplitude_)
            amplitudes_.add(a, amplitude_parts);
    }
    // Adds a curve as rows at equal distances.
    void add(const curve& c, double start_s, std::size_t rows)
    {
        const double step_s = c.duration_s() / static_cast<double>(rows);
        burst b;
        for (std::size_t k = 0; k < rows; ++k) {
            const double t_s = static_cast<double>(k) * step_s;
            c.at(t_s, b);
            add(b, start_s + t_s, step_s);
        }
    }
    std::size_t count() const noexcept { return count_; }
    std::string end()
    {
        return onsets_.end() + durations_.end() + positions_.end() + intensities_.end() + amplitudes_.end();
    }

private:
    number_list onsets_{"onsets"}, durations_{"durations"}, positions_{"positions"},
        intensities_{"intensities"}, amplitudes_{"amplitudes"};
    std::vector<double> amplitude_; // of one burst, by tactor
    double most_;
    std::size_t count_ = 0;
};

std::string add_bursts(reply_json& head, const planned& p, std::size_t tactors, std::size_t most_bytes)
{
    std::vector<std::size_t> needed;
    for (const placed_plan& one : p.plans)
        needed.push_back(one.plan.curve ? count_steps(one.plan) : 0);
    const std::vector<std::size_t> rows = share_rows(needed);
    const std::vector<double> starts = p.starts_s();
    burst_lists lists(tactors, most_bytes);
    head["continuous"] = false;
    head["strokes"] = reply_json::array();
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        const std::size_t first = lists.count();
        for (const burst& b : one.bursts)
            lists.add(b, starts[i] + b.onset_s, b.duration_s);
        if (one.curve) {
            head["continuous"] = true;
            lists.add(*one.curve, starts[i], rows[i]);
        }
        head["strokes"].push_back({{"name", net::cut_echo(p.strokes[i].name)},
                                   {"start_s", rounded(starts[i], time_parts)},
                                   {"total_s", rounded(one.total_s, time_parts)},
                                   {"duration_s", rounded(one.stroke_duration_s, time_parts)},
                                   {"first", first},
                                   {"count", lists.count() - first},
                                   {"algorithm", one.algorithm},
                                   {"continuous", one.curve.has_value()}});
    }
    return lists.end();
}

} // namespace

view_choice read_view(const json& params)
{
    constexpr double most_bins = 4000.0;
    view_choice v;
    if (const json* name = member(params, "view")) {
        const std::string said = text(*name, "view");
        const auto* found = std::find_if(std::begin(views), std::end(views),
                                         [&](const auto& one) { return one.first == said; });
        if (found == std::end(views))
            bad_param("view", fmt::format("\"{}\" is not known", said),
                      "one of full, bursts, percept, peaks");
        v.kind = found->second;
    }
    if (const json* bins = member(params, "bins")) {
        if (v.kind != view_kind::peaks)
            bad_param("bins", "only the view peaks has them", R"(add "view":"peaks")");
        v.bins = static_cast<std::size_t>(whole(*bins, "bins", {1.0, most_bins}));
    }
    return v;
}

std::string view_text(const planned& p, const array& a, const view_choice& v, std::size_t most_bytes)
{
    const std::size_t tactors = a.tactors.size();
    reply_json head{{"tactors", tactors}, {"total_s", rounded(p.total_s(), time_parts)}};
    std::vector<std::string> warnings = p.warnings();
    for (std::string& w : warnings)
        w = net::cut_echo(w);
    head["warnings"] = warnings;
    if (const double over_db = rounded(p.over_db, level_parts); over_db > 0.0)
        head["warnings"].push_back({{"kind", "level"}, {"over_db", over_db}});
    std::string lists;
    if (v.kind == view_kind::peaks)
        lists = add_peaks(head, p, tactors, v.bins);
    else
        lists = add_bursts(head, p, tactors, most_bytes);
    if (v.kind == view_kind::percept)
        lists += add_percept(head, p, a);
    std::string text = net::json_line(head);
    text.pop_back(); // its brace
    text += lists + '}';
    if (text.size() > most_bytes)
        throw std::bad_alloc();
    return text;
}

} // namespace tactor::server
