// SPDX-License-Identifier: MIT
/// \file
/// The built-in phantom models, one factory each.
#pragma once

#include <memory>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/faces/face_rules.hpp"

namespace tactor::detail {

std::shared_ptr<const phantom_model> make_inverse_distance(const layout& l);
/// Makes inverse distance for the three tactors closest to the point, instead of those of its face.
std::shared_ptr<const phantom_model> make_nearest_three(const layout& l);
/// `k`: barycentric, linear or log.
std::shared_ptr<const phantom_model> make_on_triangle(phantom_kind k, const layout& l);
std::shared_ptr<const phantom_model> make_gaussian(const layout& l);

/// \throws error (bad_input) for faces_kind::nearest with another model than inverse_distance.
void check_faces(phantom_kind k, faces_kind f);

/// \throws error (bad_input) for an intensity that is not finite, or below 0.
void check_intensity(double a_v);

/// Checks the arguments of every model, and brings p into the hull.
/// \throws error (bad_input) for a point that is not finite, and as check_intensity() does.
point check_request(const layout& l, point p, double a_v);

/// Adds a drive for the tactor of that rank if its amplitude is above 0.
void add_drive(const layout& l, unsigned rank, double amplitude, std::vector<drive>& out);

/// Adds the drives of two tactors for a point between them: Eq. (2) of Park et al. 2016.
void add_two(const layout& l, const rank_pair& two, point p, double a_v, std::vector<drive>& out);
/// Adds the drives of three tactors: Eq. (10).
void add_three(const layout& l, const near_triple& three, double a_v, std::vector<drive>& out);

/// Sorts drives by tactor.
void sort_drives(std::vector<drive>& out);

} // namespace tactor::detail
