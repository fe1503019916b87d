// SPDX-License-Identifier: MIT
// The commands plan, render, plot and convert. They write a STROKE as text, samples, a picture or another
// file, without a device.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "files/plan/plan_json.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "session/environment.hpp"
#include "session/process.hpp"
#include "session/stroke_text.hpp"
#include "sink/wav/wav.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

// Returns a line about the result of --fit. It applies to all strokes of the piece.
std::string fit_note(const fitting& f)
{
    return fmt::format(
        "fitted: ({:.6g}, {:.6g}) mm as drawn becomes ({:.6g}, {:.6g}) mm, lengths times {:.6g}{}\n",
        f.from.x_mm, f.from.y_mm, f.to.x_mm, f.to.y_mm, f.scale,
        f.line ? ", onto the line of the array" : "");
}

std::string level_text(const render_options& sound, const stroke& s)
{
    std::string text = sound.sl_db ? fmt::format("{} dB SL", plain_number(*sound.sl_db))
                                   : fmt::format("{} dBFS", plain_number(sound.level_dbfs));
    if (s.choices.level_db != 0.0)
        text += fmt::format(" and its own {} dB", plain_number(s.choices.level_db));
    return text;
}

std::string heading(const std::string& title, const stroke& s, const plan& p, double start_s, const array& a,
                    const render_options& sound)
{
    const std::string soa = p.soa_s ? ", SOA " + seconds_text(*p.soa_s) : "";
    const std::string bursts = p.curve ? "continuous" : counted(p.bursts.size(), "burst");
    return fmt::format("{} on {}: {} with {}, {}{}\nstarts at {}, {} mm in {}, {} of sound\n"
                       "vibration: {}{}, level {}\n",
                       title, make_printable(a.name), p.algorithm, plot::describe_phantom(p), bursts, soa,
                       seconds_text(start_s, 9), plain_number(p.stroke_length_mm),
                       seconds_text(p.stroke_duration_s), seconds_text(p.total_s),
                       p.wave.kind == waveform_kind::sine ? "sine of " : "", plot::describe_sound(p),
                       level_text(sound, s));
}

void print_one(const std::string& title, const stroke& s, const plan& p, double start_s, const array& a,
               const render_options& sound)
{
    say(stdout, "{}", heading(title, s, p, start_s, a, sound));
    if (s.note != note_kind::none)
        say(stdout, "note: {}\n", files::note_text(s.note));
    say(stdout, "\n{:>10} {:>10} {:>9} {:>9}  {}\n", p.curve ? "t_s" : "onset_s", "duration_s", "x_mm",
        "y_mm", "tactor:amplitude");
    files::for_each_row(p, [&](const burst& b) {
        std::string drives;
        for (const drive& d : b.drives)
            drives += fmt::format(" {}:{:.4f}", d.tactor, d.amplitude);
        fmt::print("{}",
                   fit_lines(stdout, fmt::format("{:10.6f} {:10.6f} {:9.3f} {:9.3f} {}\n", b.onset_s,
                                                 b.duration_s, b.position.x_mm, b.position.y_mm, drives)));
    });
    for (const conflict& c : p.conflicts)
        say(stdout, "conflict: tactor {} serves two bursts from {:.6f} s to {:.6f} s\n", c.tactor, c.from_s,
            c.to_s);
    for (const meeting& m : p.dropped)
        say(stdout, "dropped: the crossing at ({:.3f}, {:.3f}) mm, {:.6f} s\n", m.position.x_mm,
            m.position.y_mm, m.t_s);
    for (const std::string& w : p.warnings)
        say(stdout, "warning: {}\n", w);
}

// Writes a plan part by part, as print_csv() does, so that a plan of an hour needs no document in memory.
void print_text(const piece& p, const environment& e, const render_options& sound, const weakening& weakened)
{
    const auto starts = start_times_s(p.plans);
    if (p.fit)
        say(stdout, "{}", fit_note(*p.fit));
    if (const std::string text = session::weakening_text(weakened, p.plans.size()); !text.empty())
        say(stdout, "{}\n", spell_marks(text));
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        if (i != 0)
            fmt::print("\n");
        print_one(format_stroke_name(p, i, e), p.strokes[i], p.plans[i].plan, starts[i], e.tactors, sound);
    }
}

void print_csv(const piece& p, const environment& e)
{
    fmt::print("stroke,start_s,onset_s,duration_s,tau_s,x_mm,y_mm,tactor,channel,amplitude\n");
    const auto starts = start_times_s(p.plans);
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        files::for_each_row(p.plans[i].plan, [&](const burst& b) {
            const std::string tau = b.tau_s ? fmt::format("{}", *b.tau_s) : "";
            for (const drive& d : b.drives)
                fmt::print("{},{},{},{},{},{},{},{},{},{}\n", i, starts[i], b.onset_s, b.duration_s, tau,
                           b.position.x_mm, b.position.y_mm, d.tactor, e.tactors.tactors[d.tactor].channel,
                           d.amplitude);
        });
    }
}

void print_plan(settings& s, const std::string& format)
{
    const environment e = session::read_environment(s);
    const piece p = plan_one_piece(s, e);
    const render_options sound = session::find_render_options(s, e);
    const score samples = make_score(p, e, sound); // this also checks levels and carrier
    session::warn_of_other_carrier(e, sound, std::span(&samples, 1));
    if (format == "json")
        files::write_plans({p, e.tactors, samples, sound}, [](std::string_view part) {
            // A plan may be an hour long, so stop when the reader has closed the pipe.
            if (std::fwrite(part.data(), 1, part.size(), stdout) != part.size())
                throw std::system_error(errno, std::generic_category(), "cannot write a plan");
        });
    else if (format == "csv") {
        print_grouped_warnings(collect_warnings(p.plans)); // a table has no place for warnings
        warn_of_weakening(shown_name(p.name), samples.weakened(), p.plans.size());
        print_csv(p, e);
    } else
        print_text(p, e, sound, samples.weakened());
}

// Returns the file to write; "-" is standard output. Refuses files of other kinds, because a typing mistake
// must not replace a user's document.
fs::path resolve_output_file(const std::string& name, bool force)
{
    constexpr const char* standard_output = "/dev/stdout";
    fs::path file = name == "-" ? standard_output : name;
    if (file == standard_output) {
        if (isatty(STDOUT_FILENO) != 0)
            refuse_option("-o", "standard output is a terminal, which cannot show samples",
                          "name a file, or pipe the samples into another program");
        return file;
    }
    std::error_code none;
    const fs::file_status there = fs::status(file, none);
    if (name.empty() || fs::is_directory(there) || (fs::exists(there) && !fs::is_regular_file(there)))
        return file;
    if (to_lower_case(file.extension().string()) != ".wav")
        throw error(error_kind::bad_input, name, "the name does not end in .wav",
                    "end the name in .wav, or write -o - > FILE");
    wav::check_output(file, force);
    return file;
}

int render(settings& s, const std::string& name, bool force)
{
    const fs::path file = resolve_output_file(name, force); // fails before the long work
    const environment e = session::read_environment(s);
    const layout faces(e.tactors);
    piece p = open_piece(s, e, faces, stroke_arguments(s).front());
    const render_options how = session::find_render_options(s, e);
    const score sc = plan_and_score(p, s, e, faces, how);
    const format_kind format = s.format.value_or(format_kind::float32);
    print_grouped_warnings(collect_warnings(sc.plans()));
    warn_of_weakening(shown_name(p.name), sc.weakened(), sc.plans().size());
    session::warn_of_other_carrier(e, how, std::span(&sc, 1));
    session::report_pipe_wait(file.string());
    session::interrupt stop;
    int signal = 0;
    {
        progress_line line(name);
        wav::save(sc, format, file, force, [&](std::uint64_t done, std::uint64_t all) {
            line.update(done, all);
            signal = stop.poll();
            return signal == 0;
        });
    }
    if (signal != 0)
        return session::interrupt::status(signal);
    say(file == "/dev/stdout" ? stderr : stdout, "{}: {}, {} Hz, {}, {} ({:.3f} s)\n", name,
        counted(sc.channels(), "channel"), sc.rate(), to_string(format), counted(sc.frames(), "frame"),
        static_cast<double>(sc.frames()) / sc.rate());
    return status_ok;
}

int draw(settings& s, const picture_options& o, plot::figure_options f)
{
    f.width_mm = o.width_mm;
    f.heading = o.has_title();
    const plot::file_format format = plot::find_format(o.file); // fails before the long work
    if (f.animated && format != plot::file_format::svg)
        refuse_option("--animate", "only SVG can be animated", "end the name in .svg");
    if (f.animated && f.view == plot::figure_view::wave)
        refuse_option("--animate", "the waveform cannot be animated", "leave out --view wave");
    const environment e = session::read_environment(s);
    const bool about_stroke = std::ranges::any_of(options::all(), [&s](const options::option& row) {
        return s.gives(row) && row.name != "array" && row.name != "config";
    });
    const bool array_alone = !has_stroke_argument(s) && !about_stroke &&
                             f.view != plot::figure_view::timing && f.view != plot::figure_view::wave &&
                             !f.animated;
    const piece q = array_alone ? piece{.name = e.tactors.name} : plan_one_piece(s, e);
    plot::check_output(o.file, o.force);
    // Only the view `wave` needs a score. The other views may show plans whose levels are too high for any
    // card.
    std::optional<score> sound;
    if (f.view == plot::figure_view::wave)
        sound = make_score(q, e, session::find_render_options(s, e));
    const std::string name = plot::scene_name(q.strokes, fs::path(shown_name(q.name)).filename().string());
    const plot::canvas picture = plot::draw_figure(
        {e.tactors, o.choose_title(name), q.strokes, q.plans, sound ? &*sound : nullptr, q.moved}, f);
    session::report_pipe_wait(o.file);
    plot::save(picture, o.file, o.dpi, o.force);
    print_grouped_warnings(collect_warnings(q.plans));
    if (sound)
        warn_of_weakening(shown_name(q.name), sound->weakened(), q.plans.size());
    say(stdout, "{}: {}{:.4g} x {:.4g} mm\n", o.file, array_alone ? "the array without a stroke, " : "",
        picture.width / plot::pt_per_mm, picture.height / plot::pt_per_mm);
    return status_ok;
}

// Warns about everything that the new file cannot represent.
void warn_of_loss(const std::string& file, const std::vector<std::string>& left_out)
{
    for (const std::string& what : left_out)
        say(stderr, "tactor: warning: {}: {}\n", make_printable(file), spell_marks(what));
}

// Returns the options on the command line that apply to a whole piece and cannot be stored in a stroke's
// file.
std::vector<std::string> list_piece_options(const settings& s)
{
    std::vector<std::string> all;
    for (const options::option& o : options::all()) {
        const bool read = o.name == "intensity_max" || o.name == "am" || (o.where & options::in_stroke) != 0;
        if (!read && s.gives(o) && (o.where & options::in_defaults) != 0)
            all.push_back(fmt::format("a stroke file cannot hold {{{}}}", o.name));
    }
    return all;
}

int convert_to_strokes(settings& s, const std::string& to, bool force)
{
    const detail::stroke_format& format = session::find_output_format(to, {".json", ".wav"});
    refuse_samples(stroke_arguments(s).front());
    const environment e = session::read_environment(s);
    if (format.one_vibration)
        s.actuator.reset(); // its frequencies are those that the format publishes
    const layout faces(e.tactors);
    piece p = open_piece(s, e, faces, stroke_arguments(s).front());
    const bool planned = !p.plans.empty();
    std::vector<stroke> strokes = planned ? session::list_plan_strokes(p) : p.strokes;
    session::replace_unsupported_starts(strokes, format, [&](const auto&) {
        session::plan_piece(p, e.tactors, faces, s);
        return p.starts_s();
    });
    if (!planned)
        session::add_missing_options(strokes, s);
    for (const stroke& k : strokes)
        print_grouped_warnings(k.warnings);
    warn_of_loss(to, session::save_strokes(strokes, to, force, &faces));
    if (p.had_own_fit && !format.one_vibration)
        warn_of_loss(to, {session::lost_fit(format)});
    warn_of_loss(to, list_piece_options(s));
    if (planned)
        warn_of_loss(to, {"a stroke file cannot hold the plan's array, level and ramps"});
    say(stdout, "{}: {}\n", to, counted(strokes.size(), "stroke"));
    return status_ok;
}

int convert_to_plan(settings& s, const std::string& to, bool force)
{
    const environment e = session::read_environment(s);
    const piece p = plan_one_piece(s, e);
    const render_options sound = session::find_render_options(s, e);
    const score samples = make_score(p, e, sound);
    session::warn_of_other_carrier(e, sound, std::span(&samples, 1));
    files::save_plans(files::plans_text({p, e.tactors, samples, sound}), to, force);
    const bool bursts = std::any_of(p.plans.begin(), p.plans.end(), [](auto& k) { return !k.plan.curve; });
    if (bursts && e.plans.empty())
        warn_of_loss(to, {"a plan cannot hold the path between its bursts"});
    say(stdout, "{}: {}\n", to, counted(p.plans.size(), "plan"));
    return status_ok;
}

int convert(settings& s, const std::string& to, bool force)
{
    const std::string extension = to_lower_case(fs::path(to).extension().string());
    if (extension == ".json")
        return convert_to_plan(s, to, force);
    if (extension != ".wav")
        return convert_to_strokes(s, to, force);
    const int status = render(s, to, force);
    if (status == status_ok && !is_wav_argument(s.strokes.front()))
        warn_of_loss(to, {"samples cannot hold the paths of strokes"});
    return status;
}

} // namespace

int run_plan(command_line& line)
{
    std::string format;
    add_stroke_argument(line);
    settings& s = add_options(line, options::on_plan);
    add_format_option(line.app, format, {"text", "json", "csv"}, "format of the output (default text)");
    line.app.footer("tactor plan park2016-1\n"
                    "tactor plan --shape circle --duration 2\n"
                    "tactor plan park2016-1 --format json");
    line.parse();
    print_plan(s, format);
    return status_ok;
}

int run_render(command_line& line)
{
    std::string file;
    bool force = false;
    add_stroke_argument(line);
    settings& s = add_options(line, options::on_render);
    line.app.add_option("-o,--output", file, "the file to write; - is standard output")
        ->type_name("FILE.wav")
        ->required();
    add_force_option(line.app, force);
    line.app.footer("tactor render park2016-3 -o stroke.wav\n"
                    "tactor render --path \"M 0 10 L 40 30\" --speed 80 -o line.wav\n"
                    "tactor render --shape circle --duration 2 --sample-format s16 -o circle.wav");
    line.parse();
    return render(s, file, force);
}

int run_plot(command_line& line)
{
    picture_options o;
    plot::figure_options f;
    add_stroke_argument(line);
    settings& s = add_options(line, options::on_plot);
    line.app.add_option("-o,--output", o.file, "picture to write")
        ->type_name("FILE.svg|.png|.pdf")
        ->required();
    add_text_option(line.app, "--view", "array|timing|wave|both",
                    "show the array, the bursts over time, the samples, or the first two (default both)",
                    [&f](const std::string& t) {
                        f.view = plot::figure_view(choose("--view", t, {"array", "timing", "wave", "both"}));
                    });
    line.app.add_flag("--animate", f.animated, "SVG: animate it in real time and in a loop");
    add_picture_options(line.app, o, "85, one print column");
    line.app.footer("tactor plot park2016-3 -o park2016-3.pdf\n"
                    "tactor plot --array palm-2x4 -o array.svg\n"
                    "tactor plot park2016-1 --view wave --width 170 -o wave.png");
    line.parse();
    return draw(s, o, f);
}

int run_convert(command_line& line)
{
    std::string to;
    bool force = false;
    add_stroke_argument(line, 1, "IN");
    settings& s = add_options(line, options::on_convert);
    line.app.add_option("OUT", to, "the file to write: .toml, .csv, .svg, .json (a plan) or .wav (samples)")
        ->type_name("")
        ->required();
    add_force_option(line.app, force);
    line.app.footer("tactor convert park2016-3 stroke.toml\n"
                    "tactor convert stroke.toml stroke.haptic\n"
                    "tactor convert stroke.toml plan.json --algorithm continuous");
    line.parse();
    return convert(s, to, force);
}

} // namespace tactor::cli
