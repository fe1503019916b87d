// SPDX-License-Identifier: MIT
/// \file
/// The GPIO lines of a run, which outlive each of its players.
#pragma once

#include <memory>

#include <tactor/tactor.hpp>

namespace tactor::session {

/// Opens what [amplifier] and [sync] name. Make it before threads and locked memory: it forks the holder of
/// the amplifier's line. A player that plays on after its device was lost is a new one; the lines stay.
class lent_lines {
public:
    lent_lines() = default;
    /// \throws error as open_amplifier() does. `arm`: whether the trigger is wanted.
    lent_lines(const setup& config, bool arm, double trigger_delay_s);

    /// Lends the lines to one player at a time. `proof_s`: as player_lines.
    player_lines lend(double proof_s = 0.0) const;

private:
    std::shared_ptr<enable_line> amplifier_;
    std::shared_ptr<enable_line> sync_out_;
    std::shared_ptr<edge_input> trigger_;
    double settle_s_ = 0.0;
    double pulse_s_ = 0.0;
    double trigger_delay_s_ = 0.0;
};

} // namespace tactor::session
