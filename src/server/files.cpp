// SPDX-License-Identifier: MIT
#include "server/files.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <new>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/trajectory/spans.hpp"
#include "core/words.hpp"
#include "files/plan/plan_json.hpp"
#include "files/stroke_format.hpp"
#include "net/rpc.hpp"
#include "options/option.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "server/faults.hpp"
#include "server/service.hpp"
#include "session/piece.hpp"
#include "session/stroke_text.hpp"
#include "sink/wav/wav.hpp"

namespace tactor::server {
namespace {

// Greatest size of an exported file, and of the result of an import, in bytes.
constexpr std::size_t most_file_bytes = 64U << 20;

using net::json;

// Strokes from a file, and the file's text if it is TOML with the same contents.
struct read_file {
    std::vector<stroke> strokes = {};
    std::string toml = {};
};

const detail::stroke_format& toml_format()
{
    return *detail::find_format_by_name("toml");
}

std::string content(const std::string& source, const json& v)
{
    const auto& raw = v.get_ref<const std::string&>();
    if (source == "text")
        return raw;
    std::optional<std::string> bytes = net::decode_base64(raw);
    if (!bytes)
        refuse_param(source, "it is not base64", "give four characters for three bytes, with = at the end");
    return *std::move(bytes);
}

bool is_plan(std::string_view bytes, const std::string& name)
{
    return files::is_plan_file(to_lower_case(name)) ||
           (detail::find_format_by_extension(name) == nullptr && files::holds_plans(bytes));
}

read_file read_bytes(std::string bytes, const std::string& name, double intensity_max,
                     std::string_view position)
{
    if (is_plan(bytes, name))
        return {
            session::list_plan_strokes(files::read_plans(bytes, name, files::recordings_kind::refuse).made)};
    const detail::stroke_format* format = detail::find_stroke_format(bytes, name);
    std::vector<stroke> strokes =
        detail::read_stroke_text(*format, {bytes, name, intensity_max, nullptr, position});
    if (format->name != "toml" || intensity_max != 1.0)
        bytes.clear(); // other programs would read other intensities from this text
    return {std::move(strokes), std::move(bytes)};
}

// Appends the points of each stroke directly as text, because a JSON document of a million numbers takes too
// much memory.
void append_points(std::string& out, const std::vector<stroke>& strokes)
{
    for (const stroke& k : strokes) {
        out += out.back() == '[' ? "[" : ",[";
        for (const timed_point& p : detail::sample_points(k.motion)) {
            fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}]", out.back() == '[' ? "" : ",", p.t_s,
                           p.position.x_mm, p.position.y_mm, p.intensity);
            if (out.size() > most_file_bytes)
                refuse_over_limit("import", "the result is too large to send",
                                  "import a shorter or simpler file");
        }
        out += ']';
    }
}

// Returns the keys of a stroke file that describe a stroke, except the keys of its path and its start.
net::reply_json keys_json(const stroke& k)
{
    net::reply_json keys = net::reply_json::object();
    const auto put = [&keys](const char* key, const auto& value) {
        if (value)
            keys[key] = *value;
    };
    const auto put_kind = [&keys](const char* key, const auto& value) {
        if (value)
            keys[key] = to_string(*value);
    };
    put_kind("algorithm", k.choices.algorithm);
    put_kind("phantom", k.choices.phantom);
    put_kind("faces", k.choices.faces);
    put("soa_s", k.choices.soa_s);
    put("burst_s", k.choices.burst_s);
    if (k.choices.level_db != 0.0)
        keys["level_db"] = k.choices.level_db;
    if (k.sound.carrier_profile.empty() && k.sound.carrier_times.empty())
        put("carrier_hz", k.sound.carrier_hz);
    for (const carrier_time& p : k.sound.carrier_times)
        keys["carrier_hz"].push_back({p.t_s, p.hz});
    for (const carrier_part& p : k.sound.carrier_profile)
        keys["carrier_profile"].push_back({p.part, p.hz});
    if (k.sound.wave) {
        keys["waveform"] = waveform_text(*k.sound.wave);
        if (k.sound.wave->kind == waveform_kind::noise)
            keys["noise_seed"] = k.sound.wave->seed;
    }
    if (k.sound.am) {
        keys["am_hz"] = k.sound.am->hz;
        keys["am_depth"] = k.sound.am->depth;
    }
    return keys;
}

std::string result_text(read_file f)
{
    const std::vector<double> starts = session::path_starts_s(f.strokes);
    net::reply_json strokes = net::reply_json::array();
    net::reply_json warnings = net::reply_json::array();
    for (std::size_t i = 0; i < f.strokes.size(); ++i) {
        const stroke& k = f.strokes[i];
        strokes.push_back({{"name", k.name},
                           {"start_s", starts[i]},
                           {"duration_s", k.motion.duration_s()},
                           {"keys", keys_json(k)}});
        for (const std::string& w : k.warnings)
            warnings.push_back(net::truncate_echo(w));
    }
    if (f.toml.empty()) {
        session::replace_unsupported_starts(f.strokes, toml_format(), [&starts](auto&) { return starts; });
        f.toml = toml_format().write(f.strokes);
    }
    std::string out = fmt::format(R"({{"toml":{},"strokes":{},"points":[)", net::json_line(f.toml),
                                  net::json_line(strokes));
    append_points(out, f.strokes);
    return out + fmt::format(R"(],"warnings":{}}})", net::json_line(warnings));
}

// A kind of file that can be exported.
struct file_kind {
    std::string_view extension;
    std::string_view mime;
    std::optional<plot::file_format> picture = {};
    const detail::stroke_format* strokes = nullptr;
};

constexpr std::array other_kinds{file_kind{"wav", "audio/wav"}, file_kind{"json", "application/json"},
                                 file_kind{"svg", "image/svg+xml", plot::file_format::svg},
                                 file_kind{"png", "image/png", plot::file_format::png},
                                 file_kind{"pdf", "application/pdf", plot::file_format::pdf}};

// Returns all kinds of files. The first ones are the stroke formats that tactor can write.
const std::vector<file_kind>& file_kinds()
{
    static const std::vector<file_kind> kinds = [] {
        std::vector<file_kind> all;
        for (const detail::stroke_format* f : detail::stroke_formats())
            if (f->write != nullptr && f->name != "svg") // SVG is exported as a picture instead
                all.push_back({f->name, f->media_type, std::nullopt, f});
        all.insert(all.end(), other_kinds.begin(), other_kinds.end());
        return all;
    }();
    return kinds;
}

const file_kind& find_kind(const json& params)
{
    return *std::find_if(file_kinds().begin(), file_kinds().end(),
                         [&params](const file_kind& k) { return params["as"] == k.extension; });
}

[[noreturn]] void too_large()
{
    refuse_over_limit("export", fmt::format("the file is larger than {} MiB", most_file_bytes >> 20U),
                      "export a shorter stroke, or use the tool");
}

std::string choose_name(const json& params, const std::vector<stroke>& strokes)
{
    if (!params.contains("name"))
        return make_file_name(strokes.size() == 1 ? strokes.front().name : "strokes");
    auto name = params["name"].get<std::string>();
    if (make_file_name(name) != name)
        refuse_param("name", "it is not a file name", "use 1 to 100 letters, digits, blanks, - and _");
    return name;
}

// Parses the exported text, so that the strokes have the same digits as in the tool.
std::vector<stroke> reparse_strokes(const std::string& toml, const std::string& source,
                                    const std::vector<stroke>& written)
{
    std::vector<stroke> strokes = parse_strokes_toml(toml, source);
    for (std::size_t i = 0; i < strokes.size(); ++i)
        strokes[i].places = written[i].places; // places in the client's text, for error messages
    return strokes;
}

std::string file_bytes(const service_options& o, const file_kind& kind, const planned& p,
                       const options::option_values& s)
{
    if (kind.picture) {
        const std::string title = plot::scene_name(p.strokes, p.name + ".toml");
        const plot::scene shown{o.plans.tactors, title, p.strokes, p.plans, nullptr, p.moved};
        return plot::to_bytes(plot::draw_figure(shown, {}), *kind.picture, plot::usual_dpi);
    }
    try {
        if (kind.extension == "json")
            return o.plan_text(p, most_file_bytes);
    } catch (const std::bad_alloc&) {
        too_large();
    }
    const format_kind format = s.format.value_or(format_kind::float32);
    const double frames = p.total_s() * s.render.rate;
    if (frames * static_cast<double>(s.render.channels * sample_bytes(format)) > most_file_bytes)
        too_large(); // check before rendering
    return wav::bytes(session::make_score(p, o.plans.tactors, p.render), format, true);
}

// Makes the bytes of a file, and lists what it lacks. First writes the strokes and parses them again, because
// the exported file should contain the numbers that the tool will read.
session::written_strokes make_bytes(const service_options& o, const layout& faces, const file_kind& kind,
                                    const std::string& source, const std::string& name,
                                    std::vector<stroke> strokes, const options::option_values& s,
                                    const go_on_check& go_on)
{
    const auto write = [&] {
        return session::write_strokes(strokes, *kind.strokes, fmt::format("{}.{}", name, kind.extension),
                                      &faces);
    };
    if (kind.strokes != nullptr && kind.strokes->only_points) {
        if (strokes.size() != 1)
            refuse_param("as",
                         fmt::format("a {} file can have only one stroke, but there are {}",
                                     kind.strokes->title, strokes.size()),
                         "use toml");
        return write();
    }
    if (kind.extension != "json") {
        const detail::stroke_format& to = kind.strokes != nullptr ? *kind.strokes : toml_format();
        session::replace_unsupported_starts(strokes, to, [&](const std::vector<stroke>& all) {
            planned p{{"", all}, s.render};
            plan_strokes(o.plans, faces, p, s, "stroke", go_on);
            return p.starts_s(); // plans may last longer than their paths
        });
        session::add_missing_options(strokes, s);
        if (kind.strokes != nullptr)
            return write();
        strokes = reparse_strokes(to.write(strokes), source, strokes);
    }
    planned p{{name, std::move(strokes)}, s.render};
    plan_strokes(o.plans, faces, p, s, source, go_on);
    return {file_bytes(o, kind, p, s)};
}

} // namespace

std::vector<std::string_view> export_names()
{
    std::vector<std::string_view> names;
    for (const file_kind& k : file_kinds())
        names.push_back(k.extension);
    return names;
}

std::string import_strokes(const planning& with, const layout& faces, const json& params)
{
    const std::string source = params.contains("text")     ? "text"
                               : params.contains("base64") ? "base64"
                                                           : "stroke";
    const std::string name = source == "stroke" ? source : params.value("name", "stroke");
    const double intensity_max = params.value("intensity_max", 1.0);
    const std::string position = params.value("position", "");
    const bool fit = params.value("fit", false);
    try {
        read_file f = source == "stroke"
                          ? read_file{read_strokes(source, params[source], with.owner)}
                          : read_bytes(content(source, params[source]), name, intensity_max, position);
        if (fit)
            f.toml.clear();
        f.strokes = prepare_strokes(with, faces, std::move(f.strokes), with.owner, fit);
        return result_text(std::move(f));
    } catch (...) {
        throw fault_error(current_fault(source, name));
    }
}

std::string export_strokes(const service_options& o, const layout& faces, const json& params,
                           const go_on_check& go_on)
{
    const std::string source = find_source(params);
    const file_kind& kind = find_kind(params);
    options::option_values s = resolve_options(o.plans.owner, params);
    if (kind.strokes != nullptr && kind.strokes->one_vibration)
        s.actuator.reset(); // its frequencies are those that the format publishes
    try {
        std::vector<stroke> strokes = read_strokes(source, params[source], s);
        const bool fitted = session::has_fit(strokes);
        strokes = prepare_strokes(o.plans, faces, std::move(strokes), s, params.value("fit", false));
        if (kind.strokes != nullptr) // strokes can be written without a plan
            check_level(o.plans, s, 1.0, s.plan.carrier_hz, source);
        const std::string name = choose_name(params, strokes);
        session::written_strokes made =
            make_bytes(o, faces, kind, source, name, std::move(strokes), s, go_on);
        if (made.text.size() > most_file_bytes)
            too_large();
        if (fitted && kind.strokes != nullptr && !kind.strokes->one_vibration)
            made.left_out.push_back(session::lost_fit(*kind.strokes));
        std::string out = fmt::format(R"({{"name":{},"mime":"{}","base64":")",
                                      net::json_line(fmt::format("{}.{}", name, kind.extension)), kind.mime);
        net::append_base64(out, made.text);
        return out + fmt::format(R"(","warnings":{}}})", net::json_line(made.left_out));
    } catch (...) {
        throw fault_error(current_fault(source));
    }
}

std::string make_file_name(std::string_view name)
{
    constexpr std::size_t longest = 100;
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 -_";
    const auto is_beyond_ascii = [](char c) { return static_cast<unsigned char>(c) >= 0x80; };
    std::string made(first_characters(name, longest));
    for (char& c : made)
        if (!is_beyond_ascii(c) && plain.find(c) == plain.npos)
            c = '_';
    if (has_controls(made)) // such characters could control a terminal, or change the direction of text
        std::replace_if(made.begin(), made.end(), is_beyond_ascii, '_');
    if (made.starts_with('-') || made.starts_with(' '))
        made.front() = '_';
    while (made.ends_with(' '))
        made.pop_back();
    return made.empty() ? "stroke" : made;
}

} // namespace tactor::server
