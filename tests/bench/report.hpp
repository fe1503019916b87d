// SPDX-License-Identifier: MIT
/// \file
/// A table from one run. Times are the best of the repetitions, which come in random order: other work on the
/// machine makes a time longer, never shorter.
#pragma once

#include <string>
#include <vector>

#include <tactor/choices.hpp>

namespace bench {

std::string benchmark_name(const std::string& what, std::size_t bytes);

/// A line of the table of synthesis.
struct synth_row {
    unsigned channels = 0;
    unsigned strokes = 0; ///< 0: silence
    bool continuous = false;
    tactor::format_kind format = tactor::format_kind::float32;

    std::string name() const;
    std::string plain_name() const;
};

/// Prints the lines, in order.
std::vector<synth_row>& table();

/// Registers the benchmarks of synthesis.
void add_synth();

} // namespace bench
