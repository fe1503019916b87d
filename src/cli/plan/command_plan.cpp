// SPDX-License-Identifier: MIT
#include <cerrno>
#include <cstdio>
#include <span>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "files/plan/plan_json.hpp"
#include "plot/figure.hpp"
#include "session/environment.hpp"

namespace tactor::cli {

namespace {

// Returns a line on what --fit did to places; several strokes share it.
std::string fit_note(const fitting& f)
{
    return fmt::format(
        "fitted: ({:.6g}, {:.6g}) mm as drawn is ({:.6g}, {:.6g}) mm here, lengths times {:.6g}{}\n",
        f.from.x_mm, f.from.y_mm, f.to.x_mm, f.to.y_mm, f.scale,
        f.line ? ", onto the line of the array" : "");
}

std::string level_text(const render_options& sound, const stroke& s)
{
    std::string text = sound.sl_db ? fmt::format("{} dB SL", plain_number(*sound.sl_db))
                                   : fmt::format("{} dBFS", plain_number(sound.level_dbfs));
    if (s.choices.level_db != 0.0)
        text += fmt::format(" and {} dB of its own", plain_number(s.choices.level_db));
    return text;
}

std::string heading(const std::string& title, const stroke& s, const plan& p, double start_s, const array& a,
                    const render_options& sound)
{
    const std::string soa = p.soa_s ? ", SOA " + seconds_text(*p.soa_s) : "";
    const std::string bursts = p.curve ? "continuous" : counted(p.bursts.size(), "burst");
    return fmt::format(
        "{} on {}: {} with {}, {}{}\nstarts at {}, {} mm in {}, {} of sound\n"
        "vibration: {}{}, level {}\n",
        title, a.name, p.algorithm, plot::describe_phantom(p), bursts, soa, seconds_text(start_s, 9),
        plain_number(p.stroke_length_mm), seconds_text(p.stroke_duration_s), seconds_text(p.total_s),
        p.wave.kind == waveform_kind::sine ? "sine of " : "", plot::describe_sound(p), level_text(sound, s));
}

void print_one(std::FILE* out, const std::string& title, const stroke& s, const plan& p, double start_s,
               const array& a, const render_options& sound)
{
    say(out, "{}", heading(title, s, p, start_s, a, sound));
    if (s.note != note_kind::none)
        say(out, "note: {}\n", files::note_text(s.note));
    say(out, "\n{:>10} {:>10} {:>9} {:>9}  {}\n", p.curve ? "t_s" : "onset_s", "duration_s", "x_mm", "y_mm",
        "tactor:amplitude");
    files::for_each_row(p, [&](const burst& b) {
        std::string drives;
        for (const drive& d : b.drives)
            drives += fmt::format(" {}:{:.4f}", d.tactor, d.amplitude);
        fmt::print(out, "{}",
                   fit_lines(out, fmt::format("{:10.6f} {:10.6f} {:9.3f} {:9.3f} {}\n", b.onset_s,
                                              b.duration_s, b.position.x_mm, b.position.y_mm, drives)));
    });
    for (const conflict& c : p.conflicts)
        say(out, "conflict: tactor {} serves two bursts from {:.6f} s to {:.6f} s\n", c.tactor, c.from_s,
            c.to_s);
    for (const meeting& m : p.dropped)
        say(out, "dropped: the crossing at ({:.3f}, {:.3f}) mm, {:.6f} s\n", m.position.x_mm, m.position.y_mm,
            m.t_s);
    for (const std::string& w : p.warnings)
        say(out, "warning: {}\n", w);
}

// Both write as they go: a plan of an hour needs no document in memory.
void print_text(std::FILE* out, const piece& p, const environment& e, const render_options& sound)
{
    const auto starts = start_times_s(p.plans);
    if (p.fit)
        say(out, "{}", fit_note(*p.fit));
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        if (i != 0)
            fmt::print(out, "\n");
        print_one(out, name_stroke(p, i), p.strokes[i], p.plans[i].plan, starts[i], e.tactors, sound);
    }
}

void print_csv(std::FILE* out, const piece& p, const environment& e)
{
    fmt::print(out, "stroke,start_s,onset_s,duration_s,tau_s,x_mm,y_mm,tactor,channel,amplitude\n");
    const auto starts = start_times_s(p.plans);
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        files::for_each_row(p.plans[i].plan, [&](const burst& b) {
            const std::string tau = b.tau_s ? fmt::format("{}", *b.tau_s) : "";
            for (const drive& d : b.drives)
                fmt::print(out, "{},{},{},{},{},{},{},{},{},{}\n", i, starts[i], b.onset_s, b.duration_s, tau,
                           b.position.x_mm, b.position.y_mm, d.tactor, e.tactors.tactors[d.tactor].channel,
                           d.amplitude);
        });
    }
}

void print_plan(settings& s, const std::string& format)
{
    const environment e = session::read_environment(s);
    const piece p = plan_one_piece(s, e);
    const render_options sound = session::settle_render(s, e);
    const score samples = make_score(p, e, sound); // levels and carrier are checked when planned
    session::tell_of_other_carrier(e, sound, std::span(&samples, 1));
    if (format == "json")
        files::write_plans({p, e.tactors, samples, sound}, [](std::string_view part) {
            // A plan of an hour ends where its reader does.
            if (std::fwrite(part.data(), 1, part.size(), stdout) != part.size())
                throw std::system_error(errno, std::generic_category(), "cannot write a plan");
        });
    else if (format == "csv") {
        say_warnings(collect_warnings(p.plans)); // there is no place for them in a table
        print_csv(stdout, p, e);
    } else
        print_text(stdout, p, e, sound);
}

} // namespace

int run_plan(command_line& line)
{
    std::string format;
    add_strokes(line);
    settings& s = add_options(line, options::on_plan);
    add_format_option(line.app, format, {"text", "json", "csv"}, "format of the output (default text)");
    line.app.footer("tactor plan park2016-1\n"
                    "tactor plan --shape circle --duration 2\n"
                    "tactor plan park2016-1 --format json");
    line.parse();
    print_plan(s, format);
    return status_ok;
}

} // namespace tactor::cli
