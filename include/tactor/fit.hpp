// SPDX-License-Identifier: MIT
/// \file
/// Strokes that were drawn elsewhere, on an array.
#pragma once

#include <optional>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/geometry.hpp>
#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>

namespace tactor {
inline namespace v0 {

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

/// The same for each stroke with a stroke::fit_margin_mm: by itself, or together with the others of its
/// stroke::fit_group. The strokes returned have neither any more. Throws as above.
[[nodiscard]] TACTOR_API std::vector<stroke> fit_as_asked(std::vector<stroke> strokes, const layout& l);

} // namespace v0
} // namespace tactor
