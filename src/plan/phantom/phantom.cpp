// SPDX-License-Identifier: MIT
#include <tactor/phantom.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/refused.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/phantom/phantom_models.hpp"

namespace tactor {
inline namespace v0 {

phantom_model::~phantom_model() = default;

std::shared_ptr<const phantom_model> make_phantom(phantom_kind k, const layout& l, faces_kind f)
{
    detail::check_faces(k, f);
    if (f == faces_kind::nearest)
        return detail::make_nearest_three(l);
    switch (k) {
    case phantom_kind::inverse_distance:
        return detail::make_inverse_distance(l);
    case phantom_kind::barycentric:
    case phantom_kind::linear:
    case phantom_kind::log:
        return detail::make_on_triangle(k, l);
    case phantom_kind::gaussian:
        return detail::make_gaussian(l);
    }
    throw detail::bad_field("phantom", fmt::format("no model has number {}", static_cast<int>(k)));
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

void check_faces(phantom_kind k, faces_kind f)
{
    if (f == faces_kind::nearest && k != phantom_kind::inverse_distance)
        throw bad_field("faces",
                        fmt::format("nearest goes with inverse-distance only, not with {}", to_string(k)),
                        "use {faces=delaunay} or {phantom=inverse-distance}");
}

void check_intensity(double a_v)
{
    if (!(a_v >= 0.0 && std::isfinite(a_v)))
        throw bad_field("intensity", fmt::format("{} is not a number from 0 up", a_v));
}

point check_request(const layout& l, point p, double a_v)
{
    check_intensity(a_v);
    return l.contains(p) ? p : l.nearest(p);
}

void add_drive(const layout& l, unsigned rank, double amplitude, std::vector<drive>& out)
{
    if (amplitude > 0.0)
        out.push_back({detail::access::of(l).index_of[rank], amplitude});
}

void sort_drives(std::vector<drive>& out)
{
    // A sort is a call; there are three of them nearly always.
    const auto by_tactor = [](const drive& a, const drive& b) { return a.tactor < b.tactor; };
    if (out.size() == 3) {
        if (by_tactor(out[1], out[0]))
            std::swap(out[0], out[1]);
        if (by_tactor(out[2], out[1]))
            std::swap(out[1], out[2]);
        if (by_tactor(out[1], out[0]))
            std::swap(out[0], out[1]);
        return;
    }
    std::sort(out.begin(), out.end(), by_tactor);
}

} // namespace tactor::detail
