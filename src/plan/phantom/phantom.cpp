// SPDX-License-Identifier: MIT
// The phantom models, and their choice for a plan.
#include <tactor/phantom.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/path/shape.hpp"
#include "core/refused.hpp"
#include "plan/faces/face_rules.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/plane.hpp"
#include "plan/faces/same_tactors.hpp"
#include "plan/job.hpp"

namespace tactor::detail {
namespace {

void check_faces(phantom_kind k, faces_kind f)
{
    if (f == faces_kind::nearest && k != phantom_kind::inverse_distance)
        throw bad_field("faces",
                        fmt::format("nearest works only with inverse-distance, not with {}", to_string(k)),
                        "use {faces=delaunay} or {phantom=inverse-distance}");
}

void check_intensity(double a_v)
{
    if (!(a_v >= 0.0 && std::isfinite(a_v)))
        throw bad_field("intensity", fmt::format("{} is not a number from 0 up", a_v));
}

/// Checks the arguments of a model. Returns p, or the nearest point of the hull if p is outside.
/// \throws error (bad_input) if p is not finite, or if a_v is negative or not finite.
point check_request(const layout& l, point p, double a_v)
{
    check_intensity(a_v);
    return clamp_to_array(l, p);
}

/// Adds a drive for the tactor with this rank, if the amplitude is above 0. Keeps drives in order of tactor.
void add_drive(const layout& l, unsigned rank, double amplitude, std::vector<drive>& out)
{
    if (!(amplitude > 0.0))
        return;
    out.push_back({access::of(l).index_of[rank], amplitude});
    for (auto d = out.end() - 1; d != out.begin() && d->tactor < (d - 1)->tactor; --d)
        std::iter_swap(d, d - 1);
}

// Greatest number of tactors of a face whose diagonals are tried one by one.
constexpr std::size_t few = 8;

double distance(const layout& l, unsigned rank, point p)
{
    return length_mm(p, access::of(l).points[rank]);
}

/// Computes Eq. (2).
std::array<double, 2> two_tactor_amplitudes(const layout& l, const rank_pair& two, point p, double a_v)
{
    const double d1 = distance(l, two.first, p);
    const double d2 = distance(l, two.second, p);
    return {std::sqrt(d2 / (d1 + d2)) * a_v, std::sqrt(d1 / (d1 + d2)) * a_v};
}

/// Computes Eq. (10).
std::array<double, 3> three_tactor_amplitudes(const std::array<double, 3>& distances_mm, double a_v)
{
    std::array<double, 3> parts{};
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        sum += parts[i] = 1.0 / distances_mm[i];
    for (double& part : parts)
        part = std::sqrt(part / sum) * a_v;
    return parts;
}

/// Adds the drives of two tactors for a point between them: Eq. (2).
void add_two_drives(const layout& l, const rank_pair& two, point p, double a_v, std::vector<drive>& out)
{
    const std::array<double, 2> a = two_tactor_amplitudes(l, two, p, a_v);
    add_drive(l, two.first, a[0], out);
    add_drive(l, two.second, a[1], out);
}

/// Adds the drives of three tactors: Eq. (10).
void add_three_drives(const layout& l, const near_triple& three, double a_v, std::vector<drive>& out)
{
    const std::array<double, 3> a = three_tactor_amplitudes(three.distances, a_v);
    for (std::size_t i = 0; i < 3; ++i)
        add_drive(l, three.tactors[i], a[i], out);
}

/// The model of Park et al. 2016: Eq. (2) on a segment, Eq. (10) in a triangle.
class inverse_distance final : public model_of_three {
public:
    explicit inverse_distance(const layout& l) : layout_(l) {}

    std::string_view name() const noexcept override { return to_string(phantom_kind::inverse_distance); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
        const layout::impl& l = detail::access::of(layout_);
        const auto clear = l.find_clear_face(p);
        if (clear && l.faces[*clear].size() <= few && l.is_clear_of_diagonals(*clear, p) &&
            add_face_drives(*clear, p, a_v, out))
            return;
        std::vector<unsigned> faces;
        l.find_faces_at(p, faces);
        if (const auto on = tactor_at(l, faces, p))
            add_drive(layout_, *on, a_v, out);
        else if (const auto segment = segment_at(l, faces, p))
            add_two_drives(layout_, *segment, p, a_v, out);
        else
            add_first_face_drives(faces, p, a_v, out);
    }

    double find_disc_tactors(point p, rank_triple& three) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const auto face = l.find_clear_face(p);
        if (!face || l.faces[*face].size() > few || !l.is_clear_of_diagonals(*face, p))
            return 0.0;
        const auto found = triangle_at(l, *face, p);
        if (!found)
            return 0.0;
        three = found->tactors;
        return face_clearance_mm(l, *face, p, true);
    }

    std::array<double, 3> amplitudes(const rank_triple& three, unsigned count, point p,
                                     double a_v) const override
    {
        if (count == 2) {
            const std::array<double, 2> two = two_tactor_amplitudes(layout_, {three[0], three[1]}, p, a_v);
            return {two[0], two[1], 0.0};
        }
        return three_tactor_amplitudes(
            {distance(layout_, three[0], p), distance(layout_, three[1], p), distance(layout_, three[2], p)},
            a_v);
    }

    unsigned find_segment_tactors(const std::vector<unsigned>& faces, rank_pair on, point,
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
    bool add_face_drives(unsigned face, point p, double a_v, std::vector<drive>& out) const
    {
        const auto three = triangle_at(detail::access::of(layout_), face, p);
        if (!three)
            return false;
        add_three_drives(layout_, *three, a_v, out);
        return true;
    }

    void add_first_face_drives(const std::vector<unsigned>& faces, point p, double a_v,
                               std::vector<drive>& out) const
    {
        for (const unsigned f : faces)
            if (add_face_drives(f, p, a_v, out))
                return;
        // Rounding can leave a gap between two faces, and p may lie in this gap.
        add_two_drives(layout_, nearest_edge(detail::access::of(layout_), faces.front(), p), p, a_v, out);
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
        if (length_mm(p, l.points[first]) <= same_place_mm) {
            add_drive(layout_, first, a_v, out);
            return;
        }
        const near_triple three = closest_three(l, ranks_, p);
        if (const auto segment = segment_at(l, three.tactors, p))
            add_two_drives(layout_, *segment, p, a_v, out);
        else
            add_three_drives(layout_, three, a_v, out);
    }

private:
    layout layout_;
    std::vector<unsigned> ranks_; ///< ranks of all tactors
};

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
    const double u = length_mm(a, nearest_segment_point(a, b, p)) / length_mm(a, b);
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
    // A point outside the triangle, but within the tolerance, counts as on the nearest edge.
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

/// Models that compute amplitudes from the barycentric coordinates of p in the Delaunay triangle.
class on_triangle final : public model_of_three {
public:
    on_triangle(phantom_kind k, const layout& l) : kind_(k), layout_(l) {}

    std::string_view name() const noexcept override { return to_string(kind_); }

    void weights(point target, double a_v, std::vector<drive>& out) const override
    {
        out.clear();
        const point p = check_request(layout_, target, a_v);
        const layout::impl& l = detail::access::of(layout_);
        auto face = l.find_clear_face(p);
        if (!face) {
            std::vector<unsigned> faces;
            l.find_faces_at(p, faces);
            if (const auto on = tactor_at(l, faces, p)) {
                add_drive(layout_, *on, a_v, out);
                return;
            }
            face = faces.front();
        }
        for (const weight& w : coordinates(*face, p))
            add_drive(layout_, w.rank, amplitude(w.b) * a_v, out);
    }

    double find_disc_tactors(point p, rank_triple& three) const override
    {
        const layout::impl& l = detail::access::of(layout_);
        const auto face = l.find_clear_face(p);
        if (!face || !l.is_clear_of_diagonals(*face, p))
            return 0.0;
        three = fan_triangle(l, *face, p);
        const bool wound = turn(l.points[three[0]], l.points[three[1]], l.points[three[2]]) > 0.0;
        return wound ? face_clearance_mm(l, *face, p, false) : 0.0;
    }

    // Handles only points on an edge of the face. On an inner side of the fan, rounding would decide which
    // triangle contains p.
    unsigned find_segment_tactors(const std::vector<unsigned>& faces, rank_pair on, point p,
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
        // If p is outside the triangle, the weights come in another order.
        std::array<double, 3> out{};
        for (const weight& w : drop_small_weights(in_triangle(detail::access::of(layout_), three, p)))
            if (const double a = amplitude(w.b) * a_v; a > 0.0)
                out[w.rank == three[0] ? 0 : w.rank == three[1] ? 1 : 2] = a;
        return out;
    }

private:
    /// Returns coordinates whose sum is 1. Sets coordinates below least_weight to 0.
    weights_of_three coordinates(unsigned face, point p) const
    {
        const layout::impl& l = detail::access::of(layout_);
        const std::vector<unsigned>& ring = l.faces[face];
        return drop_small_weights(ring.size() < 3 ? on_segment(l, ring.front(), ring.back(), p)
                                                  : in_triangle(l, fan_triangle(l, face, p), p));
    }

    static weights_of_three drop_small_weights(weights_of_three w)
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

constexpr double sigma_in_pitches = 0.6;
constexpr double least_share = 0.01; // part of the largest weight; smaller weights are dropped

/// The model of Yun, Oh and Choi, WHC 2019: the weights of all tactors fall with distance. Weights below 1 %
/// of the largest weight are dropped.
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
        // Weights are relative to the nearest tactor's weight, so that their sum does not underflow.
        const double nearest = square(length_mm(p, l.points[first]));
        double sum = 0.0;
        for (unsigned v = 0; v < l.points.size(); ++v) {
            const double g = std::exp((nearest - square(length_mm(p, l.points[v]))) / (2.0 * variance_));
            if (g < least_share)
                continue;
            sum += g * g;
            out.push_back({l.index_of[v], g});
        }
        std::sort(out.begin(), out.end(), [](const drive& a, const drive& b) { return a.tactor < b.tactor; });
        for (drive& d : out)
            d.amplitude *= a_v / std::sqrt(sum);
        std::erase_if(out, [](const drive& d) { return !(d.amplitude > 0.0); });
    }

private:
    static double square(double x) { return x * x; }

    layout layout_;
    double variance_;
};

} // namespace

std::shared_ptr<const phantom_model> choose_model(const layout& l, const plan_options& o)
{
    if (!o.custom_phantom) {
        check_faces(o.phantom, o.faces); // also if the algorithm does not use o.faces
        return make_phantom(o.phantom, l, effective_faces(o));
    }
    if (o.faces != faces_kind::delaunay)
        throw bad_field("faces", "nearest works only with inverse-distance, not with your own phantom model",
                        "use {faces=delaunay} or {phantom=inverse-distance}");
    return o.custom_phantom;
}

faces_kind effective_faces(const plan_options& o)
{
    return o.algorithm == algorithm_kind::tactile_brush ? faces_kind::delaunay : o.faces;
}

void compute_drives(const phantom_model& m, const layout& l, point p, double a_v, std::vector<drive>& out)
{
    out.clear();
    check_intensity(a_v);
    if (a_v == 0.0)
        return;
    m.weights(p, a_v, out);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const drive& d = out[i];
        const bool in_order = i == 0 || out[i - 1].tactor < d.tactor;
        if (!in_order || d.tactor >= l.places().size() || !(d.amplitude > 0.0 && std::isfinite(d.amplitude)))
            throw error(error_kind::bad_input, fmt::format("phantom model \"{}\"", m.name()),
                        fmt::format("it gave tactor {} amplitude {}", d.tactor, d.amplitude),
                        "give drives in order of tactor, with finite amplitudes above 0");
    }
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

phantom_model::~phantom_model() = default;

std::shared_ptr<const phantom_model> make_phantom(phantom_kind k, const layout& l, faces_kind f)
{
    detail::check_faces(k, f);
    switch (k) {
    case phantom_kind::inverse_distance:
        // An array in one line has segments, and no triangles.
        if (f == faces_kind::nearest && !l.faces().empty())
            return std::make_shared<detail::nearest_three>(l);
        return std::make_shared<detail::inverse_distance>(l);
    case phantom_kind::barycentric:
    case phantom_kind::linear:
    case phantom_kind::log:
        return std::make_shared<detail::on_triangle>(k, l);
    case phantom_kind::gaussian:
        return std::make_shared<detail::gaussian>(l);
    }
    throw detail::bad_field("phantom", fmt::format("no model has number {}", static_cast<int>(k)));
}

} // namespace v0
} // namespace tactor
