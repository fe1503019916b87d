// SPDX-License-Identifier: MIT
#include "server/files/import_strokes.hpp"

#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/trajectory/sample_points.hpp"
#include "core/words.hpp"
#include "files/plan/plan_file.hpp"
#include "files/setup_text.hpp"
#include "files/text_file.hpp"
#include "net/base64.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;

constexpr std::size_t longest_name = 255;

/// Strokes as they were read, and the text if it is TOML that says the same.
struct read_file {
    std::vector<stroke> strokes = {};
    std::string toml = {};
};

// Returns the parameter that has the strokes.
const char* find_content(const json& params)
{
    const char* found = find_one(params, {"stroke", "text", "base64"});
    if (found == nullptr)
        bad_param("text", "nothing says what to read", "one of text, base64, stroke");
    return found;
}

std::string file_name(const json& params)
{
    const json* name = member(params, "name");
    return name == nullptr ? "stroke" : text(*name, "name");
}

std::string content(const std::string& source, const json& v)
{
    const std::string& given = text(v, source);
    if (source == "text")
        return given;
    std::optional<std::string> bytes = net::read_base64(given);
    if (!bytes)
        bad_param(source, "it is no base64", "four characters for three bytes, = at the end");
    return *std::move(bytes);
}

double intensity_max(const json& params)
{
    const json* said = member(params, "intensity_max");
    return said == nullptr ? 1.0 : number(*said, "intensity_max", detail::bounds_of::intensity_max);
}

bool is_plan(std::string_view bytes, const std::string& name)
{
    const std::string extension = in_small_letters(std::filesystem::path(name).extension().string());
    const bool is_stroke = extension == ".toml" || extension == ".csv" || extension == ".svg";
    return extension == ".json" || (!is_stroke && files::holds_plans(bytes));
}

std::vector<stroke> read_plan_strokes(std::string_view bytes, const std::string& name)
{
    files::plan_file f = files::read_plans(bytes, name, files::recordings_kind::refuse);
    for (std::size_t i = 0; i < f.made.strokes.size(); ++i) {
        f.made.strokes[i].start_s = f.made.plans[i].start_s;
        f.made.strokes[i].anchor = f.made.plans[i].anchor;
    }
    return std::move(f.made.strokes);
}

read_file read_bytes(std::string bytes, const std::string& name, double intensity_max)
{
    if (is_plan(bytes, name))
        return {read_plan_strokes(bytes, name)};
    const std::string_view format = detail::find_stroke_format(bytes, name);
    if (format == "svg")
        return {parse_strokes_svg(bytes, name)};
    if (format == "csv")
        return {parse_strokes_csv(bytes, name, intensity_max)};
    std::vector<stroke> strokes = parse_strokes_toml(bytes, name, intensity_max);
    if (intensity_max != 1.0)
        bytes.clear(); // its intensities are not what others would read
    return {std::move(strokes), std::move(bytes)};
}

std::string toml_text(std::vector<stroke> strokes, const std::vector<double>& starts)
{
    count_from_piece(strokes, starts);
    return detail::strokes_text(strokes);
}

// Appends the points of each stroke, by hand: a document of a million numbers takes too much memory.
void append_points(std::string& out, const std::vector<stroke>& strokes, std::size_t most_bytes)
{
    for (const stroke& k : strokes) {
        out += out.back() == '[' ? "[" : ",[";
        for (const timed_point& p : detail::sample_points(k.motion)) {
            fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}]", out.back() == '[' ? "" : ",", p.t_s,
                           p.position.x_mm, p.position.y_mm, p.intensity);
            if (out.size() > most_bytes)
                limit_reached("import", "its result is too large to be sent", "make it shorter or simpler");
        }
        out += ']';
    }
}

std::string result_text(const read_file& f, std::size_t most_bytes)
{
    const std::vector<double> starts = path_starts_s(f.strokes);
    net::reply_json strokes = net::reply_json::array();
    net::reply_json warnings = net::reply_json::array();
    for (std::size_t i = 0; i < f.strokes.size(); ++i) {
        const stroke& k = f.strokes[i];
        strokes.push_back({{"name", k.name}, {"start_s", starts[i]}, {"duration_s", k.motion.duration_s()}});
        for (const std::string& w : k.warnings)
            warnings.push_back(net::cut_echo(w));
    }
    const net::reply_json toml = f.toml.empty() ? toml_text(f.strokes, starts) : f.toml;
    std::string out =
        fmt::format(R"({{"toml":{},"strokes":{},"points":[)", net::json_line(toml), net::json_line(strokes));
    append_points(out, f.strokes, most_bytes);
    return out + fmt::format(R"(],"warnings":{}}})", net::json_line(warnings));
}

// Returns the fault of the exception that is being handled, about a parameter with the text of a named file.
net::rpc_fault content_fault(const std::string& source, const std::string& name)
{
    net::rpc_fault f = current_fault(name);
    if (f.what == name)
        f.what = source;
    return f;
}

} // namespace

void check_import(const json& params)
{
    allow_only(params, {"name", "text", "base64", "stroke", "fit", "intensity_max"});
    static_cast<void>(text(params[find_content(params)], find_content(params)));
    static_cast<void>(flag(params, "fit"));
    static_cast<void>(intensity_max(params));
    if (file_name(params).size() > longest_name)
        bad_param("name", fmt::format("it has more than {} bytes", longest_name), "shorten it");
}

std::string import_strokes(const planning& with, const layout& faces, const json& params,
                           std::size_t most_bytes)
{
    const std::string source = find_content(params);
    const std::string name = source == "stroke" ? source : file_name(params);
    const bool fit = flag(params, "fit");
    try {
        read_file f = source == "stroke"
                          ? read_file{read_strokes(source, params[source], with.owner)}
                          : read_bytes(content(source, params[source]), name, intensity_max(params));
        if (fit)
            f.toml.clear();
        f.strokes = settle_strokes(with, faces, std::move(f.strokes), with.owner, fit);
        return result_text(f, most_bytes);
    } catch (const fault_error&) {
        throw;
    } catch (...) {
        throw fault_error(content_fault(source, name));
    }
}

} // namespace tactor::server
