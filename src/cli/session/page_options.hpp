// SPDX-License-Identifier: MIT
/// \file
/// The options --display and --page, for what the participant sees.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "net/listen.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct page_options {
    std::optional<bool> on_page = {};          ///< a page, or the terminal
    std::optional<net::host_and_port> at = {}; ///< where the page is; a free port where it is not said

    bool shown() const { return on_page.value_or(at.has_value()); }
};

/// `o` must live as long as the command.
void add_page_options(CLI::App& command, page_options& o);

/// --keypad of a command, as often as there are any.
void add_keypad_option(CLI::App& command, std::vector<std::string>& into);

/// Checks that the options go together. \throws error (bad_input).
void check_page_options(const page_options& o, bool simulated);

/// Opens the socket of the participant's page and prints its address; none without a page. \throws error.
net::owned_fd open_page(const page_options& o);

} // namespace tactor::cli
