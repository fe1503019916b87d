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

// Resolution of numbers: steps per second, per millimetre, and per full amplitude (the requested level).
constexpr double time_parts = 1e5;
constexpr double mm_parts = 1e3;
constexpr double amplitude_parts = 1e4;

double rounded(double v, double parts)
{
    return std::round(v * parts) / parts + 0.0; // adding 0 turns -0 into 0
}

// A member whose value is a list of numbers or of rows of numbers, as text with a comma before it. It is
// written directly, because a document of so many values takes longer to make than the plan.
class number_list {
public:
    explicit number_list(std::string_view name) : text_(fmt::format(",\"{}\":[", name)) {}

    void add(double v, double parts)
    {
        if (const double r = rounded(v, parts); r == 0.0)
            text_ += "0,"; // most amplitudes are 0
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
    // Closes the list and returns its text.
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

// Most rows in a view, of samples and of felt places, for all strokes together.
constexpr double most_view_rows = 2000.0;
constexpr double view_step_s = 0.002; // least time between two rows of a stroke
constexpr double time_edge = 1e-6;    // fraction of a step by which a duration may exceed whole steps

// Returns the number of rows for a stroke's curve or felt places.
std::size_t count_steps(const plan& p)
{
    return static_cast<std::size_t>(std::ceil(p.stroke_duration_s / view_step_s - time_edge));
}

// Divides the rows of a view among strokes, in proportion to the rows that they need. A stroke that needs
// rows gets at least one.
std::vector<std::size_t> distribute_rows(const std::vector<std::size_t>& needed)
{
    const auto all = static_cast<double>(std::accumulate(needed.begin(), needed.end(), std::size_t{0}));
    const double free = std::max(0.0, most_view_rows - static_cast<double>(needed.size()));
    std::vector<std::size_t> shared;
    for (const std::size_t n : needed)
        shared.push_back(
            n == 0 ? 0 : std::min(n, 1 + static_cast<std::size_t>(free * static_cast<double>(n) / all)));
    return shared;
}

// Returns an upper bound of the number of felt places of a plan.
std::size_t count_felt_places(const plan& p, observer_kind by)
{
    return by == observer_kind::low_speed
               ? p.bursts.size()
               : 2 + static_cast<std::size_t>(p.stroke_duration_s / percept_step_s);
}

// Adds the felt places of a stroke, but only about `rows` of them at regular intervals. Returns the
// prediction for the stroke.
detail::prediction add_felt_places(number_list& felt, const planned& p, const array& a, std::size_t i,
                                   std::size_t rows)
{
    const plan& one = p.plans[i].plan;
    const double start_s = p.starts_s()[i];
    const std::size_t stride = rows == 0 ? 1 : (count_felt_places(one, p.observer.kind) + rows - 1) / rows;
    std::size_t count = 0;
    std::optional<point> last;
    // In silence, repeat the last place with intensity 0.
    const auto add = [&](double t_s, const std::optional<point>& place, double intensity) {
        if (place)
            last = place;
        if (last && count % stride == 0)
            felt.add_row(start_s + t_s, *last, intensity);
        ++count;
    };
    detail::prediction r = detail::predict(a, p.strokes[i], one, p.observer, [&add](const percept_sample& x) {
        add(x.t_s, x.felt, x.intensity);
    });
    auto b = one.bursts.begin();
    for (const tap& t : r.taps) { // one tap for each burst that is not silent
        b = std::find_if(b, one.bursts.end(), [](const burst& x) { return !x.drives.empty(); });
        add(t.onset_s, t.felt, b++->intensity);
    }
    return r;
}

// Adds the prediction to `head` and to the objects in its member "strokes". Returns the felt places as a
// member with a comma before it.
std::string add_percept(reply_json& head, const planned& p, const array& a)
{
    std::vector<std::size_t> needed;
    for (const placed_plan& one : p.plans)
        needed.push_back(std::min(count_felt_places(one.plan, p.observer.kind), 1 + count_steps(one.plan)));
    const std::vector<std::size_t> rows = distribute_rows(needed);
    number_list felt("felt");
    head["observer"] = to_string(p.observer.kind);
    double largest = -1.0;
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const std::size_t first = felt.rows();
        const detail::prediction r = add_felt_places(felt, p, a, i, rows[i]);
        reply_json& stroke = head["strokes"][i];
        stroke["felt_first"] = first;
        stroke["felt_count"] = felt.rows() - first;
        stroke["errors"] = files::errors_json(r, p.observer.kind);
        if (const double off_mm = r.felt.rms_to_path_mm.value_or(0.0); off_mm > largest) {
            largest = off_mm;
            head["errors"] = stroke["errors"];
        }
    }
    return felt.end();
}

// Adds the width of the bins to `head`. Returns the greatest amplitude of each tactor in each bin, as a
// member with a comma before it. The bins divide the time into equal parts.
std::string add_peaks(reply_json& head, const planned& p, std::size_t tactors, std::size_t bins)
{
    constexpr double edge = 1e-9; // times this close to the edge of a bin count as on the edge, in bins
    const double step_s = p.total_s() / static_cast<double>(bins);
    std::vector<double> most(tactors * bins); // rows are bins, columns are tactors
    const auto raise = [&](const burst& b, double first, double last) {
        const auto end = static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, static_cast<double>(bins)));
        for (auto bin = static_cast<std::size_t>(std::max(0.0, first)); bin < end; ++bin)
            for (const drive& d : b.drives)
                most[bin * tactors + d.tactor] = std::max(most[bin * tactors + d.tactor], d.amplitude);
    };
    // A value at the edge between two bins counts for both bins.
    const auto raise_at = [&](const burst& b, double t_s) {
        raise(b, std::ceil(t_s / step_s - edge) - 1.0, std::floor(t_s / step_s + edge));
    };
    const std::vector<double> starts = p.starts_s();
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        for (const burst& b : one.bursts)
            raise(b, std::floor((starts[i] + b.onset_s) / step_s + edge),
                  std::ceil((starts[i] + b.onset_s + b.duration_s) / step_s - edge) - 1.0);
        if (!one.curve)
            continue;
        burst b;
        for (std::uint64_t k = 0; k < one.curve->size(); ++k) {
            one.curve->sample(k, b);
            raise_at(b, starts[i] + one.curve->time_s(k));
        }
        for (std::size_t bin = 0; bin < bins; ++bin) { // adds the values at the edges of bins
            const double t_s = static_cast<double>(bin) * step_s - starts[i];
            if (t_s < 0.0 || t_s > one.curve->duration_s())
                continue;
            one.curve->at(t_s, b);
            raise_at(b, starts[i] + t_s);
        }
    }
    head["step_s"] = step_s;
    number_list peaks("peaks");
    for (const double v : most)
        peaks.add(v, amplitude_parts);
    return peaks.end();
}

// Adds the strokes to `head`. Returns lists with the bursts of all strokes, and curves as rows at equal time
// intervals.
// \throws std::bad_alloc if there are too many.
std::string add_bursts(reply_json& head, const planned& p, std::size_t tactors, std::size_t most_bytes)
{
    constexpr std::size_t number_bytes = 2; // least size of a number with the comma after it
    std::vector<std::size_t> needed;
    for (const placed_plan& one : p.plans)
        needed.push_back(one.plan.curve ? count_steps(one.plan) : 0);
    const std::vector<std::size_t> rows = distribute_rows(needed);
    const std::vector<double> starts = p.starts_s();
    number_list onsets("onsets");
    number_list durations("durations");
    number_list positions("positions");
    number_list intensities("intensities");
    number_list amplitudes("amplitudes");
    std::vector<double> row; // amplitudes of one burst, by tactor
    std::size_t count = 0;
    const auto add_row = [&](const burst& b, double onset_s, double duration_s) {
        if (++count * tactors * number_bytes > most_bytes)
            throw std::bad_alloc();
        onsets.add(onset_s, time_parts);
        durations.add(duration_s, time_parts);
        positions.add(b.position.x_mm, mm_parts);
        positions.add(b.position.y_mm, mm_parts);
        intensities.add(b.intensity, amplitude_parts);
        row.assign(tactors, 0.0);
        for (const drive& d : b.drives)
            row[d.tactor] = d.amplitude;
        for (const double a : row)
            amplitudes.add(a, amplitude_parts);
    };
    head["continuous"] = false;
    head["strokes"] = reply_json::array();
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const plan& one = p.plans[i].plan;
        const std::size_t first = count;
        for (const burst& b : one.bursts)
            add_row(b, starts[i] + b.onset_s, b.duration_s);
        burst b;
        for (std::size_t k = 0; k < rows[i]; ++k) {
            const double step_s = one.curve->duration_s() / static_cast<double>(rows[i]);
            const double t_s = static_cast<double>(k) * step_s;
            one.curve->at(t_s, b);
            add_row(b, starts[i] + t_s, step_s);
        }
        if (one.curve)
            head["continuous"] = true;
        head["strokes"].push_back({{"name", net::truncate_echo(p.strokes[i].name)},
                                   {"start_s", rounded(starts[i], time_parts)},
                                   {"total_s", rounded(one.total_s, time_parts)},
                                   {"duration_s", rounded(one.stroke_duration_s, time_parts)},
                                   {"first", first},
                                   {"count", count - first},
                                   {"algorithm", one.algorithm},
                                   {"continuous", one.curve.has_value()}});
    }
    return onsets.end() + durations.end() + positions.end() + intensities.end() + amplitudes.end();
}

} // namespace

view_choice read_view(const json& params)
{
    const auto* const name =
        std::find(view_names.begin(), view_names.end(), params.value("view", std::string("full")));
    view_choice v{static_cast<view_kind>(name - view_names.begin())};
    if (params.contains("bins") && v.kind != view_kind::peaks)
        refuse_param("bins", "only the view peaks uses them", R"(add "view":"peaks")");
    v.bins = params.value("bins", v.bins);
    return v;
}

std::string view_text(const planned& p, const array& a, const view_choice& v, std::size_t most_bytes)
{
    const std::size_t tactors = a.tactors.size();
    reply_json head{{"tactors", tactors}, {"total_s", rounded(p.total_s(), time_parts)}};
    head["warnings"] = reply_json::array();
    for (const std::string& w : p.warnings())
        head["warnings"].push_back(net::truncate_echo(w));
    add_weakening(head, p.weakened);
    constexpr double level_parts = 100.0;
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
    text.pop_back(); // removes the closing brace
    text += lists + '}';
    if (text.size() > most_bytes)
        throw std::bad_alloc();
    return text;
}

} // namespace tactor::server
