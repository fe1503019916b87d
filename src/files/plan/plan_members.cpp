// SPDX-License-Identifier: MIT
#include "files/plan/plan_members.hpp"

#include <cmath>

namespace tactor::files {

thresholds find_thresholds(const tactor_spec& t)
{
    if (t.thresholds.empty())
        return t.threshold_dbfs ? thresholds{*t.threshold_dbfs} : thresholds{};
    std::vector<std::array<double, 2>> all;
    for (const threshold_point& p : t.thresholds)
        all.push_back({p.hz, p.dbfs});
    return {all};
}

void set_thresholds(tactor_spec& t, const thresholds& v)
{
    if (!v.value)
        return;
    if (const double* const one = std::get_if<double>(&*v.value))
        t.threshold_dbfs = *one;
    else
        for (const auto& [hz, dbfs] : std::get<1>(*v.value))
            t.thresholds.push_back({hz, dbfs});
}

std::vector<std::optional<double>> list_peaks_dbfs(const array& a, double carrier_hz, const render_options& o)
{
    std::vector<std::optional<double>> all;
    for (const tactor_spec& t : a.tactors) {
        all.emplace_back(o.level_dbfs + t.gain_db);
        if (!o.sl_db)
            continue;
        const auto threshold = threshold_at(t, carrier_hz);
        all.back() = threshold ? std::optional(*threshold + *o.sl_db) : std::nullopt;
    }
    return all;
}

std::optional<fit_matrix> make_matrix(const std::optional<fitting>& f)
{
    if (!f)
        return {};
    const auto matrix = [&f](double a, double across, double d) {
        const point origin = (*f)({0.0, 0.0});
        return fit_matrix{f->margin_mm, {a, across, across, d, origin.x_mm, origin.y_mm}};
    };
    if (!f->line)
        return matrix(f->scale, 0.0, f->scale);
    const auto [x, y] = *f->line;
    return matrix(f->scale * x * x, f->scale * x * y, f->scale * y * y);
}

fitting make_fitting(const fit_matrix& given)
{
    const auto& m = given.matrix;
    fitting f{.to = {m[4], m[5]}, .scale = m[0], .margin_mm = given.margin_mm};
    if (m[0] != m[3] || m[1] != 0.0) {
        f.scale = m[0] + m[3];
        f.line = {std::sqrt(m[0] / f.scale), std::copysign(std::sqrt(m[3] / f.scale), m[1])};
    }
    return f;
}

std::string note_text(note_kind n)
{
    switch (n) {
    case note_kind::none:
        break;
    case note_kind::reconstructed:
        return "reconstructed: the figure that shows it is not in the paper's text";
    }
    return "";
}

} // namespace tactor::files
