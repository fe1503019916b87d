// SPDX-License-Identifier: MIT
#include "server/view/view.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>
#include <vector>

#include "server/view/number_list.hpp"
#include "server/view/parts.hpp"

namespace tactor::server {
namespace {

using net::reply_json;

constexpr double number_bytes = 2.0; // least size of a number with the comma after it
constexpr double level_parts = 100.0;
constexpr double time_edge = 1e-6; // of a step: a duration so little above is none

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

std::size_t count_steps(const plan& p)
{
    return static_cast<std::size_t>(std::ceil(p.stroke_duration_s / view_step_s - time_edge));
}

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
