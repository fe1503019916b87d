// SPDX-License-Identifier: MIT
// Switches the amplifier off where no player and no holder is left to do it.
#include <chrono>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/input.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {
namespace {

using namespace std::chrono_literals;

// The holder of a player that was just killed has the line for 0.2 s more, at most a second where it may not
// run in real time.
constexpr auto longest_wait = 2s;

gpio_line_place wait_until_free(const gpio_line_name& line)
{
    const auto until = std::chrono::steady_clock::now() + longest_wait;
    gpio_line_place p = find_gpio_line(line);
    while (!p.line.consumer.empty() && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(10ms);
        p = find_gpio_line(line);
    }
    return p;
}

// The files that could have said it.
std::string searched(const environment& e)
{
    const bool own_file = !e.array_file.empty() && e.array_file != e.config_name;
    if (e.config_name.empty())
        return fmt::format("{}, and there is no configuration", own_file ? e.array_file : "the array");
    return own_file ? fmt::format("{} or {}", e.array_file, e.config_name) : e.config_name;
}

void switch_off(settings& s)
{
    const environment e = session::read_environment(s);
    if (!e.config.amplifier)
        throw error(error_kind::bad_input, "amplifier", fmt::format("no [amplifier] in {}", searched(e)),
                    "say its line there, see tactor.toml(5), or name the file that does with --array");
    const amplifier_settings& a = *e.config.amplifier;
    const gpio_line_place p = wait_until_free(a.line);
    // Requested as off, so it goes there at once; asked once more for what the driver says.
    if (!open_output(a.line, a.active_low)->set(false))
        throw error(error_kind::not_available, "amplifier",
                    fmt::format("line {} of {} cannot be switched off: it may be on", p.line.offset, p.label),
                    "cut the amplifier's supply; then see what dmesg says");
    fmt::print("amplifier: line {} of {} ({}) is off\n", p.line.offset, p.label, p.path);
}

} // namespace

int run_off(command_line& line)
{
    settings& s = add_options(line, options::on_off);
    line.app.footer("tactor off --config tactor.toml\n"
                    "tactor off --array palm.toml");
    line.parse();
    switch_off(s);
    return status_ok;
}

} // namespace tactor::cli
