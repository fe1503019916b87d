// SPDX-License-Identifier: MIT
// The commands `devices` and `off`.
#include "cli/devices.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"

namespace tactor::cli {

namespace {

std::string row(const char* name, const std::string& text)
{
    return text.empty() ? "" : wrap_text(fmt::format("    {:<10}", name), text);
}

std::string range_text(const count_range& r, unsigned beyond = no_limit)
{
    if (r.least == r.most)
        return fmt::format("{}", r.least);
    if (r.most >= beyond)
        return r.least <= 1 ? "any" : fmt::format("{} or more", r.least);
    return fmt::format("{} to {}", r.least, r.most);
}

std::string channels_text(const pcm_abilities& a)
{
    std::vector<std::string> counts;
    for (const count_range& r : a.channels)
        counts.push_back(range_text(r, max_pcm_channels));
    return fmt::format("{}", fmt::join(counts, ", "));
}

std::string rates_text(const pcm_abilities& a)
{
    if (a.rates_hz.most == no_limit)
        return "any";
    const bool few =
        a.usual_rates_hz.empty() || (a.usual_rates_hz.size() == 1 && a.rates_hz.least != a.rates_hz.most);
    return few ? range_text(a.rates_hz) + " Hz" : fmt::format("{} Hz", fmt::join(a.usual_rates_hz, " "));
}

std::string formats_text(const pcm_abilities& a)
{
    std::vector<std::string> names;
    for (const format_kind f : a.formats)
        names.emplace_back(to_string(f));
    return names.empty() ? "none that tactor plays" : fmt::format("{}", fmt::join(names, " "));
}

std::string sizes_text(const pcm_abilities& a)
{
    if (a.period_frames.most == no_limit && a.buffer_frames.most == no_limit)
        return "any";
    const auto with_noun = [](const std::string& n, const char* noun) {
        return fmt::format("{} {}{}", n, noun, n == "1" ? "" : "s");
    };
    return fmt::format("{}, {}, buffer {}", with_noun(range_text(a.period_frames), "frame"),
                       with_noun(range_text(a.periods), "period"), range_text(a.buffer_frames));
}

std::string pcm_text(const pcm_info& p, const session::device_list& d)
{
    std::string s =
        fmt::format("\n  {}{}\n", p.name, p.wanted && d.pcm_is_configured ? "   <- the configured one" : "");
    if (!p.description.empty())
        s += wrap_text("    ", p.description);
    s += row("preset", p.preset.empty() ? "" : fmt::format("{} (--array {})", p.preset, p.preset));
    s += row("held by", process_names(p.holders));
    if (!p.can)
        return s + row("cannot", p.error);
    s += p.misfit.empty() ? row("fits", make_printable(d.array_name)) : row("unfit", p.misfit);
    s += row("channels", channels_text(*p.can));
    s += row("rates", rates_text(*p.can));
    s += row("formats", formats_text(*p.can));
    return s + row("period", sizes_text(*p.can));
}

std::string pcms_text(const session::device_list& d)
{
    const auto is_card = [](const pcm_info& p) { return p.hardware; };
    std::string s = "Sound cards\n";
    if (std::none_of(d.pcms.begin(), d.pcms.end(), is_card))
        s += wrap_text("  none; ", "plug in the card, or load its driver or overlay; give /dev/snd to a "
                                   "container. The PCM null needs no card.");
    for (const pcm_info& p : d.pcms)
        if (p.hardware)
            s += pcm_text(p, d);
    s += "\nOther PCMs\n";
    std::string untried;
    for (const pcm_info& p : d.pcms)
        if (!p.tried)
            untried += (untried.empty() ? "" : " ") + p.name;
        else if (!p.hardware)
            s += pcm_text(p, d);
    if (!untried.empty())
        s += fmt::format(
            "\n{}{}",
            wrap_text(
                "  ",
                "Not tried, because opening them may start a card or a sound server (-D NAME tries one):"),
            wrap_text("    ", untried));
    return s;
}

std::string line_text(const std::string& offset, const gpio_line_info& l, std::size_t width)
{
    return fmt::format("    {:>7}  {:<{}}  {:<6}  {}\n", offset, l.name.empty() ? "-" : l.name, width,
                       l.output ? "output" : "input",
                       l.consumer.empty() ? "free" : fmt::format("held by {}", l.consumer));
}

// Returns a table of GPIO lines. Consecutive lines that differ only in their number share a row.
std::string lines_text(const std::vector<gpio_line_info>& lines)
{
    std::size_t width = 4;
    for (const gpio_line_info& l : lines)
        width = std::max(width, l.name.size());
    std::string s;
    for (std::size_t i = 0; i < lines.size();) {
        std::size_t end = i + 1;
        while (end < lines.size() && lines[i].name.empty() && lines[end].name.empty() &&
               lines[end].output == lines[i].output && lines[end].consumer == lines[i].consumer)
            ++end;
        const unsigned last = lines[end - 1].offset;
        s += line_text(end - i == 1 ? fmt::format("{}", last) : fmt::format("{}-{}", lines[i].offset, last),
                       lines[i], width);
        i = end;
    }
    return s;
}

std::string chips_text(const std::vector<gpio_chip_info>& chips)
{
    std::string s = "\nGPIO chips\n";
    if (chips.empty())
        s += wrap_text("  none; ",
                       "they are /dev/gpiochip*: load the chip's driver; give them to a container. "
                       "Only [amplifier] and [sync] need one.");
    for (const gpio_chip_info& c : chips) {
        if (!c.error.empty()) {
            s += fmt::format("\n{}", wrap_text("  ", c.error));
            continue;
        }
        s += fmt::format("\n  {}   {}, {}\n", c.label, c.path, counted(c.lines.size(), "line"));
        s += lines_text(c.lines);
    }
    return s;
}

// The command `off`. It is for the case that neither the player nor the holder process can switch the
// amplifier off any more.

using namespace std::chrono_literals;

// When a player has just been killed, its holder process keeps the line for 0.2 s, or for up to a second
// without real-time priority.
constexpr auto longest_wait = 2s;

gpio_line_place await_free_line(const gpio_line_name& line)
{
    const auto until = std::chrono::steady_clock::now() + longest_wait;
    gpio_line_place p = find_gpio_line(line);
    while (!p.line.consumer.empty() && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(10ms);
        p = find_gpio_line(line);
    }
    return p;
}

// Returns the names of the files that may contain [amplifier].
std::string searched_files_text(const environment& e)
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
        throw error(error_kind::bad_input, "amplifier",
                    fmt::format("no [amplifier] in {}", searched_files_text(e)),
                    "use --array or --config with a file that has [amplifier], see tactor.toml(5)");
    const amplifier_settings& a = *e.config.amplifier;
    const gpio_line_place p = await_free_line(a.line);
    // Opening the line already switches it off. set() requests this again, and returns false if the driver
    // refuses.
    if (!open_output(a.line, a.active_low)->set(false))
        throw error(
            error_kind::not_available, "amplifier",
            fmt::format("line {} of {} cannot be switched off, so it may be on", p.line.offset, p.label),
            "cut the amplifier's supply, then look for the cause in dmesg");
    fmt::print("amplifier: line {} of {} ({}) is off\n", p.line.offset, p.label, p.path);
}

} // namespace

std::string process_names(const std::vector<process_info>& all)
{
    std::vector<std::string> names;
    for (const process_info& p : all)
        names.push_back(fmt::format("{} (process {})", p.program.empty() ? "a program" : p.program, p.pid));
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string devices_text(const session::device_list& d)
{
    return fmt::format("{} needs {} at {} Hz.\n\n", make_printable(d.array_name),
                       counted(d.wanted.channels, "channel"), d.wanted.rate) +
           pcms_text(d) + chips_text(d.chips);
}

int run_devices(command_line& line)
{
    std::string format;
    settings& s = add_options(line, options::on_devices);
    add_format_option(line.app, format, {"text", "json"}, "format of the output (default text)");
    line.app.footer("tactor devices\n"
                    "tactor devices --array palm-2x4\n"
                    "tactor devices --format json");
    line.parse();
    const session::device_list d = session::examine_devices(s, session::read_environment(s));
    if (format == "json")
        fmt::print("{}", session::devices_json(d));
    else
        say_text(stdout, devices_text(d));
    return status_ok;
}

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
