// SPDX-License-Identifier: MIT
/// \file
/// Phantom tactors: which tactors play, and how strongly, so that one feels a point between them; strokes
/// fitted to an array.
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

/// One tactor's part in a phantom: linear amplitude, where 1 is the intensity asked for.
struct drive {
    unsigned tactor = 0;
    double amplitude = 0.0;

    friend bool operator==(const drive&, const drive&) = default;
};

/// Delaunay faces of an array (rendering model, section 4). Tactors on one circumcircle form one face.
/// Immutable; copies and moves share it, and a layout that was moved from keeps its value; any thread may
/// call.
class TACTOR_API layout {
public:
    /// O(n log n). \throws error (bad_input) as validate() does, and where two tactors are nearer to each
    /// other than about 1e-9 of the array's extent, which is too near to compute faces.
    explicit layout(const array& a);
    layout(const layout&) noexcept = default;
    layout& operator=(const layout&) noexcept = default;

    /// Tactor places by index.
    [[nodiscard]] const std::vector<point>& places() const noexcept;

    /// Faces as tactor indices in order round the face; none where all tactors are in one line.
    [[nodiscard]] const std::vector<std::vector<unsigned>>& faces() const noexcept;

    /// Whether p is in the hull, its edge included (within same_place_mm).
    [[nodiscard]] bool contains(point p) const;
    /// The point of the hull nearest to p.
    [[nodiscard]] point nearest(point p) const;

    /// Median distance from a tactor to its nearest neighbour, mm; 0 for a single tactor.
    [[nodiscard]] double pitch_mm() const noexcept;

    struct impl;

private:
    friend struct detail::access;

    std::shared_ptr<const impl> impl_;
};

/// A rule that gives the tactors of a point. Derive from it for a model of your own.
class TACTOR_API phantom_model {
public:
    phantom_model() = default;
    phantom_model(const phantom_model&) = delete;
    phantom_model& operator=(const phantom_model&) = delete;
    virtual ~phantom_model();
    /// Name for plans and logs.
    [[nodiscard]] virtual std::string_view name() const noexcept = 0;
    /// Replaces `out` by the drives for a phantom of intensity `a_v` at p, in order of tactor, each amplitude
    /// finite and > 0. If an amplitude is above a_v, a live stroke does not play the point but ends; so it
    /// does where this throws, but for an error of bad_input, which refuses the point, and bad_alloc. p is
    /// inside the hull. Called where plans are made, for a continuous stroke once a sample (at most ten
    /// million of them), and for each point of a live stroke.
    virtual void weights(point p, double a_v, std::vector<drive>& out) const = 0;
};

/// A built-in model on a layout. O(log n) in the tactors for each point, and O(k log k) in those of the face,
/// which matters only where hundreds lie on one circle. A point outside the hull is taken for the nearest
/// point of it. \throws error (bad_input), from weights(), for a point or an intensity that is not finite,
/// and for an intensity below 0; here, for faces_kind::nearest with another model than inverse_distance.
[[nodiscard]] TACTOR_API std::shared_ptr<const phantom_model>
make_phantom(phantom_kind k, const layout& l, faces_kind f = faces_kind::delaunay);

/// Where a picture was put: `from` became `to`, and all distances are `scale` times what they were.
struct fitting {
    point from = {};
    point to = {};
    double scale = 1.0;
    double margin_mm = 0.0;
    /// Direction, of length 1, of an array in one line. Of the picture only the extent along this line is
    /// left.
    std::optional<point> line = {};

    /// Where a place of the picture is now.
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

/// What fit_strokes() gives.
struct fitted_strokes {
    std::vector<stroke> strokes = {};
    fitting placed = {};
};

/// Moves and scales strokes, all alike, as one picture. The middle of their common bounds comes to the
/// array's middle, the centre of gravity of the hull of the tactors' centres. The picture becomes as large as
/// it can be inside that hull (which is what outside_kind::error accepts), at least `margin_mm` (finite, >=
/// 0) from its edge. Width and height keep their ratio. `l` is the layout of the array:
/// fit_strokes(strokes, layout(a)).
///
/// Where all tactors lie in one line, to a tenth of their pitch, that line is the array: the picture is
/// fitted by its extent along the line, and what goes across is left out. A picture without extent (a timed
/// stroke that rests) is moved to the middle.
///
/// Strokes that say a speed (stroke::speed_mm_s) keep it; the others keep their time, whatever becomes of
/// their length. Starts, intensities and carriers stay. A pure function; any thread. O(n log n) in the
/// points, and O(k h) in k curves and the h corners of the hull.
/// \throws error (bad_input) for a margin that leaves nothing of the array, for a picture with an extent on a
///         single tactor, and for a stroke that only goes across an array in one line.
[[nodiscard]] TACTOR_API fitted_strokes fit_strokes(const std::vector<stroke>& strokes, const layout& l,
                                                    double margin_mm = 0.0);

/// The same for each stroke with a stroke::fit: by itself, or together with the others of its group. The
/// strokes returned have none any more. Throws as above.
[[nodiscard]] TACTOR_API std::vector<stroke> fit_as_asked(std::vector<stroke> strokes, const layout& l);

} // namespace v0
} // namespace tactor
