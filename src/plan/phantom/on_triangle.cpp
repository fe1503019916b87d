// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/access.hpp"
#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"
#include "plan/phantom/phantom_models.hpp"
#include "plan/phantom/same_tactors.hpp"

namespace tactor::detail {
namespace {

constexpr double least_weight = 1e-9;

struct weight {
    unsigned rank = 0;
    double b = 0.0;
};

using weights_of_three = std::array<weight, 3>;

weights_of_three on_segment(const layout::impl& l, unsigned i, unsigned j, point p)
{
    const point a = l.points[i];
    const point b = l.points[j];
    const double u = length_mm(a, nearest_on_segment(a, b, p)) / length_mm(a, b);
    return {{{i, 1.0 - u}, {j, u}, {j, 0.0}}};
}

weights_of_three in_triangle(const layout::impl& l, const rank_triple& t, point p)
{
    const auto at = [&](std::size_t i) { return l.points[t[i % 3]]; };
    weights_of_three w;
    for (std::size_t i = 0; i < 3; ++i)
        w[i] = {t[i], turn(at(i + 1), at(i + 2), p)};
    if (std::all_of(w.begin(), w.end(), [](const weight& x) { return x.b >= 0.0; }) &&
        turn(at(0), at(1), at(2)) > 0.0)
        return w;
    // Beside the triangle within the tolerance: on its nearest edge.
    const auto off = [&](std::size_t i) { return segment_distance_mm(at(i), at(i + 1), p); };
    std::size_t best = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (off(i) < off(best))
            best = i;
    return on_segment(l, t[best], t[(best + 1) % 3], p);
}

bool is_edge(const std::vector<unsigned>& ring, rank_pair ends)
{
    for (std::size_t i = 0; i < ring.size(); ++i)
        if (rank_pair(std::minmax(ring[i], ring[(i + 1) % ring.size()])) == ends)
            return true;
    return false;
}

/// Models of the barycentric coordinates in the Delaunay triangle of p.
class on_triangle final : public model_of_three {
public:
    on_triangle(phantom_kind k, const layout& l) : kind_(k), layout_(l) {}

    std::string_view name() const noexcept override { return to_string(kind_); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
        const layout::impl& l = detail::access::of(layout_);
        auto face = l.clear_face(p);
        if (!face) {
            std::vector<unsigned> faces;
            l.faces_at(p, faces);
            if (const auto on = tactor_at(l, faces, p)) {
                add_drive(layout_, *on, a_v, out);
                return;
            }
            face = faces.front();
        }
        for (const weight& w : coordinates(*face, p))
            add_drive(layout_, w.rank, amplitude(w.b) * a_v, out);
        sort_drives(out);
    }

    double three_around(point p, rank_triple& three) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const auto face = l.clear_face(p);
        if (!face || !l.clear_of_diagonals(*face, p))
            return 0.0;
        three = fan_triangle(l, *face, p);
        const bool wound = turn(l.points[three[0]], l.points[three[1]], l.points[three[2]]) > 0.0;
        return wound ? free_mm(l, *face, p, false) : 0.0;
    }

    // Only along an edge of the face: of the fan's other sides, the side of them decides.
    unsigned taken_along(const std::vector<unsigned>& faces, rank_pair on, point p,
                         rank_triple& taken) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const unsigned face = faces.front();
        if (l.faces[face].size() < 3 || !is_edge(l.faces[face], on))
            return 0;
        taken = fan_triangle(l, face, p);
        return 3;
    }

    std::array<double, 3> amplitudes(const rank_triple& three, unsigned, point p, double a_v) const override
    {
        // Beside the triangle they come in an order of their own.
        std::array<double, 3> out{};
        for (const weight& w : drop_least(in_triangle(detail::access::of(layout_), three, p)))
            if (const double a = amplitude(w.b) * a_v; a > 0.0)
                out[w.rank == three[0] ? 0 : w.rank == three[1] ? 1 : 2] = a;
        return out;
    }

private:
    /// Sum 1, the least ones zero.
    weights_of_three coordinates(unsigned face, point p) const
    {
        const layout::impl& l = detail::access::of(layout_);
        const std::vector<unsigned>& ring = l.faces[face];
        return drop_least(ring.size() < 3 ? on_segment(l, ring.front(), ring.back(), p)
                                          : in_triangle(l, fan_triangle(l, face, p), p));
    }

    static weights_of_three drop_least(weights_of_three w)
    {
        normalise(w);
        for (weight& x : w)
            x.b = x.b < least_weight ? 0.0 : x.b;
        normalise(w);
        return w;
    }

    static void normalise(weights_of_three& w)
    {
        double sum = 0.0;
        for (weight& x : w)
            sum += x.b;
        for (weight& x : w)
            x.b /= sum;
    }

    double amplitude(double b) const
    {
        switch (kind_) {
        case phantom_kind::linear:
            return b;
        case phantom_kind::log:
            return std::log2(1.0 + b);
        default:
            return std::sqrt(b);
        }
    }

    phantom_kind kind_;
    layout layout_;
};

} // namespace

std::shared_ptr<const phantom_model> make_on_triangle(phantom_kind k, const layout& l)
{
    return std::make_shared<on_triangle>(k, l);
}

} // namespace tactor::detail
