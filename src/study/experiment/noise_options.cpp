// SPDX-License-Identifier: MIT
#include "study/experiment/noise_options.hpp"

#include <utility>

namespace tactor::study {

masking_options noise_of(const masking_definition& m, std::string seed)
{
    return {.color = m.noise == noise_kind::pink ? noise_color::pink : noise_color::white,
            .level_dbfs = m.level_dbfs,
            .fade_s = m.fade_s,
            .seed = std::move(seed)};
}

} // namespace tactor::study
