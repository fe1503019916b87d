// SPDX-License-Identifier: MIT
#include <tactor/version.hpp>

#include <fmt/format.h>

#include "build_facts_config.hpp"
#include "synth/mix/converter.hpp"

namespace tactor {
inline namespace v0 {

std::string build_facts()
{
    return fmt::format("build      {}\n"
                       "compiler   {}\n"
                       "processor  {}, {} loops\n"
                       "libraries  {}",
                       TACTOR_BUILD_TYPE, TACTOR_COMPILER, TACTOR_PROCESSOR, synth::vector_loop_version(),
                       TACTOR_LIBRARIES);
}

} // namespace v0
} // namespace tactor
