// SPDX-License-Identifier: MIT
/// \file
/// Faster computation of drives for a moving target, which mostly uses the tactors of the previous place.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {

/// Region in which a model uses the same tactors. It is a disc with three tactors, or the part of a segment
/// that lies in a disc, with two or three tactors. Each reader has its own region.
struct same_tactors {
    point centre = {};
    double radius_mm = 0.0;                    ///< radius of the disc; 0 if no region is known
    rank_triple ranks = {};                    ///< tactors in the model's order
    std::array<std::uint8_t, 3> by_index = {}; ///< indices into `ranks`, sorted by the index of the tactor
    unsigned count = 3;                        ///< number of tactors; if 2, the ends of the segment
    bool on_segment = false;                   ///< true if the region is a part of a segment
    std::array<point, 2> ends = {};            ///< ends of the segment
    unsigned skips = 0; ///< number of next places at which update_same_tactors() does nothing

    bool holds(point p) const noexcept
    {
        const double dx = p.x_mm - centre.x_mm;
        const double dy = p.y_mm - centre.y_mm;
        return dx * dx + dy * dy < radius_mm * radius_mm &&
               (!on_segment || segment_distance_mm(ends[0], ends[1], p) <= surely_on_mm);
    }

    /// Distance at which a point counts as on a segment, even with the greatest rounding error.
    static constexpr double surely_on_mm = 0.5 * same_place_mm;
};

/// A model that uses three tactors nearly everywhere. On a segment between two of the three tactors, it uses
/// all three or only these two.
class model_of_three : public phantom_model {
public:
    /// Finds the three tactors that the model uses at p and in a disc around p. Returns the radius of the
    /// disc, mm, or 0 if the model does not use three tactors at p, or if p is on a border.
    virtual double find_disc_tactors(point p, rank_triple& three) const = 0;
    /// Returns the amplitudes that weights() gives to the first `count` (2 or 3) tactors of `ranks`, in the
    /// order of `ranks`. p must be in the disc of find_disc_tactors() or on the segment of
    /// find_segment_tactors().
    virtual std::array<double, 3> amplitudes(const rank_triple& ranks, unsigned count, point p,
                                             double a_v) const = 0;

    /// Finds the tactors that the model uses at p, which is on the segment between the two tactors `on`, but
    /// on no tactor. Returns the number of tactors: 2 (the tactors `on`) or 3, or 0 if the model may use
    /// other tactors a little farther along the segment. `faces`: faces that contain p.
    virtual unsigned find_segment_tactors(const std::vector<unsigned>& faces, rank_pair on, point p,
                                          rank_triple& taken) const = 0;
};

/// Computes the drives of weights() at a point p within `seen`; a_v > 0.
void compute_same_drives(const model_of_three& m, const layout& l, const same_tactors& seen, point p,
                         double a_v, std::vector<drive>& out);

/// Sets `seen` to the disc or to the part of a segment around p in which the model uses the same tactors, if
/// there is one. p must be in the array.
void update_same_tactors(const model_of_three& m, const layout& l, point p, same_tactors& seen);

/// Returns the distance, mm, by which p may move before it comes near a line through two tactors of the face.
/// With `by_distance`, also before it comes near a place where the order of the tactors by distance changes.
/// Returns 0 or less if p may not move. p must be clear of all these lines.
double face_clearance_mm(const layout::impl& l, unsigned face, point p, bool by_distance);

} // namespace tactor::detail
