// SPDX-License-Identifier: MIT
#include "study/data/definition.hpp"

#include <algorithm>

#include "core/start_times.hpp"

namespace tactor::study {

std::vector<stroke_span> list_spans(const std::vector<stroke>& strokes)
{
    detail::start_times times;
    std::vector<stroke_span> all;
    for (const stroke& s : strokes) {
        const double start_s = times.start(s.start_s, s.anchor);
        all.push_back({start_s, times.set_duration(s.motion.duration_s())});
    }
    return all;
}

double find_duration_s(const std::vector<stroke>& strokes)
{
    return std::ranges::max(list_spans(strokes), {}, &stroke_span::end_s).end_s;
}

std::vector<std::vector<point>> sample_strokes(const std::vector<stroke>& strokes)
{
    std::vector<std::vector<point>> all;
    for (const stroke& s : strokes) {
        all.emplace_back();
        for (std::size_t i = 0; i <= path_parts; ++i)
            all.back().push_back(
                s.motion.position(s.motion.duration_s() * static_cast<double>(i) / path_parts));
    }
    return all;
}

drawing join_paths(const std::vector<std::vector<point>>& paths, const std::vector<stroke>& strokes)
{
    drawing d;
    double from_s = 0.0;
    for (std::size_t s = 0; s < paths.size(); ++s) {
        const double lasts_s = strokes[s].motion.duration_s();
        for (std::size_t i = 0; i <= path_parts; i += 2)
            d.push_back({from_s + lasts_s * static_cast<double>(i) / path_parts, paths[s][i]});
        from_s += lasts_s;
    }
    return thin_out(std::move(d));
}

std::vector<std::size_t> planned_trial::list_methods() const
{
    std::vector<std::size_t> all{method_1};
    for (const auto& more : {method_2, method_3})
        if (more)
            all.push_back(*more);
    return all;
}

std::optional<unsigned> find_odd_stimulus(const planned_trial& t)
{
    if (!t.method_3)
        return {};
    return t.method_1 == *t.method_2 ? 3U : t.method_1 == *t.method_3 ? 2U : 1U;
}

void set_value(planned_trial& t, const run_definition& r, std::size_t place)
{
    const auto set = [&](std::size_t& played) {
        for (const auto& [method, v] : r.variants)
            for (const std::vector<std::size_t>* all : {&v.values, &v.silences})
                if (std::ranges::count(*all, played) != 0) {
                    played = (*all)[place];
                    return;
                }
    };
    set(t.method_1);
    for (auto* more : {&t.method_2, &t.method_3})
        if (*more)
            set(**more);
}

std::optional<double> find_value(const experiment_definition& d, const planned_trial& t)
{
    const std::vector<std::size_t> all = t.list_methods();
    const auto compared = std::ranges::find_if(
        all, [&d](std::size_t method) { return d.methods[method].name != standard_name; });
    return d.methods[compared != all.end() ? *compared : t.method_1].value;
}

} // namespace tactor::study
