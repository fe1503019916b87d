// SPDX-License-Identifier: MIT
#include "study/results/drawings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

constexpr std::size_t turn_parts = 5;
constexpr double per_m = 1000.0;

// Returns the angle of a chord, rad.
double find_angle(const point& from, const point& to)
{
    return std::atan2(to.y_mm - from.y_mm, to.x_mm - from.x_mm);
}

// Adds whole turns to an angle, rad, so that it is from -pi to pi.
double wrap(double angle)
{
    return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Returns the discrete Frechet distance (Eiter and Mannila 1994).
double find_frechet_distance(const std::vector<point>& a, const std::vector<point>& b)
{
    std::vector<double> row(b.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < a.size(); ++i) {
        double diagonal = i == 0 ? 0.0 : std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < b.size(); ++k) {
            const double left = k > 0 ? row[k - 1] : std::numeric_limits<double>::infinity();
            const double reached = std::min({row[k], left, diagonal});
            diagonal = row[k];
            row[k] = std::max(reached, distance_mm(a[i], b[k]));
        }
    }
    return row.back();
}

// Returns the distances between two paths that were divided into the same number of parts.
path_errors compare_points(const std::vector<point>& a, const std::vector<point>& b)
{
    path_errors e{.frechet_mm = find_frechet_distance(a, b)};
    for (std::size_t i = 0; i < a.size(); ++i)
        e.distance_mm += distance_mm(a[i], b[i]) / static_cast<double>(a.size());
    return e;
}

// Returns the direction from start to end, rad, or nothing if the path ends at the start or near it.
std::optional<double> find_direction(const drawing& d)
{
    constexpr double least_part = 0.1; // share of the path's length
    const double chord = distance_mm(d.front().at, d.back().at);
    if (!(chord > least_part * find_length_mm(d)))
        return {};
    return find_angle(d.front().at, d.back().at);
}

std::optional<double> optional_mean(const std::vector<double>& values)
{
    return values.empty() ? std::nullopt : std::optional(mean(values));
}

// Returns the circular mean of angles, degrees.
std::optional<double> mean_angle(const std::vector<double>& degrees)
{
    constexpr double half_turn_deg = 180.0;
    double x = 0.0;
    double y = 0.0;
    for (const double d : degrees) {
        x += std::cos(d / half_turn_deg * std::numbers::pi);
        y += std::sin(d / half_turn_deg * std::numbers::pi);
    }
    if (degrees.empty())
        return {};
    return std::atan2(y, x) / std::numbers::pi * half_turn_deg;
}

// Returns the pooled standard deviation within motions, or nothing if no motion has two trials.
std::optional<double> pool_deviation(const std::map<std::size_t, std::vector<double>>& by_motion)
{
    double squares = 0.0;
    std::size_t df = 0;
    for (const auto& [motion, errors] : by_motion) {
        const double centre = mean(errors);
        for (const double e : errors)
            squares += (e - centre) * (e - centre);
        df += errors.size() - 1;
    }
    return df == 0 ? std::nullopt : std::optional(std::sqrt(squares / static_cast<double>(df)));
}

// Averages the errors of each motion, and then averages over motions.
std::optional<double> average(const std::map<std::size_t, std::vector<double>>& by_motion)
{
    std::vector<double> means;
    for (const auto& [motion, errors] : by_motion)
        means.push_back(mean(errors));
    return optional_mean(means);
}

// Averages lists of points, point by point. All lists must have the same length.
std::vector<point> average_points(const std::vector<std::vector<point>>& all)
{
    std::vector<point> sum(all.front().size());
    for (const std::vector<point>& one : all)
        for (std::size_t i = 0; i < sum.size(); ++i) {
            sum[i].x_mm += one[i].x_mm / static_cast<double>(all.size());
            sum[i].y_mm += one[i].y_mm / static_cast<double>(all.size());
        }
    return sum;
}

std::vector<named_value> list_place_figures(const std::vector<trial>& trials)
{
    std::vector<double> distances;
    std::map<std::size_t, std::vector<double>> along;
    std::map<std::size_t, std::vector<double>> across;
    for (const trial& t : trials) {
        const point& at = t.drawn.front().at;
        const point& target = t.target.front().at;
        distances.push_back(distance_mm(at, target));
        along[t.motion].push_back(at.y_mm - target.y_mm);
        across[t.motion].push_back(at.x_mm - target.x_mm);
    }
    return {{{"error"}, optional_mean(distances)},
            {{"constant_along"}, average(along)},
            {{"constant_across"}, average(across)},
            {{"variable_along"}, pool_deviation(along)},
            {{"variable_across"}, pool_deviation(across)}};
}

std::vector<named_value> list_path_figures(const std::vector<trial>& trials)
{
    std::vector<double> distances;
    std::vector<double> frechet;
    std::vector<double> lengths;
    std::vector<double> directions;
    std::vector<double> curvatures;
    for (const trial& t : trials) {
        const path_errors e = compare_paths(t.drawn, t.target);
        distances.push_back(e.distance_mm);
        frechet.push_back(e.frechet_mm);
        for (auto& [to, v] :
             {std::pair(&lengths, e.length), {&directions, e.direction}, {&curvatures, e.curvature}})
            if (v)
                to->push_back(*v);
    }
    return {{{"distance"}, optional_mean(distances)},
            {{"frechet"}, optional_mean(frechet)},
            {{"length"}, optional_mean(lengths)},
            {{"direction"}, mean_angle(directions), true},
            {{"curvature"}, optional_mean(curvatures)}};
}

// Compares the predictions for a stimulus with the mean drawing. If the drawings are places, replaces a
// predicted path by the mean of its points.
std::vector<predicted_drawing> compare_predictions(const std::vector<predicted_path>& all,
                                                   const std::string& motion, const std::string& method,
                                                   drawing_kind kind, const std::vector<point>& mean_drawing)
{
    std::vector<predicted_drawing> compared;
    for (const predicted_path& p : all) {
        if (p.motion != motion || p.method != method)
            continue;
        drawing felt = p.felt;
        if (kind == drawing_kind::place) {
            std::vector<std::vector<point>> points;
            for (const drawn_point& one : p.felt)
                points.push_back({one.at});
            felt = {{0.0, average_points(points).front()}};
        }
        std::vector<point> points = divide(felt, drawn_parts);
        const path_errors e = compare_points(points, mean_drawing);
        compared.push_back({p.observer, std::move(points), e.distance_mm, e.frechet_mm});
    }
    return compared;
}

} // namespace

std::optional<double> find_curvature(const drawing& d)
{
    const double length = find_length_mm(d);
    if (!(length > 0.0))
        return {};
    const std::vector<point> at = divide(d, turn_parts);
    double turned = 0.0;
    for (std::size_t i = 2; i < at.size(); ++i)
        turned += wrap(find_angle(at[i - 1], at[i]) - find_angle(at[i - 2], at[i - 1]));
    return turned * per_m * turn_parts / (length * (turn_parts - 1));
}

path_errors compare_paths(const drawing& drawn, const drawing& target)
{
    const std::vector<point> a = divide(drawn, drawn_parts);
    const std::vector<point> b = divide(target, drawn_parts);
    path_errors e = compare_points(a, b);
    if (const double length = find_length_mm(target); length > 0.0)
        e.length = find_length_mm(drawn) / length;
    const auto from = find_direction(target);
    const auto to = find_direction(drawn);
    constexpr double half_turn_deg = 180.0;
    if (from && to)
        e.direction = wrap(*to - *from) / std::numbers::pi * half_turn_deg;
    const auto bent = find_curvature(drawn);
    const auto wanted = find_curvature(target);
    if (bent && wanted)
        e.curvature = *bent - *wanted;
    return e;
}

std::vector<named_value> list_drawn_figures(drawing_kind kind, const std::vector<trial>& trials)
{
    return kind == drawing_kind::place ? list_place_figures(trials) : list_path_figures(trials);
}

drawn_answers measure_drawings(const run_outline& o, drawing_kind kind, const condition_trials& c,
                               const run_people& people)
{
    const auto look = [kind](const std::vector<trial>& trials, const std::string&) {
        drawn_by_person p{.figures = list_drawn_figures(kind, trials)};
        for (const trial& t : trials)
            p.drawings.push_back(divide(t.drawn, drawn_parts));
        return p;
    };
    const std::vector<named_value> names = list_drawn_figures(kind, {});
    drawn_answers v;
    v.kind = kind;
    v = measure_people(std::move(v), c, people, {}, look,
                       [&names](const drawn_by_person& p) { return p.figures.empty() ? names : p.figures; });
    std::set<std::size_t> motions;
    std::set<std::size_t> methods;
    const trial* any = nullptr;
    const std::vector<predicted_path>* predictions = nullptr;
    std::vector<std::vector<point>> means;
    for (std::size_t i = 0; i < v.people.size(); ++i) {
        for (const trial& t : c.people[i]) {
            motions.insert(t.motion);
            methods.insert(t.method_1);
            any = &t;
            predictions = people.all[i].predictions;
        }
        if (!v.people[i].drawings.empty())
            means.push_back(average_points(v.people[i].drawings));
    }
    if (motions.size() == 1) {
        v.target = divide(any->target, drawn_parts);
        v.mean = average_points(means);
        if (predictions != nullptr && methods.size() == 1)
            v.predicted = compare_predictions(*predictions, o.motions[any->motion], o.methods[any->method_1],
                                              kind, v.mean);
    }
    return v;
}

std::vector<answer_counts> count_nearest_targets(const run_outline& o, const run_people& people)
{
    const std::size_t n = o.motions.size();
    std::vector<std::optional<point>> places(n);
    for (const person_trials& p : people.all)
        for (const trial& t : *p.trials)
            places[t.motion] = t.target.front().at;
    std::vector<answer_counts> all;
    for (const std::string& method : o.methods)
        all.push_back({method, o.motions, std::vector(n, std::vector<std::size_t>(n))});
    for (const person_trials& p : people.all)
        for (const trial& t : *p.trials) {
            std::size_t nearest = t.motion;
            const auto distance = [&](std::size_t m) { return distance_mm(t.drawn.front().at, *places[m]); };
            for (std::size_t m = 0; m < n; ++m)
                if (places[m] && distance(m) < distance(nearest))
                    nearest = m;
            ++all[t.method_1].counts[t.motion][nearest];
        }
    return all;
}

} // namespace tactor::study
