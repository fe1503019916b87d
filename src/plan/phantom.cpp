// SPDX-License-Identifier: MIT
#include <tactor/phantom.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "plan/layout_impl.hpp"
#include "plan/phantom_models.hpp"

namespace tactor {
namespace {

constexpr std::array kinds{phantom_kind::inverse_distance, phantom_kind::barycentric, phantom_kind::linear,
                           phantom_kind::log, phantom_kind::gaussian};

} // namespace

phantom_model::~phantom_model() = default;

std::string_view to_string(phantom_kind k) noexcept
{
    switch (k) {
    case phantom_kind::inverse_distance:
        return "inverse-distance";
    case phantom_kind::barycentric:
        return "barycentric";
    case phantom_kind::linear:
        return "linear";
    case phantom_kind::log:
        return "log";
    case phantom_kind::gaussian:
        return "gaussian";
    }
    return "unknown";
}

phantom_kind phantom_from_string(std::string_view name)
{
    const auto it =
        std::find_if(kinds.begin(), kinds.end(), [&](phantom_kind k) { return to_string(k) == name; });
    if (it != kinds.end())
        return *it;
    throw error(errc::bad_input, "phantom", fmt::format("there is no model \"{}\"", name),
                "one of inverse-distance, barycentric, linear, log, gaussian");
}

std::shared_ptr<const phantom_model> make_phantom(phantom_kind k, const layout& l)
{
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
    throw error(errc::bad_input, "phantom", fmt::format("no model has number {}", static_cast<int>(k)));
}

namespace detail {

point check_request(const layout& l, point p, double a_v)
{
    if (!std::isfinite(a_v) || a_v < 0.0)
        throw error(errc::bad_input, "intensity", fmt::format("{} is not a number from 0 up", a_v));
    return l.contains(p) ? p : l.nearest(p);
}

void add_drive(const layout& l, unsigned rank, double amplitude, std::vector<drive>& out)
{
    if (amplitude > 0.0)
        out.push_back({l.data().index_of[rank], amplitude});
}

void sort_drives(std::vector<drive>& out)
{
    std::sort(out.begin(), out.end(), [](const drive& a, const drive& b) { return a.tactor < b.tactor; });
}

} // namespace detail
} // namespace tactor
