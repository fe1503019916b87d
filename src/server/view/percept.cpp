// SPDX-License-Identifier: MIT
// The view percept: places where an observer is predicted to feel the strokes.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "files/plan/plan_json.hpp"
#include "percept/compare.hpp"
#include "server/view/number_list.hpp"
#include "server/view/parts.hpp"

namespace tactor::server {
namespace {

using net::reply_json;

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

} // namespace

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

} // namespace tactor::server
