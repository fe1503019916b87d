// SPDX-License-Identifier: MIT
/// \file
/// The built-in phantom models, one factory each.
#pragma once

#include <array>
#include <memory>

#include <tactor/phantom.hpp>

namespace tactor::detail {

std::shared_ptr<const phantom_model> make_inverse_distance(const layout& l);
/// Inverse distance for the three tactors closest to the point, instead of those of its face.
std::shared_ptr<const phantom_model> make_nearest_three(const layout& l);
/// `k`: barycentric, linear or log.
std::shared_ptr<const phantom_model> make_on_triangle(phantom_kind k, const layout& l);
std::shared_ptr<const phantom_model> make_gaussian(const layout& l);

/// \throws error (bad_input) where the model has nothing to choose the faces for.
void check_faces(phantom_kind k, faces_kind f);

/// Checks what every model is asked for, and brings p into the hull.
/// \throws error (bad_input) for a point or an intensity that is no finite number, or < 0.
point check_request(const layout& l, point p, double a_v);

/// Adds a drive for the tactor of that rank if its amplitude is above 0.
void add_drive(const layout& l, unsigned rank, double amplitude, std::vector<drive>& out);

/// Eq. (2) of Park et al. 2016: amplitudes of two tactors at these distances from a point between them.
std::array<double, 2> share_of_two(double d1_mm, double d2_mm, double a_v) noexcept;
/// Eq. (10): amplitudes of three tactors at these distances.
std::array<double, 3> share_of_three(const std::array<double, 3>& distances_mm, double a_v) noexcept;

/// Brings drives into the order of tactor.
void sort_drives(std::vector<drive>& out);

} // namespace tactor::detail
