// SPDX-License-Identifier: MIT
/// \file
/// Numbers that mark the events of a study, see [sync.codes] in tactor.toml(5).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/setup.hpp>

#include "study/data/definition.hpp"
#include "study/experiment/trials.hpp"

namespace tactor::study {

enum class code_event { stimulus, standard, silent, answer, made_void };

/// Number of values of code_event.
inline constexpr std::size_t code_events = 5;

/// Returns the event's name, as in [sync.codes].
std::string_view to_string(code_event e) noexcept;

/// Returns the event that marks a stimulus of this method.
code_event find_event(const method_definition& m) noexcept;

/// An event, with everything that may determine its number.
struct coded_event {
    code_event event = code_event::stimulus;
    const run_definition* run = nullptr;
    std::size_t motion = 0; ///< index in the definition
    std::size_t method = 0; ///< index of the stimulus's method; for other events, of the trial's first method
    unsigned interval = 1;  ///< place of the stimulus in its trial, from 1
    std::string_view response = {}; ///< response as in the run's table; empty for other events than answers
};

/// Numbers of all events of a definition. Two events share a number if they agree in all parts that `by` of
/// [sync.codes] lists.
class code_numbers {
public:
    code_numbers() = default;
    /// Numbers the events of all groups, in the order of the definition. \throws error (bad_input) at the
    /// place of [sync] code if a number exceeds 255 or the greatest number that the lines can show.
    code_numbers(const code_settings& c, const experiment_definition& whole);

    /// Returns the number of an event. `d`: the definition, or its part for one group.
    unsigned find_number(const experiment_definition& d, const coded_event& e) const;
    /// Lists the meanings of each number. Each meaning begins with the event's name.
    const std::map<unsigned, std::vector<std::string>>& meanings() const noexcept { return meanings_; }

private:
    std::string describe(const experiment_definition& d, const coded_event& e) const;

    std::vector<std::vector<std::string>> by_ = {}; ///< parts that determine the number, for each code_event
    std::map<std::string, unsigned> numbers_ = {};  ///< number of each description
    std::map<unsigned, std::vector<std::string>> meanings_ = {};
};

} // namespace tactor::study
