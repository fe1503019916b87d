// SPDX-License-Identifier: MIT
/// \file
/// What `check` finds.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/error.hpp>

#include "cli/option_words.hpp"

namespace tactor::cli {

enum class level { ok, warning, error };

struct finding {
    std::string check; ///< what was looked at
    level how = level::ok;
    std::string found;
    std::string cure = {};                 ///< what to do; empty: nothing
    error_kind kind = error_kind::runtime; ///< of an error, for the exit status
};

inline finding fine(std::string check, std::string found, std::string cure = {})
{
    return {std::move(check), level::ok, std::move(found), std::move(cure)};
}

inline finding warning(std::string check, std::string found, std::string cure)
{
    return {std::move(check), level::warning, std::move(found), std::move(cure)};
}

inline finding failure(std::string check, const error& of_library)
{
    const error e = in_options(of_library);
    std::string why =
        e.subject() == check ? std::string(e.why()) : std::string(e.subject()) + ": " + std::string(e.why());
    return {std::move(check), level::error, std::move(why), std::string(e.hint()), e.kind()};
}

std::string_view to_string(level l);

/// A line or two for each, at most 80 columns wide.
std::string findings_text(const std::vector<finding>& all);

/// The exit status: that of bad input before that of a device before any other; 0 without an error.
int status_of(const std::vector<finding>& all);

} // namespace tactor::cli
