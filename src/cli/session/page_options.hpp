// SPDX-License-Identifier: MIT
/// \file
/// Options that all sessions with a participant have: --display and --page, --keypad, --masker.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "net/listen.hpp"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tactor::cli {

struct page_options {
    std::optional<bool> on_page = {};          ///< true for a page, false for the terminal
    std::optional<net::host_and_port> at = {}; ///< address of the page; not set for a free port

    bool is_shown() const { return on_page.value_or(at.has_value()); }
};

/// Adds --display and --page. `o` must outlive the command.
void add_page_options(CLI::App& command, page_options& o);

/// Adds --keypad, which may occur several times.
void add_keypad_option(CLI::App& command, std::vector<std::string>& into);

/// Adds --masker, the device for the masking noise. Returns the option.
CLI::Option* add_masker_option(CLI::App& command, std::string& into, const std::string& help);

/// Checks that the options do not exclude each other. \throws error (bad_input).
void check_page_options(const page_options& o, bool simulated);

/// Opens the socket of the participant's page and prints its address. Returns no socket if the participant
/// uses the terminal. \throws error.
net::owned_fd open_page(const page_options& o);

} // namespace tactor::cli
