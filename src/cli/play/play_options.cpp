// SPDX-License-Identifier: MIT
#include "cli/play/play_options.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/parse_number.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {
namespace {

unsigned whole(const std::string& option, const std::string& text, detail::bounds b, const std::string& unit)
{
    return static_cast<unsigned>(parse_whole(option, text, b, unit));
}

void add_latency(CLI::App& c, session::stream_options& o)
{
    auto* latency = c.add_option_function<std::string>(
        "--latency-ms",
        [&o](const std::string& t) {
            o.latency_ms = parse_number("--latency-ms", t, detail::option_bounds::latency_ms, "ms");
        },
        "length of the device's buffer: periods x period");
    latency->type_name("MS");
    auto* period = c.add_option_function<std::string>(
        "--period-frames",
        [&o](const std::string& t) {
            o.period_frames = whole("--period-frames", t, {1, 1 << 20}, "frames");
        },
        "instead: frames in a period (default: the configuration's, else 96)");
    period->type_name("N");
    latency->excludes(period);
    c.add_option_function<std::string>(
         "--periods",
         [&o](const std::string& t) {
             o.periods = whole("--periods", t, {2, 1024}, "periods");
         },
         "periods in the buffer (default: the configuration's, else 3)")
        ->type_name("N");
}

void add_lines(CLI::App& c, session::stream_options& o)
{
    c.add_flag("--arm", o.arm, "each stroke waits for an edge on the [sync] in line");
    c.add_option_function<std::string>(
         "--sync-delay-ms",
         [&o](const std::string& t) { o.sync_delay_ms = parse_number("--sync-delay-ms", t, 0, 10000, "ms"); },
         "from the edge to the stroke's first sample at the DAC (default 50)")
        ->type_name("MS");
}

void add_limits(CLI::App& c, session::stream_options& o)
{
    const auto add = [&c](const std::string& name, std::optional<double>& into, double lo, double hi,
                          const std::string& unit, const std::string& help) {
        c.add_option_function<std::string>(
             name,
             [&into, name, lo, hi, unit](const std::string& t) {
                 into = parse_number(name, t, lo, hi, unit);
             },
             help)
            ->type_name(unit == "s" ? "S" : "DB");
    };
    add("--power-dbfs", o.power_dbfs, -120, 60, "dB",
        "greatest power of all tactors together, above one channel's full scale (default 4.77)");
    add("--max-drive-s", o.max_drive_s, 0.1, 3600, "s",
        "longest time that one tactor is driven within the window (default 5)");
    add("--drive-window-s", o.drive_window_s, 0.1, 3600, "s", "the window of --max-drive-s (default 10)");
}

} // namespace

void add_verbose_option(CLI::App& c, session::stream_options& o)
{
    c.add_flag("--verbose", o.verbose,
               "tell on standard error what is agreed on, xruns, mutes, limits that act");
}

void add_log_options(CLI::App& c, session::stream_options& o)
{
    add_verbose_option(c, o);
    c.add_option_function<std::string>(
         "--log",
         [&o](const std::string& t) {
             if (t.empty())
                 throw error(error_kind::bad_input, "--log", "the name is empty", "name a file");
             o.log = t;
         },
         "append the same to a file")
        ->type_name("FILE");
}

void add_stream_options(CLI::App& c, session::stream_options& o)
{
    add_latency(c, o);
    c.add_flag("--require-realtime", o.require_realtime, "fail without real-time priority and locked memory");
    c.add_flag("--no-gpio", o.no_gpio, "leave the lines of [amplifier] and [sync] alone");
    add_limits(c, o);
    add_log_options(c, o);
}

void add_play_options(CLI::App& c, play_options& o)
{
    add_stream_options(c, o);
    c.add_flag("--void-on-xrun", o.void_on_xrun, "an xrun or a lost device in a stroke ends the run");
    c.add_option_function<std::string>(
         "--reopen-s",
         [&o](const std::string& t) {
             o.reopen_s = parse_number("--reopen-s", t, 0, 1e9, "s", "0 s or more");
         },
         "wait so long for a lost device to come back, then go on with the next stroke (default 0)")
        ->type_name("S");
    add_lines(c, o);
    c.add_flag("--live", o.live, "lines \"x y [intensity]\" on standard input move a stroke; STROKE is -");
    c.add_option_function<std::string>(
         "--smooth",
         [&o](const std::string& t) { o.smooth_s = parse_number("--smooth", t, 0, 1, "s", "0 to 1 s"); },
         "with --live: move evenly, and be at each point so long after it came (default 0)")
        ->type_name("S");
    c.add_option("--socket", o.socket, "play through the server that listens there")->type_name("PATH");
    add_format_option(c, o.format, {"text", "json"}, "what is told of the run (default text)");
}

} // namespace tactor::cli
