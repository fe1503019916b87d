// SPDX-License-Identifier: MIT
#include "study/session/lsl_markers.hpp"

#include <dlfcn.h>

#include <tactor/error.hpp>

#include "rt/clock.hpp"
#include "rt/system_files.hpp"

namespace tactor::study {

lsl_markers::lsl_markers(const std::string& source_id)
{
    const std::string named = rt::variable("PYLSL_LIB");
    const std::string file = named.empty() ? "liblsl.so.2" : named;
    void* const library = ::dlopen(file.c_str(), RTLD_NOW);
    const auto find = [&]<class F>(F*& function, const char* name) {
        function = library != nullptr ? reinterpret_cast<F*>(::dlsym(library, name)) : nullptr;
        return function != nullptr;
    };
    void* (*make_info)(const char*, const char*, std::int32_t, double, int, const char*) = nullptr;
    void* (*make_outlet)(void*, std::int32_t, std::int32_t) = nullptr;
    const bool found = find(clock_, "lsl_local_clock") && find(push_, "lsl_push_sample_itp") &&
                       find(make_info, "lsl_create_streaminfo") && find(make_outlet, "lsl_create_outlet");
    const char* const cause = found ? nullptr : ::dlerror();
    constexpr int int32 = 4;        // cft_int32
    constexpr int buffered_s = 360; // as usual
    if (found)
        outlet_ =
            make_outlet(make_info("tactor", "Markers", 1, 0.0, int32, source_id.c_str()), 0, buffered_s);
    if (outlet_ == nullptr)
        throw error(
            error_kind::not_available, "[sync] code lsl",
            cause != nullptr ? cause : file + " makes no stream",
            "install liblsl from the Lab Streaming Layer's releases, or leave out lsl in [sync] code");
}

void lsl_markers::push(unsigned number, std::int64_t at_ns) const
{
    const auto sample = static_cast<std::int32_t>(number);
    const double ago_s = static_cast<double>(rt::unix_ns() - at_ns) * 1e-9;
    push_(outlet_, &sample, clock_() - ago_s, 1);
}

} // namespace tactor::study
