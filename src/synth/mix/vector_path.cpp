// SPDX-License-Identifier: MIT
#include "synth/mix/vector_path.hpp"

#include "core/clones.hpp"

namespace tactor::synth {
namespace {

// Its own clones say which one the loader took for all the others.
#ifdef TACTOR_HAS_CLONES
__attribute__((target("arch=x86-64-v4"))) const char* taken()
{
    return "avx-512";
}

__attribute__((target("avx2"))) const char* taken()
{
    return "avx2";
}

__attribute__((target("default"))) const char* taken()
{
    return "baseline";
}
#else
const char* taken()
{
    return "baseline";
}
#endif

} // namespace

const char* vector_path() noexcept
{
    return taken();
}

} // namespace tactor::synth
