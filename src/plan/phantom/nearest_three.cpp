// SPDX-License-Identifier: MIT
#include <numeric>
#include <vector>

#include "core/access.hpp"
#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"
#include "plan/phantom/phantom_models.hpp"

namespace tactor::detail {
namespace {

/// The rule of Park et al. 2016 as it is written: the three closest of all tactors, wherever their triangle
/// lies.
class nearest_three final : public phantom_model {
public:
    explicit nearest_three(const layout& l) : layout_(l), ranks_(l.places().size())
    {
        std::iota(ranks_.begin(), ranks_.end(), 0U);
    }

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point asked, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, asked, a_v);
        const layout::impl& l = access::of(layout_);
        const unsigned first = l.nearest_tactor(p);
        const double first_mm = length_mm(p, l.points[first]);
        if (first_mm <= same_place_mm) {
            add_drive(layout_, first, a_v, out);
            return;
        }
        const near_triple three = closest_three(l, ranks_, p);
        if (const auto segment = segment_at(l, three.tactors, p))
            add_two(layout_, *segment, p, a_v, out);
        else
            add_three(layout_, three, a_v, out);
        sort_drives(out);
    }

private:
    layout layout_;
    std::vector<unsigned> ranks_; ///< of all tactors
};

} // namespace

std::shared_ptr<const phantom_model> make_nearest_three(const layout& l)
{
    // In one line there are segments, and no three.
    if (l.faces().empty())
        return make_inverse_distance(l);
    return std::make_shared<nearest_three>(l);
}

} // namespace tactor::detail
