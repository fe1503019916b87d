// SPDX-License-Identifier: MIT
#include <cmath>

#include "plan/face_rules.hpp"
#include "plan/phantom_models.hpp"

namespace tactor::detail {
namespace {

/// Park et al. 2016: Eq. (2) on a segment, Eq. (10) in a triangle.
class inverse_distance final : public phantom_model {
public:
    explicit inverse_distance(const layout& l) : layout_(l) {}

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point asked, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, asked, a_v);
        const layout::impl& l = layout_.data();
        std::vector<unsigned> faces;
        l.faces_at(p, faces);
        if (const auto on = tactor_at(l, faces, p))
            add_drive(layout_, *on, a_v, out);
        else if (const auto segment = segment_at(l, faces, p))
            on_segment(*segment, p, a_v, out);
        else
            in_face(faces, p, a_v, out);
        sort_drives(out);
    }

private:
    double distance(unsigned rank, point p) const { return distance_mm(p, layout_.data().points[rank]); }

    void on_segment(rank_pair ends, point p, double a_v, std::vector<drive>& out) const
    {
        const double d1 = distance(ends.first, p);
        const double d2 = distance(ends.second, p);
        add_drive(layout_, ends.first, std::sqrt(d2 / (d1 + d2)) * a_v, out);
        add_drive(layout_, ends.second, std::sqrt(d1 / (d1 + d2)) * a_v, out);
    }

    void in_face(const std::vector<unsigned>& faces, point p, double a_v, std::vector<drive>& out) const
    {
        for (const unsigned f : faces)
            if (const auto three = triangle_at(layout_.data(), f, p)) {
                double sum = 0.0;
                for (const unsigned v : *three)
                    sum += 1.0 / distance(v, p);
                for (const unsigned v : *three)
                    add_drive(layout_, v, std::sqrt(1.0 / distance(v, p) / sum) * a_v, out);
                return;
            }
        // Beside a face by more than the tolerance, where rounding opened a gap.
        on_segment(nearest_edge(layout_.data(), faces.front(), p), p, a_v, out);
    }

    layout layout_;
};

} // namespace

std::shared_ptr<const phantom_model> make_inverse_distance(const layout& l)
{
    return std::make_shared<inverse_distance>(l);
}

} // namespace tactor::detail
