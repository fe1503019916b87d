// SPDX-License-Identifier: MIT
/// \file
/// Numbers of the events of a study: [sync.codes] of tactor.toml(5).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/setup.hpp>

#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"

namespace tactor::study {

enum class code_event { stimulus, standard, silent, answer, made_void };

/// Number of code_event's values.
inline constexpr std::size_t code_events = 5;

/// Returns the event's name, as in [sync.codes].
std::string_view to_string(code_event e) noexcept;

/// Returns the event that a stimulus by a method is.
code_event find_event(const method_definition& m) noexcept;

/// An event, as far as numbers tell it from others.
struct coded_event {
    code_event event = code_event::stimulus;
    const run_definition* run = nullptr;
    std::size_t motion = 0;         ///< place in the definition
    std::size_t method = 0;         ///< the same, of the stimulus; of an answer or void trial the first one
    unsigned interval = 1;          ///< of a stimulus
    std::string_view response = {}; ///< of an answer, as in the table
};

/// The numbers of all events of a definition. Events that no part of `by` tells apart have one number.
class code_numbers {
public:
    code_numbers() = default;
    /// Gives numbers to the events of all groups, in the order of the definition.
    /// \throws error (bad_input) at the place of [sync] code for more than 255, or than the lines can show.
    code_numbers(const code_settings& c, const experiment_definition& whole);

    /// Returns the number of an event. `d` may be that of a group.
    unsigned number(const experiment_definition& d, const coded_event& e) const;
    /// Lists the meanings of each number, with its event first.
    const std::map<unsigned, std::vector<std::string>>& meanings() const noexcept { return meanings_; }

private:
    std::string describe(const experiment_definition& d, const coded_event& e) const;

    std::vector<std::vector<std::string>> by_ = {}; ///< by event
    std::map<std::string, unsigned> numbers_ = {};  ///< by description
    std::map<unsigned, std::vector<std::string>> meanings_ = {};
};

} // namespace tactor::study
