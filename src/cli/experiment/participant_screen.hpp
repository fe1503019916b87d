// SPDX-License-Identifier: MIT
/// \file
/// What the participant reads on a terminal, in the definition's words. Nothing in it says by which method a
/// motion is rendered.
#pragma once

#include <string>

#include "cli/experiment/prepared.hpp"
#include "cli/play/live_picture.hpp"

namespace tactor::cli {

/// "1 (not at all) to 5 (exactly)": what can be answered in a run.
std::string choices_text(const study::experiment_definition& d, const study::run_definition& r);

/// How many answers there are.
unsigned choices_in(const study::run_definition& r);

/// Prints text for the participant; its lines break at words.
void show_text(std::string_view text);

/// The moving target on a terminal, as long as this lives; elsewhere one line, without motion.
class target_picture {
public:
    target_picture(const array& a, const stroke& target, const study::page_words& words);

    void draw(double t_s);

private:
    const trajectory& motion_;
    layout faces_;
    live_picture picture_;
    instant now_;
};

} // namespace tactor::cli
