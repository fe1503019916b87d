// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/access.hpp"
#include "core/distance.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/phantom/phantom_models.hpp"

namespace tactor::detail {
namespace {

constexpr double sigma_in_pitches = 0.6;
constexpr double least_share = 0.01; // of the largest weight

/// After Yun, Oh and Choi, WHC 2019: all tactors near the point, by distance.
class gaussian final : public phantom_model {
public:
    explicit gaussian(const layout& l) : layout_(l), variance_(square(sigma_in_pitches * l.pitch_mm())) {}

    std::string_view name() const noexcept override { return to_string(phantom_kind::gaussian); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
        const layout::impl& l = detail::access::of(layout_);
        const unsigned first = l.nearest_tactor(p);
        if (!(variance_ > 0.0)) {
            add_drive(layout_, first, a_v, out);
            return;
        }
        // Relative to the nearest tactor's weight, so that none underflows.
        const double nearest = square(length_mm(p, l.points[first]));
        double sum = 0.0;
        for (unsigned v = 0; v < l.points.size(); ++v) {
            const double g = std::exp((nearest - square(length_mm(p, l.points[v]))) / (2.0 * variance_));
            if (g < least_share)
                continue;
            sum += g * g;
            out.push_back({l.index_of[v], g});
        }
        for (drive& d : out)
            d.amplitude *= a_v / std::sqrt(sum);
        std::erase_if(out, [](const drive& d) { return !(d.amplitude > 0.0); });
        sort_drives(out);
    }

private:
    static double square(double x) { return x * x; }

    layout layout_;
    double variance_;
};

} // namespace

std::shared_ptr<const phantom_model> make_gaussian(const layout& l)
{
    return std::make_shared<gaussian>(l);
}

} // namespace tactor::detail
