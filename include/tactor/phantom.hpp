// SPDX-License-Identifier: MIT
/// \file
/// Phantom tactors: which tactors play, and how strongly, so that one feels a point between them.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/geometry.hpp>

namespace tactor {

/// One tactor's part in a phantom: linear amplitude, where 1 is the intensity asked for.
struct drive {
    unsigned tactor = 0;
    double amplitude = 0.0;

    friend bool operator==(const drive&, const drive&) = default;
};

/// Delaunay faces of an array (rendering model, section 4). Tactors on one circumcircle form one
/// face. Immutable; copies and moves share it (what is moved from stays what it was); any thread may call.
class TACTOR_API layout {
public:
    /// O(n log n). \throws error (bad_input) as validate() does, and where two tactors are too near to each
    /// other for faces between places that are so far apart (nearer than some 1e-9 of the array's extent).
    explicit layout(const array& a);
    layout(const layout&) noexcept = default;
    layout& operator=(const layout&) noexcept = default;

    /// Tactor places by index.
    const std::vector<point>& places() const noexcept;

    /// Faces as tactor indices in order round the face; none where all tactors are in one line.
    const std::vector<std::vector<unsigned>>& faces() const noexcept;

    /// Whether p is in the hull, its edge included (within same_place_mm).
    bool contains(point p) const;
    /// The point of the hull nearest to p.
    point nearest(point p) const;

    /// Median distance from a tactor to its nearest neighbour, mm; 0 for a single tactor.
    double pitch_mm() const noexcept;

    struct impl;
    const impl& data() const noexcept; ///< for the models inside the library

private:
    std::shared_ptr<const impl> impl_;
};

/// A rule that gives the tactors of a point. Derive from it for a model of your own.
class TACTOR_API phantom_model {
public:
    virtual ~phantom_model();
    /// Name for plans and logs.
    virtual std::string_view name() const noexcept = 0;
    /// Replaces `out` by the drives for a phantom of intensity `a_v` at p, in order of tactor, each amplitude
    /// finite and > 0. p is inside the hull. Called where plans and scores are made; for `continuous` also
    /// while it is rendered and, in the player's control thread, played: what fails then ends the stroke.
    virtual void weights(point p, double a_v, std::vector<drive>& out) const = 0;
};

/// Built-in models.
enum class phantom_kind {
    inverse_distance, ///< Park et al. 2016, Eqs. (2) and (10)
    barycentric,      ///< sqrt of barycentric coordinates: equal energy, continuous, no centroid error
    linear,           ///< barycentric coordinates as amplitudes
    log,              ///< log2(1 + b)
    gaussian,         ///< all tactors near, exp(-d^2 / (2 (0.6 pitch)^2)), equal energy
};

TACTOR_API std::string_view to_string(phantom_kind k) noexcept;
/// \throws error (bad_input) that lists the names.
TACTOR_API phantom_kind phantom_from_string(std::string_view name);

/// A built-in model on a layout. O(log n) in the tactors for each point, and O(k log k) in those of the
/// face, which matters only where hundreds lie on one circle. A point outside the hull is taken for the
/// nearest point of it. \throws error (bad_input), from weights(), for what is not finite or below 0.
TACTOR_API std::shared_ptr<const phantom_model> make_phantom(phantom_kind k, const layout& l);

} // namespace tactor
