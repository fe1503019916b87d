// SPDX-License-Identifier: MIT
/// \file
/// The lines of one run, with the times that count from its first sample at the DAC.
#pragma once

#include <cstdint>
#include <optional>

#include "study/bids/session_store.hpp"

namespace tactor::study {

class run_table {
public:
    /// Goes on after what is there. `practice`: the lines before the run, which do not count.
    run_table(session_store& store, const run_definition& r, bool practice);

    std::size_t rows() const noexcept { return rows_; }
    /// Settles the onset and writes the line; it is on the disk when this returns. `started_ns` is
    /// CLOCK_REALTIME at the trial's first frame, or when it was to begin. \throws error (runtime).
    void add(trial_row& row, std::int64_t started_ns, unsigned rate);

private:
    session_store& store_;
    const run_definition& run_;
    bool practice_;
    std::size_t rows_ = 0;
    unsigned first_stream_ = 0;
    std::optional<std::uint64_t> first_frame_ = {}; ///< of that stream
    std::optional<std::int64_t> began_ns_ = {};     ///< CLOCK_REALTIME
};

} // namespace tactor::study
