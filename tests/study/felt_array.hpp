// SPDX-License-Identifier: MIT
// An array whose tactors are all felt from one level on.
#pragma once

#include <tactor/array.hpp>

namespace tactor::study {

inline array felt_array()
{
    array a = preset_array("palm-3x3");
    for (tactor_spec& t : a.tactors)
        t.threshold_dbfs = -40.0;
    return a;
}

} // namespace tactor::study
