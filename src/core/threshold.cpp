// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>

#include <algorithm>
#include <cmath>

namespace tactor {
inline namespace v0 {

std::optional<double> threshold_at(const tactor_spec& t, double hz)
{
    const std::vector<threshold_point>& points = t.thresholds;
    if (points.empty())
        return t.threshold_dbfs;
    const auto above =
        std::find_if(points.begin(), points.end(), [hz](const threshold_point& p) { return p.hz >= hz; });
    if (above == points.begin())
        return points.front().dbfs;
    if (above == points.end())
        return points.back().dbfs;
    const threshold_point& below = *(above - 1);
    const double part = std::log(hz / below.hz) / std::log(above->hz / below.hz);
    return std::lerp(below.dbfs, above->dbfs, part);
}

} // namespace v0
} // namespace tactor
