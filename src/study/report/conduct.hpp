// SPDX-License-Identifier: MIT
/// \file
/// Describes the course of a session from the records that session.json kept while it went on. Empty: not
/// recorded.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/report/facts.hpp"

namespace tactor::study {

/// Returns whether and where the target of a run was shown before the first stimulus.
std::string animation_text(const session_facts& s, std::size_t run);

/// Returns the masking noise that was played, with its device.
std::string masking_text(const session_facts& s);

/// Returns what the participant saw: a page or a terminal.
std::string display_text(const session_facts& s);

/// Returns when the participant agreed to the consent text.
std::string consent_text(const session_facts& s);

/// Returns which tactors were confirmed as felt before the runs, and when.
std::string walk_text(const session_facts& s);

/// Returns the days on which the session was held, UTC, in order and each once.
std::vector<std::string> session_days(const session_facts& s);

} // namespace tactor::study
