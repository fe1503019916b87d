// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "study/random/random.hpp"

namespace tactor::study {
namespace {

constexpr const char* simulation_shape = "as seed=1,sigma=1";
constexpr double least_cost = 1e-3;

[[noreturn]] void refuse_simulation(const std::string& why)
{
    throw error(error_kind::bad_input, "--simulate", why, simulation_shape);
}

template <class T>
T simulation_value(std::string_view key, std::string_view text, T low, T high)
{
    const auto v = detail::number_in<T>(text);
    if (!v || !(*v >= low && *v <= high))
        refuse_simulation(fmt::format("{} is \"{}\", not {} to {}", key, text, low, high));
    return *v;
}

double mean_distance(const std::vector<point>& a, const std::vector<point>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::hypot(b[i].x_mm - a[i].x_mm, b[i].y_mm - a[i].y_mm);
    return sum / static_cast<double>(a.size());
}

} // namespace

simulation parse_simulation(std::string_view text)
{
    constexpr std::uint64_t most_seed = (std::uint64_t{1} << 53) - 1;
    simulation s;
    std::vector<std::string_view> seen;
    for (const std::string_view item : detail::split(text, ',')) {
        const std::size_t equals = std::min(item.find('='), item.size());
        const std::string_view key = item.substr(0, equals);
        const std::string_view value = equals < item.size() ? item.substr(equals + 1) : std::string_view{};
        if (std::find(seen.begin(), seen.end(), key) != seen.end())
            refuse_simulation(fmt::format("{} is said twice", key));
        seen.push_back(key);
        if (key == "seed")
            s.seed = simulation_value<std::uint64_t>(key, value, 0, most_seed);
        else if (key == "sigma")
            s.sigma = simulation_value(key, value, 0.0, 1e6);
        else if (key == "void")
            s.voids = simulation_value(key, value, 0.0, 0.9);
        else
            refuse_simulation(fmt::format("\"{}\" is not known", key));
    }
    return s;
}

std::string to_text(const simulation& s)
{
    const std::string text = fmt::format("seed={},sigma={}", s.seed, s.sigma);
    return s.voids > 0.0 ? fmt::format("{},void={}", text, s.voids) : text;
}

simulated_observer::simulated_observer(const simulation& s, const experiment_definition& d,
                                       const run_definition& r, const stimulus_set& stimuli,
                                       std::string_view code)
    : simulation_(s),
      definition_(d),
      run_(r),
      stimuli_(stimuli),
      seed_(fmt::format("{}/{}/{}/{}", s.seed, d.name, code, r.outline.name))
{
    if (r.outline.task == task_kind::identify) {
        for (const std::size_t m : r.motions)
            targets_.push_back(target_path(d.motions[m].drawn));
        return;
    }
    double sum = 0.0;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods)
            sum -= std::log(cost(motion, method));
    mean_ = sum / static_cast<double>(r.motions.size() * r.methods.size());
}

double simulated_observer::cost(std::size_t motion, std::size_t method) const
{
    const percept_summary& felt = stimuli_.at(motion, method).felt;
    const std::optional<double> c = run_.attribute == "uniformity" ? felt.speed_cv : felt.rms_error_mm;
    if (!c)
        throw error(error_kind::bad_input, definition_.motions[motion].where,
                    fmt::format("simulate: motion \"{}\" by method \"{}\" is not predicted to {}",
                                definition_.motions[motion].name, definition_.methods[method].name,
                                run_.attribute == "uniformity" ? "be felt to move" : "be felt"),
                    "people may be asked about it; the simulated observer cannot");
    return std::max(*c, least_cost);
}

simulated_answer simulated_observer::answer(const planned_trial& t, unsigned trial, unsigned attempt,
                                            bool practice) const
{
    random_numbers r(fmt::format("{}/{}/{}/{}", seed_, practice ? "practice" : "trial", trial, attempt));
    simulated_answer a;
    a.is_void = r.unit() < simulation_.voids && !practice;
    constexpr unsigned soonest_ms = 400;
    constexpr unsigned range_ms = 1200;
    a.response_time_ms = soonest_ms + r.below(range_ms);
    const auto noise = [&] { return simulation_.sigma * r.normal(); };
    const auto utility = [&](std::size_t method) { return -std::log(cost(t.motion, method)) + noise(); };
    switch (run_.outline.task) {
    case task_kind::choose: {
        const double first = utility(t.method_1);
        a.response = first >= utility(t.method_2.value()) ? 1 : 2;
        break;
    }
    case task_kind::rate: {
        const double scale = run_.outline.scale;
        const double rating = std::round((scale + 1.0) / 2.0 + utility(t.method_1) - mean_);
        a.response = static_cast<unsigned>(std::clamp(rating, 1.0, scale));
        break;
    }
    case task_kind::identify: {
        std::vector<point> felt = stimuli_.at(t.motion, t.method_1).felt_path;
        for (point& p : felt) {
            p.x_mm += noise();
            p.y_mm += noise();
        }
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < run_.motions.size(); ++i) {
            const double d = mean_distance(targets_[i], felt);
            if (d < nearest) {
                nearest = d;
                a.response = static_cast<unsigned>(run_.motions[i]);
            }
        }
        break;
    }
    }
    return a;
}

} // namespace tactor::study
