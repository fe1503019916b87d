// SPDX-License-Identifier: MIT
/// \file
/// Phantom tactors: which tactors play, and how strongly, so that one feels a point between them.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/geometry.hpp>
#include <tactor/kinds.hpp>

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

} // namespace v0
} // namespace tactor
