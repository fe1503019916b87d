// SPDX-License-Identifier: MIT
/// \file
/// Precision of the distributions of Boost.Math.
#pragma once

#include <boost/math/policies/policy.hpp>

namespace tactor::study {

/// Policy that computes in double. By default Boost.Math computes in long double, and does so once before
/// main(), where valgrind, which has no long double, ends the program.
using in_double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

} // namespace tactor::study
