// SPDX-License-Identifier: MIT
/// \file
/// A session with a person: what is refused before anybody sits down, the devices around it, and whether the
/// masking noise hides the array.
#pragma once

#include <memory>

#include "cli/experiment/experiment_options.hpp"
#include "cli/settings.hpp"
#include "net/listen.hpp"
#include "study/bids/session_store.hpp"
#include "study/session/person_session.hpp"
#include "study/session/prepared.hpp"
#include "study/session/stage.hpp"

namespace tactor::cli {

/// Refuses what would spoil the data: no device, a sound server in between without --allow-sound-server,
/// noise without a device for it or the other way round, more answers than keys. Warns of a device that plays
/// to nothing. Returns the sound servers in between. \throws error (bad_input).
study::sound_servers check_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                        const settings& s);

/// The array's device, and the noise's where one is named. \throws error.
std::unique_ptr<study::stage> open_stage(const study::prepared_experiment& p, const experiment_options& o,
                                         const settings& s);

/// Runs the trials that are left, with a person at the terminal or, where `listening` is a socket, at a page.
/// Returns why the session ended. \throws error.
study::stage::left hold_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                     const settings& s, const study::sound_servers& between,
                                     net::owned_fd listening, study::session_store& store);

/// --check-noise: the definition's noise, and its stimuli under it, by keys. Returns the exit status. \throws
/// error.
int check_noise(const study::prepared_experiment& p, const experiment_options& o, const settings& s);

/// Draws the moving target on standard output where that is a terminal; elsewhere says one line, without
/// motion.
class terminal_display final : public study::target_display {
public:
    bool moves() const override;
    std::function<void(double t_s)> show(const array& a, const stroke& target,
                                         const study::page_words& words) override;
};

} // namespace tactor::cli
