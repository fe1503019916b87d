// SPDX-License-Identifier: MIT
#include "server/files/export_strokes.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/trajectory/sample_points.hpp"
#include "files/setup_text.hpp"
#include "net/base64.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "server/faults.hpp"
#include "server/files/file_name.hpp"
#include "sink/wav/wav.hpp"

namespace tactor::server {
namespace {

using net::json;

/// A kind of file, and the command of the tool that makes it, or plays it.
struct file_kind {
    std::string_view extension;
    std::string_view mime;
    std::string_view command;
    options::place place;
    std::string_view reads; ///< extension
    std::string_view into;  ///< before the file that it writes
    std::string_view writes;
    std::optional<plot::file_format> picture = {};

    bool has_plan() const { return extension != "toml" && extension != "csv"; }
};

constexpr std::array kinds{
    file_kind{"toml", "application/toml", "render", options::on_render, "toml", "-o", "wav"},
    file_kind{"csv", "text/csv", "render", options::on_render, "csv", "-o", "wav"},
    file_kind{"wav", "audio/wav", "render", options::on_render, "toml", "-o", "wav"},
    file_kind{"json", "application/json", "plan", options::on_plan, "toml", "--format json >", "json"},
    file_kind{"svg", "image/svg+xml", "plot", options::on_plot, "toml", "-o", "svg", plot::file_format::svg},
    file_kind{"png", "image/png", "plot", options::on_plot, "toml", "-o", "png", plot::file_format::png},
    file_kind{"pdf", "application/pdf", "plot", options::on_plot, "toml", "-o", "pdf",
              plot::file_format::pdf}};

const file_kind& find_kind(const json& params)
{
    const json* as = member(params, "as");
    constexpr const char* hint = "one of toml, csv, svg, wav, png, pdf, json";
    if (as == nullptr)
        bad_param("as", "it is missing", hint);
    const std::string name = text(*as, "as");
    const auto* found =
        std::find_if(kinds.begin(), kinds.end(), [&name](const file_kind& k) { return k.extension == name; });
    if (found == kinds.end())
        bad_param("as", fmt::format("there is no \"{}\"", name), hint);
    return *found;
}

[[noreturn]] void too_large(std::size_t most_bytes)
{
    limit_reached("export", fmt::format("the file is larger than {} MiB", most_bytes >> 20U),
                  "make it shorter, or make it with the tool");
}

std::string choose_name(const json& params, const std::vector<stroke>& strokes)
{
    if (const json* name = member(params, "name"))
        return text(*name, "name");
    return make_file_name(strokes.size() == 1 ? strokes.front().name : "strokes");
}

format_kind sample_format(const options::wishes& s)
{
    return s.format.value_or(format_kind::float32);
}

// Refuses a WAV file before it is rendered. A plan may last a little longer than its path.
void check_samples(const exporting& e, const options::wishes& s, double seconds)
{
    const double frame_bytes = static_cast<double>(s.render.channels * sample_bytes(sample_format(s)));
    if (seconds * s.render.rate * frame_bytes > static_cast<double>(e.most_bytes))
        too_large(e.most_bytes);
}

double end_s(const std::vector<stroke>& strokes)
{
    const std::vector<double> starts = path_starts_s(strokes);
    double end = 0.0;
    for (std::size_t i = 0; i < strokes.size(); ++i)
        end = std::max(end, starts[i] + strokes[i].motion.duration_s());
    return end;
}

// Gives strokes that count from a group a start in seconds, which takes their plans: a plan may last longer
// than its path.
void place_by_plans(const exporting& e, const options::wishes& s, std::vector<stroke>& strokes,
                    const go_on_check& go_on)
{
    if (std::none_of(strokes.begin(), strokes.end(), counts_from_group))
        return;
    planned p{{"", strokes}, s.render};
    plan_strokes(e.with, e.faces, p, s, "stroke", go_on);
    count_from_piece(strokes, p.starts_s());
}

// Returns the strokes as the tool reads them in the exported file: all its digits come from there.
std::vector<stroke> read_again(const std::string& toml, const std::string& source,
                               const std::vector<stroke>& written)
{
    std::vector<stroke> strokes = parse_strokes_toml(toml, source);
    for (std::size_t i = 0; i < strokes.size(); ++i)
        strokes[i].places = written[i].places; // in the client's text
    return strokes;
}

std::string csv_text(const std::vector<stroke>& strokes)
{
    if (strokes.size() != 1)
        bad_param("as", fmt::format("a CSV file has one stroke, and there are {}", strokes.size()),
                  "as toml");
    std::string out = "t_s,x_mm,y_mm,intensity\n";
    for (const timed_point& p : detail::sample_points(strokes.front().motion))
        fmt::format_to(std::back_inserter(out), "{},{},{},{}\n", p.t_s, p.position.x_mm, p.position.y_mm,
                       p.intensity);
    return out;
}

std::string file_bytes(const exporting& e, const file_kind& kind, const planned& p, const options::wishes& s)
{
    if (kind.picture) {
        const std::string title = plot::name_scene(p.strokes, p.name + ".toml");
        const plot::scene shown{e.with.tactors, title, p.strokes, p.plans, nullptr, p.moved};
        return plot::to_bytes(plot::draw_figure(shown, {}), *kind.picture, plot::usual_dpi);
    }
    try {
        if (kind.extension == "json")
            return e.plan_text(p, e.most_bytes);
    } catch (const std::bad_alloc&) {
        too_large(e.most_bytes);
    }
    check_samples(e, s, p.total_s());
    return wav::bytes(score(e.with.tactors, p.plans, p.render), sample_format(s));
}

std::string command_line(const exporting& e, const file_kind& kind, const std::string& name,
                         const options::wishes& s)
{
    return fmt::format("tactor {} {}{} {} {}", kind.command,
                       quote_word(fmt::format("{}.{}", name, kind.reads)),
                       option_words(s, kind.place, e.with.tactors, e.named, kind.reads == "toml"), kind.into,
                       quote_word(fmt::format("{}.{}", name, kind.writes)));
}

std::string result_text(const exporting& e, const file_kind& kind, const std::string& name,
                        const options::wishes& s, const std::string& bytes)
{
    if (bytes.size() > e.most_bytes)
        too_large(e.most_bytes);
    std::string out = fmt::format(R"({{"name":{},"mime":"{}","command":{},"base64":")",
                                  net::json_line(fmt::format("{}.{}", name, kind.extension)), kind.mime,
                                  net::json_line(command_line(e, kind, name, s)));
    net::append_base64(out, bytes);
    return out + "\"}";
}

// Writes and reads the strokes: an exported file has the digits that the tool finds in it.
std::string make_bytes(const exporting& e, const file_kind& kind, const std::string& source,
                       const std::string& name, std::vector<stroke> strokes, const options::wishes& s,
                       const go_on_check& go_on)
{
    if (kind.extension == "csv")
        return csv_text(strokes);
    if (kind.extension != "json") {
        place_by_plans(e, s, strokes, go_on);
        for (stroke& k : strokes)
            put_options(k, s);
        std::string toml = detail::strokes_text(strokes);
        if (kind.extension == "toml")
            return toml;
        strokes = read_again(toml, source, strokes);
    }
    planned p{{name, std::move(strokes)}, s.render};
    plan_strokes(e.with, e.faces, p, s, source, go_on);
    return file_bytes(e, kind, p, s);
}

} // namespace

void check_export(const planning& with, const json& params)
{
    allow_only(params, {"stroke", "path", "points", "toml", "csv", "svg", "options", "fit", "as", "name"});
    static_cast<void>(find_source(params));
    static_cast<void>(find_kind(params));
    static_cast<void>(settle_options(with.owner, params));
    static_cast<void>(flag(params, "fit"));
    if (const json* name = member(params, "name"); name != nullptr && !is_file_name(text(*name, "name")))
        bad_param("name", "it is no name for a file", "1 to 100 letters, digits, blanks, - and _");
}

std::string export_strokes(const exporting& e, const json& params, const go_on_check& go_on)
{
    const std::string source = find_source(params);
    const file_kind& kind = find_kind(params);
    const options::wishes s = settle_options(e.with.owner, params);
    try {
        std::vector<stroke> strokes =
            settle_strokes(e.with, e.faces, read_strokes(source, params[source], s), s, flag(params, "fit"));
        if (!kind.has_plan())
            check_level(e.with, s, 1.0, s.plan.carrier_hz, source);
        if (kind.extension == "wav")
            check_samples(e, s, end_s(strokes));
        const std::string name = choose_name(params, strokes);
        return result_text(e, kind, name, s, make_bytes(e, kind, source, name, std::move(strokes), s, go_on));
    } catch (const fault_error&) {
        throw;
    } catch (...) {
        throw fault_error(current_fault(source));
    }
}

} // namespace tactor::server
