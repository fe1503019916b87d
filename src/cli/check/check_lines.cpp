// SPDX-License-Identifier: MIT
#include "cli/check/check_lines.hpp"

#include <fmt/format.h>

namespace tactor::cli {
namespace {

std::string line_words(const gpio_line_place& p)
{
    return fmt::format("line {}{} of {} ({})", p.line.offset,
                       p.line.name.empty() ? "" : fmt::format(" \"{}\"", p.line.name), p.label, p.path);
}

finding check_line(const char* check, const gpio_line_name& name, const line_finder& find)
{
    try {
        const gpio_line_place p = find(name);
        if (p.line.consumer.empty())
            return fine(check, line_words(p) + ", free");
        const bool own = p.line.consumer == "tactor";
        return {check, level::error, fmt::format("{}: held by \"{}\"", line_words(p), p.line.consumer),
                own ? "another tactor runs: stop it" : "stop that program, or choose another line",
                error_kind::not_available};
    } catch (const error& e) {
        return failure(check, e);
    }
}

} // namespace

std::vector<finding> check_lines(const setup& config, bool felt, const line_finder& find)
{
    std::vector<finding> all;
    if (!config.amplifier)
        all.push_back({"amplifier", felt ? level::warning : level::ok,
                       "no [amplifier]: nothing switches it off",
                       "wire its enable input to a GPIO line, see tactor-raspberry-pi(7)"});
    else {
        finding f = check_line("amplifier", config.amplifier->line, find);
        if (f.how == level::ok && config.amplifier->active_low)
            f = warning("amplifier", f.found + ", on when low: a line that floats may switch it on",
                        "use an amplifier that is on when high, with a pull-down resistor");
        all.push_back(std::move(f));
    }
    if (config.sync && config.sync->out)
        all.push_back(check_line("sync out", *config.sync->out, find));
    if (config.sync && config.sync->in)
        all.push_back(check_line("sync in", *config.sync->in, find));
    return all;
}

} // namespace tactor::cli
