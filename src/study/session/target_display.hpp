// SPDX-License-Identifier: MIT
/// \file
/// The terminal on which a participant without a page sees the target.
#pragma once

#include <functional>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "study/experiment/page_words.hpp"

namespace tactor::study {

/// Shows a moving target on a terminal. One thread.
class target_display {
public:
    target_display() = default;
    virtual ~target_display() = default;
    target_display(const target_display&) = delete;
    target_display& operator=(const target_display&) = delete;

    /// Returns whether a target moves there; else a line stands for it.
    virtual bool moves() const = 0;
    /// Shows a target. Returns the function that draws it at a time from its start, s; the picture lasts as
    /// long as that function, and as the three arguments.
    virtual std::function<void(double t_s)> show(const array& a, const stroke& target,
                                                 const page_words& words) = 0;
};

} // namespace tactor::study
