// SPDX-License-Identifier: MIT
/// \file
/// The participant's terminal.
#pragma once

#include "study/session/person_session.hpp"

namespace tactor::cli {

/// Draws the moving target on standard output where that is a terminal; elsewhere says one line, without
/// motion.
class terminal_display final : public study::target_display {
public:
    bool moves() const override;
    std::function<void(double t_s)> show(const array& a, const stroke& target,
                                         const study::page_words& words) override;
};

} // namespace tactor::cli
