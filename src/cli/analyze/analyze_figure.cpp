// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/analyze/analyze_output.hpp"
#include "plot/bar_figure.hpp"

namespace tactor::cli {
namespace {

plot::bar_series make_bars(const std::string& name, const study::by_motion& b)
{
    plot::bar_series s{name};
    for (std::size_t m = 0; m < b.motion.size(); ++m)
        s.bars.push_back({b.motion[m].mean, b.motion[m].se, b.motion_values[m]});
    s.bars.push_back({b.all.mean, b.all.se, b.all_values});
    return s;
}

plot::bar_panel make_panel(const study::run_analysis& r)
{
    plot::bar_panel p;
    p.title = fmt::format("{} (n = {})", r.run.name, r.n);
    p.groups = r.run.motions;
    p.groups.emplace_back("all");
    switch (r.run.task) {
    case study::task_kind::choose:
        p.y_title = fmt::format("{} chosen (%)", r.run.methods.back());
        p.series.push_back(make_bars("", r.cells[0]));
        p.level = 50.0;
        p.y_to = 100.0;
        return p;
    case study::task_kind::rate:
        p.y_title = "mean rating";
        p.y_from = 1.0;
        p.y_to = r.run.scale;
        break;
    case study::task_kind::identify:
        p.y_title = "correct (%)";
        p.level = study::chance(r.run);
        p.y_to = 100.0;
        break;
    }
    for (std::size_t m = 0; m < r.run.methods.size(); ++m)
        p.series.push_back(make_bars(r.run.methods[m], r.cells[m]));
    return p;
}

} // namespace

plot::canvas draw_analysis(const study::analysis& a, const picture_options& o)
{
    plot::bar_figure f;
    f.title = o.choose_title(a.experiment);
    f.heading = o.has_title();
    f.width_mm = o.width_mm;
    f.note = "Means over participants; error bars: standard errors; dots: participants.";
    f.across = a.simulated ? "simulated" : "";
    for (const study::run_analysis& r : a.runs)
        if (r.n != 0)
            f.panels.push_back(make_panel(r));
    return plot::draw_bar_figure(f);
}

} // namespace tactor::cli
