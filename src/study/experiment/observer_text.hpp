// SPDX-License-Identifier: MIT
/// \file
/// Texts that describe a simulated observer: "seed=1,sigma=1" of an experiment, and
/// "seed=1,threshold=-45,-50,spread=2" of a calibration.
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
    bool is_list = false;  ///< further values may follow it, without the key
};

/// Reads a text, and calls `set` for each value in it. `example`: a text for the hint. \throws error
/// (bad_input) naming --simulate, for a key that is unknown or occurs twice, and for a value that is out of
/// range.
void read_observer(std::string_view text, std::span<const observer_key> keys, std::string_view example);

} // namespace tactor::study
