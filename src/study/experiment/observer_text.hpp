// SPDX-License-Identifier: MIT
/// \file
/// Texts that describe a simulated observer, such as "seed=1,sigma=1" for an experiment, or
/// "seed=1,threshold=-45,-50,spread=2" for a calibration.
#pragma once

#include <functional>
#include <span>
#include <string_view>

namespace tactor::study {

/// A key of an observer's text.
struct observer_key {
    std::string_view name;
    double low;  ///< least value
    double high; ///< greatest value
    std::function<void(double)> set;
    bool is_whole = false; ///< true if only digits are allowed
    bool is_list = false;  ///< true if more values may follow the first
};

/// Reads a text, and calls `set` for each value in it. `example`: a correct text, which the hint of an error
/// shows. \throws error (bad_input) with the name --simulate if a key is unknown or occurs twice, or if a
/// value is out of range.
void read_observer(std::string_view text, std::span<const observer_key> keys, std::string_view example);

} // namespace tactor::study
