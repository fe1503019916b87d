// SPDX-License-Identifier: MIT
// Binds plans and scores.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/plan/plan_json.hpp"
#include "options/option.hpp"
#include "python/binding.hpp"
#include "sink/wav/wav.hpp"

namespace tactor::python {
namespace {

using namespace py::literals;

plan_handle make_plan_handle(const std::shared_ptr<array_handle>& on, const stroke& original,
                             const py::dict& options, const setup* file)
{
    option_values w;
    w.place = options::in_plan | options::in_score;
    take_options(w, options, on->value().tactors.size(), file);
    const layout& faces = on->faces();
    plan_handle p{on, place_stroke(original, faces, w)};
    p.sound = w.render;
    for (const options::option& o : options::all()) {
        const bool is_sound = (o.where & options::in_plan) != 0 && (o.where & options::planning) == 0;
        const bool is_set = w.gives(o) || w.in_file.contains(index(o)) || (o.name == "rate" && w.rate);
        if (is_sound && is_set)
            p.sound_options.emplace_back(o.name);
    }
    std::optional<without_lock> free;
    if (!w.plan.custom_phantom) // a custom model takes the lock for each point
        free.emplace();
    session::plan_stroke(p.one, 0, on->value(), faces, w);
    return p;
}

// Returns a property that reads a member of a plan.
template <class T>
auto member(T tactor::plan::*m)
{
    return [m](const plan_handle& p) -> const T& { return p.plan().*m; };
}

// Returns a member of all bursts as a view, without copying.
template <double burst::*Member>
py::array_t<double> column(const py::object& self)
{
    const auto& bursts = self.cast<const plan_handle&>().plan().bursts;
    if (bursts.empty())
        return to_numpy({});
    return make_view({static_cast<py::ssize_t>(bursts.size())}, {sizeof(burst)}, &(bursts.front().*Member),
                     self);
}

py::array_t<double> positions(const py::object& self)
{
    const auto& bursts = self.cast<const plan_handle&>().plan().bursts;
    if (bursts.empty())
        return to_numpy({}, 2);
    return make_view({static_cast<py::ssize_t>(bursts.size()), 2}, {sizeof(burst), sizeof(double)},
                     &bursts.front().position.x_mm, self);
}

py::array_t<double> amplitudes(const plan_handle& p)
{
    const std::size_t tactors = p.on->value().tactors.size();
    const auto& bursts = p.plan().bursts;
    std::vector<double> all(bursts.size() * tactors);
    for (std::size_t i = 0; i < bursts.size(); ++i)
        for (const drive& d : bursts[i].drives)
            all[i * tactors + d.tactor] = d.amplitude;
    return to_numpy(std::move(all), tactors);
}

py::array_t<double> taus(const plan_handle& p)
{
    std::vector<double> all;
    for (const burst& b : p.plan().bursts)
        all.push_back(b.tau_s.value_or(std::numeric_limits<double>::quiet_NaN()));
    return to_numpy(std::move(all));
}

// Returns times, positions, intensities and amplitudes of all samples of a curve.
py::tuple samples(const plan_handle& p)
{
    const curve& c = *p.plan().curve;
    const std::size_t tactors = p.on->value().tactors.size();
    std::vector<double> t, places, intensities, all;
    {
        const without_lock free;
        all.resize(c.size() * tactors);
        burst b;
        for (std::uint64_t k = 0; k < c.size(); ++k) {
            c.sample(k, b);
            t.push_back(b.onset_s);
            places.insert(places.end(), {b.position.x_mm, b.position.y_mm});
            intensities.push_back(b.intensity);
            for (const drive& d : b.drives)
                all[k * tactors + d.tactor] = d.amplitude;
        }
    }
    return py::make_tuple(to_numpy(std::move(t)), to_numpy(std::move(places), 2),
                          to_numpy(std::move(intensities)), to_numpy(std::move(all), tactors));
}

// Returns the columns of Percept. Places and speeds are NaN at times when nothing is felt.
py::tuple percept_columns(const plan_handle& p)
{
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> t, targets, places, intensities, target_intensities, shared, speeds;
    {
        const without_lock free;
        for (const percept_sample& s : predict_percept(p.on->value(), p.drawn(), p.plan())) {
            t.push_back(s.t_s);
            targets.insert(targets.end(), {s.target.x_mm, s.target.y_mm});
            const point where = s.felt.value_or(point{none, none});
            places.insert(places.end(), {where.x_mm, where.y_mm});
            intensities.push_back(s.intensity);
            target_intensities.push_back(s.target_intensity);
            shared.push_back(s.shared ? 1.0 : 0.0);
            speeds.push_back(s.speed_mm_s.value_or(none));
        }
    }
    return py::make_tuple(to_numpy(std::move(t)), to_numpy(std::move(places), 2),
                          to_numpy(std::move(intensities)), to_numpy(std::move(speeds)),
                          to_numpy(std::move(targets), 2), to_numpy(std::move(target_intensities)),
                          to_numpy(std::move(shared)).attr("astype")("bool"));
}

// Returns the amplitudes of all tactors for a phantom at each of the given places.
py::array_t<double> weights(phantom_kind kind, faces_kind of_faces, const array_handle& on,
                            const py::array_t<double, py::array::c_style | py::array::forcecast>& places,
                            double intensity)
{
    const layout& faces = on.faces();
    const auto model = make_phantom(kind, faces, of_faces);
    const std::size_t tactors = on.value().tactors.size();
    const auto at = places.unchecked<2>();
    std::vector<double> all(static_cast<std::size_t>(places.shape(0)) * tactors);
    std::vector<drive> drives;
    for (py::ssize_t i = 0; i < places.shape(0); ++i) {
        const point p{at(i, 0), at(i, 1)};
        const point near = faces.contains(p) ? p : faces.nearest(p);
        if (distance_mm(p, near) > edge_tolerance_mm)
            throw error(error_kind::bad_input, "point",
                        fmt::format("({:.6g}, {:.6g}) mm is outside the array, {:.3g} mm from it", p.x_mm,
                                    p.y_mm, distance_mm(p, near)),
                        "Array.nearest() returns the nearest point of the array")
                .with_field("point");
        model->weights(near, intensity, drives);
        for (const drive& d : drives)
            all[static_cast<std::size_t>(i) * tactors + d.tactor] = d.amplitude;
    }
    return to_numpy(std::move(all), tactors);
}

py::dict summary(const plan_handle& p)
{
    percept_summary s;
    {
        const without_lock free;
        s = summarise(p.on->value(), p.drawn(), p.plan());
    }
    return py::dict("rms_error_mm"_a = s.rms_error_mm, "largest_error_mm"_a = s.largest_error_mm,
                    "lag_s"_a = s.lag_s, "rms_at_lag_mm"_a = s.rms_at_lag_mm,
                    "along_rms_mm"_a = s.along_rms_mm, "along_max_mm"_a = s.along_max_mm,
                    "across_rms_mm"_a = s.across_rms_mm, "across_max_mm"_a = s.across_max_mm,
                    "rms_to_path_mm"_a = s.rms_to_path_mm, "speed_cv"_a = s.speed_cv,
                    "intensity_cv"_a = s.intensity_cv, "silent_share"_a = s.silent_share,
                    "shared_share"_a = s.shared_share);
}

// Returns a copy of a plan for another array with the same places.
// \throws error if the tactors have other numbers.
plan_handle move_plan(const plan_handle& p, const std::shared_ptr<array_handle>& to)
{
    const auto& from = p.on->value().tactors;
    const auto& tactors = to->value().tactors;
    for (std::size_t i = 0; i < tactors.size(); ++i)
        if (i >= from.size() || distance_mm(from[i].position, tactors[i].position) > same_place_mm)
            throw error(error_kind::bad_input, "score",
                        fmt::format("it is for the array \"{}\", but the player has the configuration's "
                                    "array, whose tactor {} is elsewhere",
                                    p.on->value().name, i),
                        "plan the stroke for Player.array");
    plan_handle moved = p;
    moved.on = to;
    return moved;
}

// Returns the plan as a JSON object in the tool's format tactor-plan/1. Without `is_for_play`, does not check
// level, carrier and marker, because a score can play the plan at another level or rate. Then the object's
// frames and its weakening are not those of any score.
std::string format_plan_json(const plan_handle& p, bool is_for_play)
{
    const without_lock free;
    const array& tactors = p.on->value();
    const render_options sound = session::set_default_channels(tactors, p.sound);
    const render_options silent{.rate = static_cast<unsigned>(options::find("rate")->allowed.high),
                                .level_dbfs = options::find("level_dbfs")->allowed.low,
                                .channels = sound.channels};
    return files::plans_text(
        {p.one, tactors, session::make_score(p.one, tactors, is_for_play ? sound : silent), sound});
}

// Reads a plan from JSON. `named` is its name in messages.
plan_handle plan_from_json(const std::string& text, const std::string& named)
{
    const without_lock free;
    files::plan_file f = files::read_plans(text, named);
    if (f.made.plans.size() != 1)
        throw error(error_kind::bad_input, named,
                    "there are " + counted(f.made.plans.size(), "plan") + " in it",
                    "use one of its \"plans\"");
    return {std::make_shared<array_handle>(std::move(f.tactors)), std::move(f.made), f.render};
}

// Number of frames between two checks for Ctrl-C. They take about 10 ms of work.
constexpr std::uint64_t frames_at_once = 1 << 18;

// A start, a plan, true if the plan was made for another array, and the setup of this array for options that
// the plan does not have.
using score_part = std::tuple<std::optional<double>, const plan_handle*, bool, const setup*>;

render_options resolve_sound(const plan_handle& p, const py::dict& keywords, bool elsewhere,
                             const setup* file)
{
    option_values w;
    w.place = options::in_score;
    w.render = p.sound;
    if (elsewhere)
        for (const std::string& name : p.sound_options)
            w.by_user.set(index(*options::find(name)));
    take_options(w, keywords, 0, file);
    // The number of channels in a recorded plan does not include the marker's channel.
    if (w.render.marker_channel && w.render.channels != 0 && !w.channels)
        w.render.channels = std::max(w.render.channels, *w.render.marker_channel + 1);
    return w.render;
}

// Returns the values that affect samples, except the plans and the array.
py::tuple recipe(const render_options& o)
{
    return py::make_tuple(o.rate, o.phase, o.ramp_s, envelope_text(o.envelope), o.envelope.attack_s,
                          o.envelope.release_s, o.channels, o.marker_channel, o.marker_s, o.limits,
                          o.sl_db.has_value(), o.together);
}

// Returns the values that determine how a single plan sounds. Python compares and hashes them.
py::tuple plan_recipe(const plan_handle& p)
{
    return recipe(session::set_default_channels(p.on->value(), p.sound)) +
           py::make_tuple(session::level_db(p.sound));
}

// Makes a score of several plans. Each plan keeps its level. The other options must be the same for all.
py::tuple make_score(const array_handle& on, const std::vector<score_part>& plans, const py::dict& keywords)
{
    std::vector<render_options> sounds;
    for (const auto& [start_s, p, elsewhere, file] : plans) {
        check_same_array(*p, on.value());
        sounds.push_back(resolve_sound(*p, keywords, elsewhere, file));
    }
    const session::joined_score made = [&] {
        const without_lock free;
        std::vector<session::sounding_plan> all;
        for (std::size_t i = 0; i < plans.size(); ++i)
            all.push_back({std::get<1>(plans[i])->at(std::get<0>(plans[i])), sounds[i]});
        return session::join_plans(on.value(), std::move(all));
    }();
    return py::make_tuple(made.samples,
                          recipe(made.sound) + py::make_tuple(py::tuple(py::cast(made.levels))));
}

// Makes a score from interleaved samples in format `f`, which are in a Python buffer.
py::tuple make_own_score(const array_handle& on, const py::buffer& frames, unsigned channels, format_kind f,
                         const py::dict& given, const setup* file)
{
    option_values w;
    w.place = options::in_score;
    take_options(w, given, 0, file);
    const render_options o = session::set_default_channels(on.value(), w.render);
    if (channels != o.channels)
        throw error(error_kind::bad_input, "samples",
                    fmt::format("it has {}, but the stream has {}", counted(channels, "channel"), o.channels),
                    "give one column for each channel of the stream")
            .with_field("samples");
    const py::buffer_info info = frames.request();
    const std::span bytes(static_cast<const std::byte*>(info.ptr),
                          static_cast<std::size_t>(info.size * info.itemsize));
    const score made = [&] {
        const without_lock free;
        if (bytes.size() > most_own_bytes) // checked before they are copied
            throw error(error_kind::bad_input, "samples", too_large_text(bytes.size()),
                        "play the samples in pieces")
                .with_field("samples");
        own_samples s{.rate = o.rate, .channels = channels, .format = f};
        s.bytes.assign(bytes.begin(), bytes.end());
        return score::from_samples(on.value(), std::move(s), o);
    }();
    return py::make_tuple(made, recipe(o) + py::make_tuple(f, o.level_dbfs));
}

// Checks for Ctrl-C when the caller does not have the lock. If Python's signal handler raises an exception,
// throws it.
void check_signals()
{
    const with_lock lock;
    if (in_python([] { return PyErr_CheckSignals(); }) != 0)
        throw py::error_already_set();
}

// Renderer of the next frames of a score, block by block.
class block_renderer {
public:
    block_renderer(const score& s, format_kind f) : renderer_(s, f), frame_(s.channels() * sample_bytes(f)) {}

    /// Fills memory with frames. Precondition: the size of `out` is a whole number of frames.
    void fill(std::span<std::byte> out)
    {
        while (!out.empty()) {
            const std::size_t n = std::min<std::size_t>(out.size(), frames_at_once * frame_);
            renderer_.process(out.first(n));
            out = out.subspan(n);
            if (!out.empty())
                check_signals();
        }
    }
    void fill_buffer(const py::buffer& to)
    {
        const py::buffer_info info = to.request(true);
        const std::span out(static_cast<std::byte*>(info.ptr),
                            static_cast<std::size_t>(info.size * info.itemsize));
        const without_lock free;
        fill(out);
    }
    void skip(std::uint64_t frames)
    {
        const without_lock free;
        std::vector<std::byte> unheard(std::min(frames, frames_at_once) * frame_);
        for (; frames > 0; frames -= std::min(frames, frames_at_once))
            fill(std::span(unheard).first(std::min(frames, frames_at_once) * frame_));
    }

private:
    renderer renderer_;
    std::size_t frame_; ///< bytes of a frame
};

void write(const score& s, const std::string& file, const std::string& format, bool force)
{
    static_cast<void>(options::read_value(*options::find("sample_format"), format));
    const auto f = from_string<format_kind>(format);
    const without_lock free;
    std::uint64_t next = frames_at_once;
    wav::save(s, f, std::filesystem::path(file), force, [&](std::uint64_t done, std::uint64_t) {
        if (done >= next) {
            next = done + frames_at_once;
            check_signals();
        }
        return true;
    });
}

void bind_score(py::module_& m)
{
    m.def("make_score", &make_score);
    m.def("make_own_score", &make_own_score);
    py::class_<score>(m, "Score")
        .def_property_readonly("frames", &score::frames)
        .def_property_readonly("channels", &score::channels)
        .def_property_readonly("rate", &score::rate)
        .def_property_readonly("starts", &score::starts)
        .def_property_readonly("weakened_db", [](const score& s) { return s.weakened().weakened_db; })
        .def_property_readonly("meets",
                               [](const score& s) -> py::object {
                                   const weakening& w = s.weakened();
                                   if (!(w.weakened_db < 0.0))
                                       return py::none();
                                   return py::dict("tactor"_a = w.tactor, "at"_a = w.at_s,
                                                   "plans"_a = w.plans);
                               })
        .def("write", &write);
    py::class_<block_renderer>(m, "Renderer")
        .def(py::init<const score&, format_kind>())
        .def("into", &block_renderer::fill_buffer)
        .def("skip", &block_renderer::skip);
}

} // namespace

void check_same_array(const plan_handle& p, const array& in_use)
{
    files::check_same_array("plan", p.on->value(), in_use);
}

session::piece place_stroke(const stroke& s, const layout& faces, const option_values& w)
{
    if (s.fit && s.fit->group != 0)
        throw error(error_kind::bad_input, fmt::format("stroke \"{}\"", s.name),
                    "its group is fitted as a whole",
                    "call apply_fits() with all strokes of the file, and pass its result here");
    return session::read_piece(std::vector{s}, "stroke", faces, w);
}

void bind_plan(py::module_& m)
{
    bind_score(m);
    m.def("option_rows", &option_rows);
    m.def("burst_duration", [](const py::dict& options) {
        option_values w;
        w.place = options::in_plan;
        take_options(w, options, 0);
        return burst_duration_s(w.plan);
    });
    m.def("phantom_weights", &weights);
    py::class_<plan_handle>(m, "Plan")
        .def(py::init(&make_plan_handle))
        .def_static("from_json", &plan_from_json)
        .def_static("from_parts",
                    [](const std::string& text, const stroke& drawn, const std::shared_ptr<array_handle>& on,
                       std::vector<std::string> sound_options) {
                        plan_handle p = plan_from_json(text, "plan");
                        check_same_array(p, on->value());
                        p.one.strokes = {drawn};
                        if (drawn.anchor != start_anchor{}) { // records do not have anchors
                            p.one.plans.front().start_s = drawn.start_s;
                            p.one.plans.front().anchor = drawn.anchor;
                        }
                        p.on = on;
                        p.sound_options = std::move(sound_options);
                        return p;
                    })
        .def("moved", &move_plan)
        .def("json", &format_plan_json)
        .def("same",
             [](const plan_handle& a, const plan_handle& b) {
                 return a.plan() == b.plan() && a.placed().anchor == b.placed().anchor;
             })
        .def("sounds_like", [](const plan_handle& a, const plan_handle& b) { return a.plan() == b.plan(); })
        .def_property_readonly("recipe", &plan_recipe)
        .def_property_readonly("array", [](const plan_handle& p) { return p.on; })
        .def_property_readonly("stroke", [](const plan_handle& p) { return p.drawn(); })
        .def_property_readonly("algorithm", member(&tactor::plan::algorithm))
        .def_property_readonly("phantom", member(&tactor::plan::phantom))
        .def_property_readonly("faces", member(&tactor::plan::faces))
        .def_property_readonly("overlap", member(&tactor::plan::overlap))
        .def_property_readonly("start_s", [](const plan_handle& p) { return p.placed().start_s; })
        .def_property_readonly("stroke_duration_s", member(&tactor::plan::stroke_duration_s))
        .def_property_readonly("stroke_length_mm", member(&tactor::plan::stroke_length_mm))
        .def_property_readonly("carrier_hz", member(&tactor::plan::carrier_hz))
        .def_property_readonly("soa_s", member(&tactor::plan::soa_s))
        .def_property_readonly("total_s", member(&tactor::plan::total_s))
        .def_property_readonly("warnings", member(&tactor::plan::warnings))
        .def_property_readonly("conflicts", member(&tactor::plan::conflicts))
        .def_property_readonly("dropped", member(&tactor::plan::dropped))
        .def_property_readonly("size", [](const plan_handle& p) { return p.plan().bursts.size(); })
        .def_readonly("sound_options", &plan_handle::sound_options)
        .def_property_readonly("continuous", [](const plan_handle& p) { return p.plan().curve.has_value(); })
        .def_property_readonly("onsets", &column<&burst::onset_s>)
        .def_property_readonly("durations", &column<&burst::duration_s>)
        .def_property_readonly("intensities", &column<&burst::intensity>)
        .def_property_readonly("positions", &positions)
        .def("taus", &taus)
        .def("amplitudes", &amplitudes)
        .def("rows", member(&tactor::plan::bursts))
        .def("samples", &samples)
        .def("felt", &percept_columns)
        .def("summary", &summary);
}

} // namespace tactor::python
