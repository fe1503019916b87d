// SPDX-License-Identifier: MIT
#include "files/plan/plan_fit.hpp"

#include <cmath>
#include <vector>

namespace tactor::files {

nlohmann::ordered_json fit_json(const fitting& f)
{
    const auto matrix = [&f](double a, double across, double d) {
        const point origin = f({0.0, 0.0});
        return nlohmann::ordered_json{{"margin_mm", f.margin_mm},
                                      {"matrix", {a, across, across, d, origin.x_mm, origin.y_mm}}};
    };
    if (!f.line)
        return matrix(f.scale, 0.0, f.scale);
    const auto [x, y] = *f.line;
    return matrix(f.scale * x * x, f.scale * x * y, f.scale * y * y);
}

std::optional<fitting> read_fitting(const json_value& plan)
{
    const json_value told = plan["stroke"]["fit"];
    if (!told.there())
        return {};
    const std::vector<double> m = told["matrix"].need_numbers();
    if (m.size() != 6)
        told["matrix"].refuse("has not six numbers");
    fitting f{.to = {m[4], m[5]}, .scale = m[0], .margin_mm = told["margin_mm"].need_number()};
    if (m[0] != m[3] || m[1] != 0.0) {
        f.scale = m[0] + m[3];
        f.line = {std::sqrt(m[0] / f.scale), std::copysign(std::sqrt(m[3] / f.scale), m[1])};
    }
    return f;
}

} // namespace tactor::files
