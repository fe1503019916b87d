// SPDX-License-Identifier: MIT
/// \file
/// Phantom tactors: which tactors play, and how strongly, so that a person feels a point between them. Also
/// fitting of strokes to an array.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

namespace tactor {
inline namespace v0 {

/// Contribution of one tactor to a phantom. The amplitude is linear; 1 is the requested intensity.
struct drive {
    unsigned tactor = 0;
    double amplitude = 0.0;

    friend bool operator==(const drive&, const drive&) = default;
};

/// Distance from the array, mm, up to which a place outside the array counts as on its edge. The rounding
/// errors of drawing programs and unit conversions are smaller.
inline constexpr double edge_tolerance_mm = 0.01 - same_place_mm; // 0.01 itself is outside, rounded or not

/// Delaunay faces of an array (rendering model, section 4). Tactors on one circumcircle form one face.
/// Immutable. Copies and moves share the faces, so a moved-from layout keeps its value. Any thread.
class TACTOR_API layout {
public:
    /// Computes the faces. O(n log n).
    /// \throws error (bad_input) as validate() does, and for two tactors that are too near to each other to
    ///         compute faces (about 1e-9 of the array's extent).
    explicit layout(const array& a);
    layout(const layout&) noexcept = default;
    layout& operator=(const layout&) noexcept = default;

    /// Returns the tactors' places by index.
    [[nodiscard]] const std::vector<point>& places() const noexcept;

    /// Returns the faces. Each face has the indices of its tactors in order round the face. Returns no faces
    /// if all tactors are in one line.
    [[nodiscard]] const std::vector<std::vector<unsigned>>& faces() const noexcept;

    /// Returns true if p is in the hull or on its edge (within same_place_mm). A stroke may leave the hull by
    /// up to edge_tolerance_mm: the places outside are moved to the edge.
    [[nodiscard]] bool contains(point p) const;
    /// Returns the point of the hull nearest to p.
    [[nodiscard]] point nearest(point p) const;

    /// Returns the median distance from a tactor to its nearest neighbour, mm; 0 for a single tactor.
    [[nodiscard]] double pitch_mm() const noexcept;

    struct impl;

private:
    friend struct detail::access;

    std::shared_ptr<const impl> impl_;
};

/// A rule that chooses the tactors that play for a point. Derive from it to make another model.
class TACTOR_API phantom_model {
public:
    phantom_model() = default;
    phantom_model(const phantom_model&) = delete;
    phantom_model& operator=(const phantom_model&) = delete;
    virtual ~phantom_model();
    /// Returns the name for plans and logs.
    [[nodiscard]] virtual std::string_view name() const noexcept = 0;
    /// Replaces `out` by the drives of a phantom of intensity `a_v` at p, in order of tactor. Each amplitude
    /// must be finite and above 0. p is inside the hull.
    ///
    /// The library calls this when it makes a plan, and for each point of a live stroke. For a continuous
    /// stroke it calls this once for each sample (at most ten million). A live stroke ends without playing
    /// the point if an amplitude is above a_v, or if this throws. Two exceptions do not end the stroke: error
    /// (bad_input), which refuses the point, and std::bad_alloc.
    virtual void weights(point p, double a_v, std::vector<drive>& out) const = 0;
};

/// Makes a built-in model on a layout. Each point takes O(log n) for n tactors and O(k log k) for a face of k
/// tactors, which matters only if hundreds of tactors lie on one circle. A point outside the hull counts as
/// the nearest point of the hull.
/// \throws error (bad_input) for faces_kind::nearest with another model than inverse_distance. weights() of
///         the model throws error (bad_input) for a point or an intensity that is not finite, and for an
///         intensity below 0.
[[nodiscard]] TACTOR_API std::shared_ptr<const phantom_model>
make_phantom(phantom_kind k, const layout& l, faces_kind f = faces_kind::delaunay);

/// Placement of a picture: `from` becomes `to`, and all distances are multiplied by `scale`.
struct fitting {
    point from = {};
    point to = {};
    double scale = 1.0;
    double margin_mm = 0.0;
    /// Unit vector along the array if all tactors lie in one line. operator() then projects the picture onto
    /// this line.
    std::optional<point> line = {};

    /// Returns the new place of a point of the picture.
    point operator()(point p) const noexcept
    {
        point way{scale * (p.x_mm - from.x_mm), scale * (p.y_mm - from.y_mm)};
        if (line) {
            const double along = way.x_mm * line->x_mm + way.y_mm * line->y_mm;
            way = {along * line->x_mm, along * line->y_mm};
        }
        return {to.x_mm + way.x_mm, to.y_mm + way.y_mm};
    }
};

/// Result of fit_strokes().
struct fitted_strokes {
    std::vector<stroke> strokes = {};
    fitting placed = {};
};

/// Moves and scales strokes together, as a single picture. The middle of the picture's bounds moves to the
/// middle of the array, which is the centre of gravity of the hull of the tactors' centres. The picture
/// becomes as large as possible inside that hull (the area that outside_kind::error accepts), at least
/// `margin_mm` (finite, >= 0) from the edge. The ratio of width to height does not change. `l` is the layout
/// of the array, as in fit_strokes(strokes, layout(a)).
///
/// If all tactors lie in one line, within a tenth of their pitch, that line is the array. The picture is then
/// projected onto the line, and fitted by its extent along the line. A picture without extent (a timed stroke
/// that rests) moves to the middle.
///
/// Strokes with a speed (stroke::speed_mm_s) keep that speed. The other strokes keep their duration, whatever
/// their new length is. Starts, intensities and carriers do not change. A pure function; any thread. O(n log
/// n) for n points, and O(k h) for k curves and a hull of h corners.
/// \throws error (bad_input) for a margin that leaves no part of the array, for a picture with an extent if
///         the array is a single tactor, and for a stroke that only crosses the line of an array in one line.
[[nodiscard]] TACTOR_API fitted_strokes fit_strokes(const std::vector<stroke>& strokes, const layout& l,
                                                    double margin_mm = 0.0);

/// Fits each stroke that has a stroke::fit, alone or together with the other strokes of its group. The
/// returned strokes have no stroke::fit. Throws as fit_strokes() does.
[[nodiscard]] TACTOR_API std::vector<stroke> apply_fits(std::vector<stroke> strokes, const layout& l);

} // namespace v0
} // namespace tactor
