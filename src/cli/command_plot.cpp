// SPDX-License-Identifier: MIT
#include <array>
#include <filesystem>
#include <optional>

#include <CLI/CLI.hpp>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

using plot::figure_view;

struct plot_settings {
    picture_options picture;
    figure_view view = figure_view::both;
    bool animated = false;
};

constexpr std::array views{figure_view::array, figure_view::timing, figure_view::wave, figure_view::both};

void add_plot_options(CLI::App& c, plot_settings& p)
{
    c.add_option("-o,--output", p.picture.file, "picture to write")
        ->type_name("FILE.svg|.png|.pdf")
        ->required();
    add_text(c, "--view", "array|timing|wave|both",
             "show the array, the bursts over time, the samples, or the first two (default both)",
             [&p](const std::string& t) {
                 p.view = views[choose("--view", t, {"array", "timing", "wave", "both"})];
             });
    c.add_flag("--animate", p.animated, "SVG: light up the tactors that play, again and again, in real time");
    add_picture_options(c, p.picture, "85, one print column");
}

int draw(settings& s, const plot_settings& p)
{
    const picture_options& o = p.picture;
    const plot::file_format format = plot::find_format(o.file); // before the work
    if (p.animated && format != plot::file_format::svg)
        refuse_option("--animate", "only SVG can move", "name a file .svg");
    if (p.animated && p.view == figure_view::wave)
        refuse_option("--animate", "the waveform does not move", "leave out --view wave");
    const environment e = session::read_environment(s);
    const piece q = plan_one_piece(s, e);
    plot::check_output(o.file, o.force);
    // Only the samples have levels: a picture of a plan needs none that a card could play.
    std::optional<score> sound;
    if (p.view == figure_view::wave)
        sound = make_score(q, e, session::settle_render(s, e));
    const std::string name =
        plot::name_scene(q.strokes, std::filesystem::path(shown_name(q.name)).filename().string());
    const plot::canvas picture = plot::draw_figure(
        {e.tactors, o.choose_title(name), q.strokes, q.plans, sound ? &*sound : nullptr, q.moved},
        {p.view, o.width_mm, o.has_title(), p.animated});
    session::tell_of_pipe_to_write(o.file);
    plot::save(picture, o.file, o.dpi, o.force);
    say_warnings(collect_warnings(q.plans));
    say(stdout, "{}: {:.4g} x {:.4g} mm\n", o.file, picture.width / plot::pt_per_mm,
        picture.height / plot::pt_per_mm);
    return status_ok;
}

} // namespace

int run_plot(command_line& line)
{
    plot_settings p;
    add_strokes(line);
    settings& s = add_options(line, options::on_plot);
    add_plot_options(line.app, p);
    line.app.footer("tactor plot park2016-3 -o park2016-3.pdf\n"
                    "tactor plot --shape eight --duration 3 --view array -o eight.svg\n"
                    "tactor plot park2016-1 --view wave --width 170 -o wave.png");
    line.parse();
    return draw(s, p);
}

} // namespace tactor::cli
