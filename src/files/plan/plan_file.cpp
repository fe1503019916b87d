// SPDX-License-Identifier: MIT
// Reader of plan files.
#include "files/plan/plan_members.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/kind_names.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor::files {
namespace {

using nlohmann::ordered_json;

constexpr const char* hint = "see tactor-json(5)";
constexpr const char* how_to_make = "make a plan with {command:plan}";

constexpr std::uint64_t most_way_points = 10000;

bool is_same(const recording_facts& f, const recording& r)
{
    return f.sha256 == r.sha256 && f.frames == r.samples.size() && f.rate == r.rate_hz;
}

// Returns the waveform from the plan's own folder if the recording is there. A user may have moved the plan
// together with its recording.
std::optional<waveform> find_in_plan_folder(const std::string& file, const plan_sound& s)
{
    namespace fs = std::filesystem;
    const fs::path beside = fs::path(file).parent_path() / fs::path(*s.waveform).filename();
    std::error_code unknown;
    if (!s.recording || !fs::is_regular_file(beside, unknown))
        return {};
    try {
        waveform w;
        w.kind = waveform_kind::recording;
        w.recorded = std::make_shared<const recording>(load_recording(beside));
        return is_same(*s.recording, *w.recorded) ? std::optional(w) : std::nullopt;
    } catch (const error&) { // another file with the same name
        return {};
    }
}

// Reads the waveform from its file, or from a file with the same name in the plan's folder.
waveform read_waveform(const plan_sound& s, const json_value& stroke, recordings_kind recordings)
{
    if (recordings == recordings_kind::refuse && waveform_names_file(*s.waveform))
        stroke["waveform"].refuse(
            fmt::format("it names the file {}, but plans read from a text cannot name files", *s.waveform));
    const auto found = find_in_plan_folder(stroke.file(), s);
    try {
        return found ? *found : parse_waveform(*s.waveform);
    } catch (const error& e) {
        stroke["waveform"].refuse(fmt::format("{}: {}", e.subject(), e.why()), e.hint());
    }
}

// Sets the sound of a plan. Reads the WAV file that the sound names, or refuses it if `recordings` says so.
// `stroke` is the JSON value that contains the sound.
void set_sound(plan& p, const plan_sound& s, const json_value& stroke, recordings_kind recordings)
{
    if (s.waveform)
        p.wave = read_waveform(s, stroke, recordings);
    // With other samples, the plan would sound different.
    if (p.wave.recorded && s.recording && !is_same(*s.recording, *p.wave.recorded))
        throw error(error_kind::bad_input, source_place{p.wave.recorded->file},
                    "the recording has changed since the plan was made",
                    "plan the stroke again, or restore the old file");
    p.wave.seed = s.noise_seed.value_or(p.wave.seed);
    p.wave.texture = s.texture.value_or(p.wave.texture);
    p.wave.texture_mm = s.texture_mm.value_or(p.wave.texture_mm);
    if (s.am_hz.has_value() != s.am_depth.has_value())
        stroke["am_hz"].refuse("it needs am_depth");
    if (s.am_hz)
        p.am = {*s.am_hz, *s.am_depth};
    p.course = s.course.value_or(p.course);
    for (std::size_t i = 1; i < p.course.size(); ++i)
        if (p.course[i].t_s < p.course[i - 1].t_s)
            stroke["course"].refuse("it has a point out of order");
}

// Refuses amplitudes above the intensity. A built-in phantom model divides the intensity between tactors, so
// no amplitude can be above it.
void check_amplitudes(const json_value& f, const std::string& name, const plan& p, double intensity,
                      std::span<const drive> drives)
{
    constexpr double rounding = 1e-9;
    if (!detail::find_kind<phantom_kind>(p.phantom))
        return;
    for (const drive& d : drives)
        if (d.amplitude > intensity * (1.0 + rounding))
            f[name].refuse(fmt::format("it drives tactor {} at amplitude {}, above its intensity of {}",
                                       d.tactor, d.amplitude, intensity));
}

// Checks that the drives and their order are such that a planner could have made them.
void check_bursts(const json_value& f, const array& a, const plan& p, const std::vector<burst>& bursts)
{
    double latest = 0.0;
    for (std::size_t i = 0; i < bursts.size(); ++i) {
        const burst& b = bursts[i];
        const auto refuse = [&](const std::string& why) { f[fmt::format("bursts[{}]", i)].refuse(why); };
        if (b.onset_s < latest)
            refuse("it begins before the previous one");
        latest = b.onset_s;
        for (std::size_t k = 0; k < b.drives.size(); ++k) {
            if (b.drives[k].tactor >= a.tactors.size())
                refuse(fmt::format("it drives tactor {}, but the array has {}", b.drives[k].tactor,
                                   counted(a.tactors.size(), "tactor")));
            if (k > 0 && b.drives[k].tactor <= b.drives[k - 1].tactor)
                refuse("its drives are not in order of tactor");
        }
        check_amplitudes(f, fmt::format("bursts[{}]", i), p, b.intensity, b.drives);
    }
}

void check_samples(const json_value& f, const array& a, const plan& p, const curve_samples& samples)
{
    for (std::size_t i = 0; i < samples.ends.size(); ++i) {
        const std::size_t first = i == 0 ? 0 : samples.ends[i - 1];
        check_amplitudes(f, fmt::format("points[{}]", i), p, samples.intensities[i],
                         std::span(samples.drives).subspan(first, samples.ends[i] - first));
    }
    for (const drive& d : samples.drives)
        if (d.tactor >= a.tactors.size())
            f["points"].refuse(fmt::format("they drive tactor {}, but the array has {}", d.tactor,
                                           counted(a.tactors.size(), "tactor")));
}

// Checks what a plan says about its bursts or points, and adds the bursts or points to the plan.
void set_bursts_or_points(const json_value& f, plan_parts& parts, std::vector<burst> bursts,
                          curve_samples samples)
{
    plan& p = parts.plan;
    check_bursts(f, parts.tactors, p, bursts);
    p.bursts = std::move(bursts);
    for (const conflict& c : p.conflicts)
        if (c.tactor >= parts.tactors.tactors.size())
            f["conflicts"].refuse(fmt::format("they name tactor {}, but the array has {}", c.tactor,
                                              counted(parts.tactors.tactors.size(), "tactor")));
    if (!parts.is_sampled)
        return;
    if (parts.step_s != continuous_step_s)
        f["continuous"]["step_s"].refuse(fmt::format("it must be {} s", continuous_step_s));
    check_samples(f, parts.tactors, p, samples);
    try {
        p.curve = curve(p.stroke_duration_s, std::move(samples));
    } catch (const error& e) {
        f["continuous"]["points"].refuse(e.why());
    }
}

// Returns a stroke for pictures. Its path connects the plan's bursts or samples. If the plan is compensated,
// the path is the target that the compensation was for.
stroke read_stroke(const json_value& f, const plan_parts& parts)
{
    const plan& p = parts.plan;
    std::vector<timed_point> way;
    const auto add = [&](double t_s, const burst& b) {
        if (way.empty())
            way.push_back({0.0, b.position, b.intensity});
        else if (t_s > way.back().t_s && t_s < p.stroke_duration_s)
            way.push_back({t_s, b.position, b.intensity});
    };
    burst last;
    if (parts.moved && !parts.moved->taps.empty())
        for (const tap& t : parts.moved->taps) {
            last.position = t.target;
            add(t.onset_s, last);
        }
    else
        for (const burst& b : p.bursts)
            add(b.tau_s.value_or(b.onset_s), last = b);
    // A picture needs no more points than people can distinguish.
    const std::uint64_t step = p.curve ? 1 + p.curve->size() / most_way_points : 1;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); k += step) {
        p.curve->sample(k, last);
        add(last.onset_s, last);
    }
    if (p.curve)
        p.curve->sample(p.curve->size() - 1, last);
    if (way.empty())
        f["bursts"].refuse("there are none");
    way.push_back({p.stroke_duration_s, last.position, last.intensity});
    stroke s{.name = parts.name};
    s.motion = trajectory::timed(std::move(way));
    s.sound.carrier_hz = p.carrier_hz;
    s.sound.wave = p.wave;
    s.sound.am = p.am;
    s.note = parts.note;
    return s;
}

/// Handler of parser events. It takes each burst and each sample when it is complete, and removes it from the
/// document.
class reader {
public:
    reader(std::string file, recordings_kind recordings) : file_(std::move(file)), recordings_(recordings) {}

    bool event(int depth, ordered_json::parse_event_t what, ordered_json& parsed)
    {
        const auto d = static_cast<std::size_t>(depth);
        if (what == ordered_json::parse_event_t::key) {
            keys_.resize(d + 1);
            keys_[d] = parsed.get<std::string>();
        }
        if (what != ordered_json::parse_event_t::object_end || keys_.size() < 2)
            return true;
        const std::size_t top = keys_[1] == "plans" ? 2 : 0; // depth of a plan in the document
        if (d == top)
            return end_plan(parsed, top == 0);
        return !(d > top && d - top <= 3 && take(d - top, top, parsed));
    }

    plan_file result() &&
    {
        if (read_.made.plans.empty())
            throw error(error_kind::bad_input, file_, "it has no plan", how_to_make);
        return std::move(read_);
    }

private:
    std::string key(std::size_t depth) const { return depth < keys_.size() ? keys_[depth] : ""; }

    // Takes a burst or a sample at depth `deep` of a plan.
    bool take(std::size_t deep, std::size_t top, const ordered_json& j)
    {
        const bool is_burst = deep == 2 && key(top + 1) == "bursts";
        const bool is_sample = deep == 3 && key(top + 1) == "continuous" && key(top + 2) == "points";
        if (is_burst)
            json_reader::read({j, file_, hint, fmt::format("bursts[{}]", bursts_.size())}, [this](auto& io) {
                describe_burst_members(io, bursts_.emplace_back(), none_);
            });
        if (is_sample) {
            burst b;
            json_reader::read({j, file_, hint, fmt::format("points[{}]", samples_.ends.size())},
                              [&](auto& io) { describe_point_members(io, b, none_); });
            samples_.add(b);
        }
        return is_burst || is_sample;
    }

    // Takes a plan at its end, and returns false so that the parser drops it. Returns true for the object
    // that contains several plans.
    bool end_plan(const ordered_json& j, bool whole)
    {
        const json_value all(j, file_, hint);
        const std::string schema = all["schema"].text().value_or("none");
        if (whole && schema == "tactor-plans/1")
            return true;
        if (schema != "tactor-plan/1")
            throw error(error_kind::bad_input, file_,
                        fmt::format("its schema is {}, not tactor-plan/1", schema), how_to_make);
        plan_parts parts;
        json_reader::read(all, [&parts](auto& io) { describe_plan_members(io, parts); });
        validate(parts.tactors);
        set_sound(parts.plan, parts.sound, all["stroke"], recordings_);
        set_bursts_or_points(all, parts, std::exchange(bursts_, {}), std::exchange(samples_, {}));
        read_.made.strokes.push_back(read_stroke(all, parts));
        if (read_.made.plans.empty()) {
            read_.tactors = std::move(parts.tactors);
            read_.render = parts.options;
            read_.made.fit = parts.fit;
        } else {
            check_same_array(file_, parts.tactors, read_.tactors);
        }
        read_.made.plans.push_back(
            {std::move(parts.plan), parts.follows ? std::nullopt : std::optional(parts.start_s)});
        if (parts.moved)
            read_.made.moved.push_back(*std::move(parts.moved));
        if (!read_.made.moved.empty() && read_.made.moved.size() != read_.made.plans.size())
            all["compensation"].refuse("it is set in some plans, but not in all");
        return false;
    }

    std::string file_;
    recordings_kind recordings_;
    std::vector<std::string> keys_; ///< keys of the objects that are still open, by depth
    std::vector<burst> bursts_;
    curve_samples samples_;
    plan_file read_;
    plan_parts none_; ///< empty parts, for reading bursts that need no parts
};

// Throws an error with the place in the library's message. Such a message is
// "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ...".
[[noreturn]] void refuse_json(std::string_view what, const std::string& name)
{
    constexpr std::string_view line = "parse error at line ";
    constexpr std::string_view column = ", column ";
    what.remove_prefix(std::min(what.find("] ") + 2, what.size()));
    source_place place{name};
    if (const std::size_t middle = what.find(column); what.starts_with(line) && middle != what.npos) {
        const std::size_t end = what.find(": ", middle);
        place = {
            name,
            detail::parse_number_text<unsigned>(what.substr(line.size(), middle - line.size())).value_or(0),
            detail::parse_number_text<unsigned>(
                what.substr(middle + column.size(), end - middle - column.size()))
                .value_or(0)};
        what = "it is not JSON";
    }
    throw error(error_kind::bad_input, place, what, how_to_make);
}

// Reads plans from a stream or a text. `begin` returns the first bytes, which are needed to explain a
// failure.
template <class Input, class Begin>
plan_file parse_plans(Input&& in, const std::string& name, recordings_kind recordings, const Begin& begin)
{
    reader r(name, recordings);
    try {
        const ordered_json all =
            ordered_json::parse(in, [&r](int depth, ordered_json::parse_event_t what, ordered_json& parsed) {
                return r.event(depth, what, parsed);
            });
    } catch (const ordered_json::exception& e) {
        detail::refuse_other_form(begin(), name, detail::text_form::json, how_to_make);
        refuse_json(e.what(), name);
    }
    return std::move(r).result();
}

} // namespace

plan_file load_plans(const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    in.peek(); // a folder can be opened but not read
    const int code = errno;
    if (in.bad() || !in.is_open())
        throw error(error_kind::bad_input, source_place{file}, std::generic_category().message(code),
                    "check the name and the permissions")
            .with_os_code(code);
    detail::note_input(file);
    return parse_plans(in, file, recordings_kind::read, [&file] {
        std::error_code ignored;
        std::string bytes(std::filesystem::is_regular_file(file, ignored) ? 4096 : 0, '\0');
        std::ifstream again(file, std::ios::binary);
        again.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(static_cast<std::size_t>(again.gcount()));
        return bytes;
    });
}

plan_file read_plans(std::string_view text, const std::string& name, recordings_kind recordings)
{
    return parse_plans(text, name, recordings, [text] { return text; });
}

bool holds_plans(std::string_view text)
{
    return detail::find_text_form(text) == detail::text_form::json &&
           detail::find_format_by_content(text) == nullptr;
}

void check_same_array(const std::string& file, const array& made_for, const array& in_use)
{
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, file, why,
                    "plan the stroke for this array, or {array=none}: the plan has its own");
    };
    if (made_for.tactors.size() != in_use.tactors.size())
        refuse(fmt::format("the plan's array \"{}\" has {}, but \"{}\" has {}", made_for.name,
                           counted(made_for.tactors.size(), "tactor"), in_use.name, in_use.tactors.size()));
    const auto differs = [&](std::size_t i, const std::string& in_plan, const std::string& in_array) {
        refuse(fmt::format("tactor {} is {} in the plan's array \"{}\", but {} in \"{}\"", i, in_plan,
                           made_for.name, in_array, in_use.name));
    };
    for (std::size_t i = 0; i < in_use.tactors.size(); ++i) {
        const tactor_spec& a = made_for.tactors[i];
        const tactor_spec& b = in_use.tactors[i];
        if (distance_mm(a.position, b.position) > same_place_mm)
            differs(i, fmt::format("at ({:.6g}, {:.6g}) mm", a.position.x_mm, a.position.y_mm),
                    fmt::format("at ({:.6g}, {:.6g}) mm", b.position.x_mm, b.position.y_mm));
        if (a.channel != b.channel)
            differs(i, fmt::format("on channel {}", a.channel), fmt::format("on channel {}", b.channel));
        if (a.polarity != b.polarity)
            differs(i, fmt::format("of polarity {}", a.polarity), fmt::format("of polarity {}", b.polarity));
    }
}

} // namespace tactor::files
