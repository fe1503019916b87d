// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/access.hpp"
#include "core/distance.hpp"
#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"
#include "plan/phantom/phantom_models.hpp"
#include "plan/phantom/same_tactors.hpp"

namespace tactor::detail {
namespace {

// Segments of so few tactors are looked at one by one.
constexpr std::size_t few = 8;

double distance(const layout& l, unsigned rank, point p)
{
    return length_mm(p, access::of(l).points[rank]);
}

/// Computes Eq. (2).
std::array<double, 2> share_of_two(const layout& l, const rank_pair& two, point p, double a_v)
{
    const double d1 = distance(l, two.first, p);
    const double d2 = distance(l, two.second, p);
    return {std::sqrt(d2 / (d1 + d2)) * a_v, std::sqrt(d1 / (d1 + d2)) * a_v};
}

/// Computes Eq. (10).
std::array<double, 3> share_of_three(const std::array<double, 3>& distances_mm, double a_v)
{
    std::array<double, 3> parts{};
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        sum += parts[i] = 1.0 / distances_mm[i];
    for (double& part : parts)
        part = std::sqrt(part / sum) * a_v;
    return parts;
}

/// Park et al. 2016: Eq. (2) on a segment, Eq. (10) in a triangle.
class inverse_distance final : public model_of_three {
public:
    explicit inverse_distance(const layout& l) : layout_(l) {}

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
        const layout::impl& l = detail::access::of(layout_);
        const auto clear = l.clear_face(p);
        if (clear && l.faces[*clear].size() <= few && l.clear_of_diagonals(*clear, p) &&
            in_face(*clear, p, a_v, out)) {
            sort_drives(out);
            return;
        }
        std::vector<unsigned> faces;
        l.faces_at(p, faces);
        if (const auto on = tactor_at(l, faces, p))
            add_drive(layout_, *on, a_v, out);
        else if (const auto segment = segment_at(l, faces, p))
            add_two(layout_, *segment, p, a_v, out);
        else
            in_faces(faces, p, a_v, out);
        sort_drives(out);
    }

    double three_around(point p, rank_triple& three) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const auto face = l.clear_face(p);
        if (!face || l.faces[*face].size() > few || !l.clear_of_diagonals(*face, p))
            return 0.0;
        const auto found = triangle_at(l, *face, p);
        if (!found)
            return 0.0;
        three = found->tactors;
        return free_mm(l, *face, p, true);
    }

    std::array<double, 3> amplitudes(const rank_triple& three, unsigned count, point p,
                                     double a_v) const override
    {
        if (count == 2) {
            const std::array<double, 2> two = share_of_two(layout_, {three[0], three[1]}, p, a_v);
            return {two[0], two[1], 0.0};
        }
        return share_of_three(
            {distance(layout_, three[0], p), distance(layout_, three[1], p), distance(layout_, three[2], p)},
            a_v);
    }

    unsigned taken_along(const std::vector<unsigned>& faces, rank_pair on, point,
                         rank_triple& taken) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const auto is_large = [&](unsigned f) { return l.faces[f].size() > few; };
        if (std::any_of(faces.begin(), faces.end(), is_large))
            return 0;
        taken = {on.first, on.second, 0};
        return 2;
    }

private:
    bool in_face(unsigned face, point p, double a_v, std::vector<drive>& out) const
    {
        const auto three = triangle_at(detail::access::of(layout_), face, p);
        if (!three)
            return false;
        add_three(layout_, *three, a_v, out);
        return true;
    }

    void in_faces(const std::vector<unsigned>& faces, point p, double a_v, std::vector<drive>& out) const
    {
        for (const unsigned f : faces)
            if (in_face(f, p, a_v, out))
                return;
        // Rounding can leave a gap between two faces; p may lie in it.
        add_two(layout_, nearest_edge(detail::access::of(layout_), faces.front(), p), p, a_v, out);
    }

    layout layout_;
};

/// The literal rule of Park et al. 2016: the three closest of all tactors, even if their triangle misses p.
class nearest_three final : public phantom_model {
public:
    explicit nearest_three(const layout& l) : layout_(l), ranks_(l.places().size())
    {
        std::iota(ranks_.begin(), ranks_.end(), 0U);
    }

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
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

void add_two(const layout& l, const rank_pair& two, point p, double a_v, std::vector<drive>& out)
{
    const std::array<double, 2> a = share_of_two(l, two, p, a_v);
    add_drive(l, two.first, a[0], out);
    add_drive(l, two.second, a[1], out);
}

void add_three(const layout& l, const near_triple& three, double a_v, std::vector<drive>& out)
{
    const std::array<double, 3> a = share_of_three(three.distances, a_v);
    for (std::size_t i = 0; i < 3; ++i)
        add_drive(l, three.tactors[i], a[i], out);
}

std::shared_ptr<const phantom_model> make_inverse_distance(const layout& l)
{
    return std::make_shared<inverse_distance>(l);
}

std::shared_ptr<const phantom_model> make_nearest_three(const layout& l)
{
    // In one line there are segments, and no three.
    if (l.faces().empty())
        return make_inverse_distance(l);
    return std::make_shared<nearest_three>(l);
}

} // namespace tactor::detail
