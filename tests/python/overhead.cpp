// SPDX-License-Identifier: MIT
// Makes the samples of park2016-3 on palm-3x3 as a C++ program does: planning and rendering.
#include <cstddef>
#include <cstring>
#include <memory>

#include <tactor/tactor.hpp>

extern "C" void plan_and_render(float* copy)
{
    static const tactor::array palm = tactor::preset_array("palm-3x3");
    static const tactor::stroke stroke = tactor::preset_stroke("park2016-3");
    const tactor::score score(palm, tactor::make_plan(palm, stroke));
    tactor::renderer r(score, tactor::format_kind::float32);
    const std::size_t bytes = score.frames() * score.channels() * sizeof(float);
    const auto samples = std::make_unique_for_overwrite<std::byte[]>(bytes);
    r.process({samples.get(), bytes});
    if (copy != nullptr)
        std::memcpy(copy, samples.get(), bytes);
}
