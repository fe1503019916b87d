// SPDX-License-Identifier: MIT
/// \file
/// Markers to the Lab Streaming Layer, by liblsl, which is loaded when it is asked for.
#pragma once

#include <cstdint>
#include <string>

namespace tactor::study {

/// A stream of numbers, of LSL's type "Markers", up to the end of the process.
class lsl_markers {
public:
    /// Loads $PYLSL_LIB, or liblsl.so.2. \throws error (not_available) if it makes no stream.
    explicit lsl_markers(const std::string& source_id);

    /// Sends a number with a time of CLOCK_REALTIME.
    void push(unsigned number, std::int64_t at_ns) const;

private:
    double (*clock_)() = nullptr;
    int (*push_)(void*, const std::int32_t*, double, std::int32_t) = nullptr;
    void* outlet_ = nullptr;
};

} // namespace tactor::study
