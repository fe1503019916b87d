// Binds arrays, paths and strokes. Paths and strokes can also be converted to bytes, which are needed to
// pickle and compare them. The bytes contain their members in MessagePack, which keeps numbers exact.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"
#include "files/output_file.hpp"
#include "files/plan/plan_json.hpp"
#include "files/setup_text.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"
#include "options/resolve.hpp"
#include "options/serve.hpp"
#include "python/binding.hpp"
#include "session/stroke_text.hpp"

template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
    static void to_json(json& j, const std::optional<T>& v) { j = v ? json(*v) : json(); }
    static void from_json(const json& j, std::optional<T>& v)
    {
        v = j.is_null() ? std::nullopt : std::optional(j.get<T>());
    }
};

namespace tactor {
inline namespace v0 {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(point, x_mm, y_mm)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(profile_point, part, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(rest, part, time_s, intensity)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(movement, easing, speed_mm_s, intensity, rests)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(timed_value, t_s, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(emphasis, t_s, amplitude, frequency)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(actuator_numbers, gain, ducking, low_hz, high_hz, emphasis_gain, fade_out,
                                   emphasis_low_hz, emphasis_high_hz, emphasis_low_s, emphasis_high_s,
                                   emphasis_low_wave, emphasis_high_wave)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(vibration, duration_s, amplitude, frequency, emphases, actuator,
                                   own_actuator, notes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(recording, file, rate_hz, samples, sha256, missing, source)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(modulation, hz, depth)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(carrier_part, part, hz)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(carrier_time, t_s, hz)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_choices, algorithm, phantom, faces, soa_s, burst_s, level_db)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_fit, margin_mm, group, unit_square)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(start_anchor, from, back)

} // namespace v0

namespace detail {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(cubic, p)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(elliptic, centre, u, v, from, sweep)

inline void to_json(nlohmann::json& j, const shape& s)
{
    std::visit([&j](const auto& form) { j = form; }, s);
}

inline void from_json(const nlohmann::json& j, shape& s)
{
    s = j.contains("centre") ? shape(j.get<elliptic>()) : shape(j.get<cubic>());
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(outline::curve, segment, form)

// Returns the list as raw bytes. In JSON, a million points would take ten times as many bytes.
template <class T>
nlohmann::json pack(const std::vector<T>& list)
{
    std::vector<std::uint8_t> bytes(list.size() * sizeof(T));
    std::memcpy(bytes.data(), list.data(), bytes.size());
    return nlohmann::json::binary(std::move(bytes));
}

template <class T>
std::vector<T> unpack(const nlohmann::json& packed)
{
    const auto& bytes = packed.get_binary();
    std::vector<T> list(bytes.size() / sizeof(T));
    std::memcpy(list.data(), bytes.data(), list.size() * sizeof(T));
    return list;
}

} // namespace detail
} // namespace tactor

template <>
struct nlohmann::adl_serializer<std::shared_ptr<const tactor::recording>> {
    using pointer = std::shared_ptr<const tactor::recording>;

    static void to_json(json& j, const pointer& p) { j = p != nullptr ? json(*p) : json(); }
    static void from_json(const json& j, pointer& p)
    {
        p = j.is_null() ? nullptr : std::make_shared<const tactor::recording>(j.get<tactor::recording>());
    }
};

template <>
struct nlohmann::adl_serializer<tactor::path> {
    static void to_json(json& j, const tactor::path& p)
    {
        const tactor::path::impl& i = tactor::detail::access::of(p);
        std::vector<tactor::detail::outline::curve> curves;
        for (const auto& c : i.curves)
            curves.push_back({c.segment, c.form});
        j = {{"vertices", tactor::detail::pack(i.vertices)}, {"curves", curves}};
    }
    static tactor::path from_json(const json& j)
    {
        tactor::detail::outline o{tactor::detail::unpack<tactor::point>(j.at("vertices")), {}};
        j.at("curves").get_to(o.curves);
        return tactor::detail::make_path(std::move(o), "pickle");
    }
};

namespace tactor {
inline namespace v0 {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(waveform, kind, low_hz, high_hz, seed, recorded, texture, texture_mm)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_sound, carrier_hz, carrier_profile, carrier_times, wave, am)

inline void to_json(nlohmann::json& j, const trajectory& t)
{
    const trajectory::impl& i = detail::access::of(t);
    j = {{"duration_s", i.duration_s}, {"gain", i.gain}};
    if (const auto* timed = std::get_if<detail::timed_points>(&i.law)) {
        j["points"] = detail::pack(*timed->points);
        j["length_mm"] = timed->length_mm;
        return;
    }
    const auto& drawn = std::get<detail::drawn_path>(i.law);
    j["path"] = drawn.way;
    j["intensity"] = drawn.intensity;
    if (drawn.moves != nullptr) {
        j["moves"] = drawn.moves->definition();
        j["moving_s"] = drawn.moves->moving_s();
    }
}

inline decltype(trajectory::impl::law) read_law(const nlohmann::json& j)
{
    if (j.contains("points"))
        return detail::timed_points{
            std::make_shared<const std::vector<timed_point>>(detail::unpack<timed_point>(j.at("points"))),
            j.at("length_mm").get<double>()};
    detail::drawn_path drawn{j.at("path").get<path>(), j.at("intensity").get<double>()};
    if (j.contains("moves"))
        drawn.moves = std::make_shared<const detail::pace>(j.at("moves").get<movement>(),
                                                           j.at("moving_s").get<double>());
    return drawn;
}

inline void from_json(const nlohmann::json& j, trajectory& t)
{
    t = detail::access::make<trajectory>(std::make_shared<const trajectory::impl>(
        trajectory::impl{read_law(j), j.at("duration_s").get<double>(), j.at("gain").get<double>()}));
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke, name, motion, start_s, anchor, speed_mm_s, usual_pace, fit, sound,
                                   choices, note, warnings)

} // namespace v0
} // namespace tactor

namespace tactor::python {
namespace {

using namespace py::literals;

template <class T>
py::bytes pack_state(const T& value)
{
    std::string state;
    nlohmann::json::to_msgpack(value, state);
    return state;
}

// Returns a value from bytes that pack_state() returned.
// \throws error (bad_input) for other bytes.
template <class T>
T unpack_state(const py::bytes& state)
try {
    const std::string_view bytes = state;
    return nlohmann::json::from_msgpack(bytes.begin(), bytes.end()).template get<T>();
} catch (const nlohmann::json::exception&) {
    throw error(error_kind::bad_input, "pickle", "its bytes are not a path or stroke of this version",
                "make it again with this version of tactor");
}

// Returns a property that reads a member of an array.
template <class T>
auto member(T array::*m)
{
    return [m](const array_handle& h) -> const T& { return h.value().*m; };
}

using numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Calls `make` with each row of a NumPy array, and returns the results.
template <class Make>
auto read_rows(const numbers& a, Make make)
{
    std::vector<decltype(make(a.data()))> rows;
    for (py::ssize_t i = 0; i < a.shape(0); ++i)
        rows.push_back(make(a.data(i)));
    return rows;
}

// Returns an (n, 2) array with the place find(x) for each number x.
template <class F>
py::array_t<double> places(const numbers& all, F&& find)
{
    std::vector<double> out;
    for (py::ssize_t i = 0; i < all.size(); ++i) {
        const point p = find(all.data()[i]);
        out.insert(out.end(), {p.x_mm, p.y_mm});
    }
    return to_numpy(std::move(out), 2);
}

void write_toml(const std::string& file, const std::string& text, bool force)
{
    const without_lock free;
    detail::write_text(file, text, {"# ", ""}, force, detail::owner_kind::caller);
}

void write_plan(const std::string& file, const std::string& text, bool force)
{
    const without_lock free;
    files::save_plans(text, file, force, detail::owner_kind::caller);
}

std::vector<std::string> save_strokes(std::vector<stroke> strokes, const std::string& file, bool force)
{
    const without_lock free;
    session::replace_unsupported_starts(strokes, session::find_output_format(file), session::path_starts_s);
    return session::save_strokes(strokes, file, force, nullptr, detail::owner_kind::caller);
}

// Returns bytes, because the reader of the text says where it is not valid UTF-8.
py::bytes read_text(const std::string& file)
{
    constexpr std::size_t most = std::size_t{1} << 30;
    const detail::whole_text text = [&] {
        const without_lock free;
        return detail::read_text_file(file, most);
    }();
    const std::string_view bytes = text;
    return py::bytes(bytes.data(), bytes.size());
}

setup require_valid(setup s)
{
    static_cast<void>(options::read_defaults(s));
    static_cast<void>(options::read_serve(s.serve));
    return s;
}

void bind_array(py::module_& m)
{
    m.def("read_text", &read_text);
    m.def("write_plan", &write_plan);
    m.def("write_toml", &write_toml);
    py::class_<array_handle, std::shared_ptr<array_handle>>(m, "Array")
        .def(py::init<array>())
        .def_static("preset", [](const std::string& name) { return array_handle(preset_array(name)); })
        .def_static("grid",
                    [](std::string name, unsigned rows, unsigned columns, double x, double y) {
                        return array_handle(make_grid(std::move(name), rows, columns, x, y));
                    })
        .def_property_readonly("name", member(&array::name))
        .def_property_readonly("site", member(&array::site))
        .def_property_readonly("up", member(&array::up))
        .def_property_readonly("place", member(&array::place))
        .def_property_readonly("turn_deg", member(&array::turn_deg))
        .def_property_readonly("body_mm", member(&array::body_mm))
        .def_property_readonly("channels", [](const array_handle& h) { return h.value().channels(); })
        .def_property_readonly("rows", member(&array::tactors))
        .def("text", [](const array_handle& h) { return detail::array_text(h.value()); })
        .def_property_readonly("positions",
                               [](const py::object& self) {
                                   const auto& t = self.cast<const array_handle&>().value().tactors;
                                   constexpr auto bytes = static_cast<py::ssize_t>(sizeof(double));
                                   return make_view({static_cast<py::ssize_t>(t.size()), 2},
                                                    {sizeof(tactor_spec), bytes}, &t.front().position.x_mm,
                                                    self);
                               })
        .def_property_readonly("faces", [](const array_handle& h) { return h.faces().faces(); })
        .def_property_readonly("pitch_mm", [](const array_handle& h) { return h.faces().pitch_mm(); })
        .def_property_readonly(
            "grid_lines",
            [](const array_handle& h) -> std::optional<std::pair<std::vector<double>, std::vector<double>>> {
                if (auto g = find_grid(h.value()))
                    return std::pair(std::move(g->x_mm), std::move(g->y_mm));
                return {};
            })
        .def("contains",
             [](const array_handle& h, double x, double y) {
                 return h.faces().contains({x, y});
             })
        .def("nearest", [](const array_handle& h, double x, double y) {
            return h.faces().nearest({x, y});
        });
    m.def("array_presets", &array_presets);

    py::class_<setup>(m, "Setup")
        .def_static("load", [](const std::string& file) { return require_valid(load_setup(file)); })
        .def_static("parse",
                    [](const std::string& text) { return require_valid(parse_setup(text, "array")); })
        .def("besides", [](const setup& s) { return detail::format_settings(s); })
        .def("origin",
             [](const setup& s) {
                 return s.calibration ? detail::format_calibration(*s.calibration) : std::string();
             })
        .def_property_readonly("array", [](const setup& s) -> std::optional<array_handle> {
            return s.array ? std::optional<array_handle>(std::in_place, *s.array) : std::nullopt;
        });
}

void bind_path(py::module_& m)
{
    py::class_<path>(m, "Path")
        .def_static("svg", &path::from_svg)
        .def_static(
            "polyline",
            [](const numbers& a) {
                return path::polyline(read_rows(a, [](const double* r) { return point{r[0], r[1]}; }));
            })
        .def_static("arc",
                    [](double x, double y, double radius, double from, double sweep) {
                        return path::arc({x, y}, radius, from, sweep);
                    })
        .def_static("from_state", &unpack_state<path>)
        .def("state", &pack_state<path>)
        .def_property_readonly("data", &path::svg)
        .def_property_readonly("length_mm", &path::length_mm)
        .def("at", &path::at)
        .def("at_all",
             [](const path& p, const numbers& all) { return places(all, [&](double s) { return p.at(s); }); })
        .def("meets_x", &path::meets_x)
        .def("meets_y", &path::meets_y);
}

stroke timed(const std::string& name, const numbers& rows, double intensity_max)
{
    const std::vector<timed_point> points = read_rows(rows, [](const double* r) {
        return timed_point{r[0], {r[1], r[2]}, r[3]};
    });
    return session::points_stroke(name, points, intensity_max);
}

// Returns a stroke as TOML. A preset is written by its name, which keeps its note.
std::string stroke_toml(const stroke& s)
{
    for (const std::string& name : stroke_presets())
        if (name == s.name && pack_state(preset_stroke(name)).equal(pack_state(s)))
            return "[stroke]\npreset = " + detail::toml_string(name) + "\n";
    return detail::stroke_text(s);
}

// Makes a stroke along a path. If `speeds` or `intensities` is empty, the speed or intensity is constant.
stroke along(const std::string& name, const path& p, std::optional<double> duration_s,
             std::optional<double> speed_mm_s, double intensity, easing_kind easing,
             std::vector<profile_point> speeds, std::vector<profile_point> intensities,
             std::vector<rest> rests)
{
    movement m{duration_s, easing, std::move(speeds), std::move(intensities), std::move(rests)};
    stroke s{.name = name, .usual_pace = !duration_s && !speed_mm_s && m.speed_mm_s.empty()};
    const bool even =
        easing == easing_kind::linear && m.speed_mm_s.empty() && m.intensity.empty() && m.rests.empty();
    if (even && !duration_s) {
        s.speed_mm_s = speed_mm_s.value_or(default_speed_mm_s);
        if (!(*s.speed_mm_s > 0.0 && std::isfinite(*s.speed_mm_s)))
            throw error(error_kind::bad_input, "speed", "it is not above 0", "give mm/s");
        m.duration_s = p.length_mm() / *s.speed_mm_s;
    } else if (speed_mm_s) {
        m.speed_mm_s = {{0.0, *speed_mm_s}};
    }
    s.motion = trajectory::along(p, m, intensity);
    if (!m.duration_s) {
        double resting_s = 0.0;
        for (const rest& r : m.rests)
            resting_s += r.time_s;
        s.speed_mm_s = p.length_mm() / (s.motion.duration_s() - resting_s);
    }
    return s;
}

// Returns the options of a stroke. The keys are names of plan()'s arguments.
py::dict choices_dict(const stroke& s)
{
    py::dict d;
    const auto add = [&d](const char* name, const auto& choice) {
        if (choice)
            d[name] = *choice;
    };
    add("algorithm", s.choices.algorithm);
    add("phantom", s.choices.phantom);
    add("faces", s.choices.faces);
    add("soa", s.choices.soa_s);
    add("burst", s.choices.burst_s);
    return d;
}

// Returns the formats of stroke files. src/options/write.py and tests use them.
py::list list_formats()
{
    py::list rows;
    for (const detail::stroke_format* f : detail::stroke_formats()) {
        py::list extensions;
        for (const std::string_view e : f->extensions)
            extensions.append(e);
        rows.append(py::dict("name"_a = f->name, "title"_a = f->title, "extensions"_a = extensions,
                             "media_type"_a = f->media_type, "written"_a = f->write != nullptr));
    }
    return rows;
}

void bind_stroke(py::module_& m)
{
    m.def("stroke_formats", &list_formats);
    m.def("save_strokes", &save_strokes);
    py::class_<stroke>(m, "Stroke")
        .def_static("along", &along)
        .def_static("timed", &timed)
        .def_static("preset", &preset_stroke)
        .def_static("shape", &shape_stroke)
        .def_static("load",
                    [](const std::string& file, double intensity_max, const std::string& position,
                       const setup* with) {
                        return detail::load_stroke_file(file, intensity_max, position,
                                                        with != nullptr && with->texture ? &*with->texture
                                                                                         : nullptr);
                    })
        .def_static("parse", &parse_strokes)
        .def_static("from_state", &unpack_state<stroke>)
        .def("state", &pack_state<stroke>)
        .def("same_as",
             [](stroke s, const std::string& name, std::optional<double> start_s,
                std::optional<double> carrier_hz) {
                 s.name = name;
                 s.start_s = start_s;
                 s.sound.carrier_hz = carrier_hz;
                 return s;
             })
        .def("with_duration",
             [](stroke s, double duration_s) {
                 s.motion = s.motion.with_duration(duration_s);
                 s.speed_mm_s.reset();
                 s.usual_pace = false;
                 return s;
             })
        .def("with_speed",
             [](stroke s, double speed_mm_s) {
                 s.motion = s.motion.with_speed(speed_mm_s);
                 s.speed_mm_s = speed_mm_s;
                 s.usual_pace = false;
                 return s;
             })
        .def("reversed",
             [](stroke s) {
                 s.motion = s.motion.reversed();
                 s.sound = detail::reverse_sound(std::move(s.sound), s.motion.duration_s());
                 return s;
             })
        .def("with_intensity",
             [](stroke s, double factor) {
                 s.motion = s.motion.with_intensity(factor);
                 return s;
             })
        .def_readonly("name", &stroke::name)
        .def_readonly("start_s", &stroke::start_s)
        .def_property_readonly("start_from", [](const stroke& s) { return s.anchor.from; })
        .def_property_readonly("choices", &choices_dict)
        .def_property_readonly("carrier_hz", [](const stroke& s) { return s.sound.carrier_hz; })
        .def_property_readonly("level_db", [](const stroke& s) { return s.choices.level_db; })
        .def_readonly("speed_mm_s", &stroke::speed_mm_s)
        .def_readonly("warnings", &stroke::warnings)
        .def_readonly("note", &stroke::note)
        .def_property_readonly("duration_s", [](const stroke& s) { return s.motion.duration_s(); })
        .def_property_readonly("length_mm", [](const stroke& s) { return s.motion.length_mm(); })
        .def("position", [](const stroke& s, double t) { return s.motion.position(t); })
        .def("intensity", [](const stroke& s, double t) { return s.motion.intensity(t); })
        .def("positions",
             [](const stroke& s, const numbers& all) {
                 return places(all, [&](double t) { return s.motion.position(t); });
             })
        .def("intensities",
             [](const stroke& s, const numbers& t) {
                 std::vector<double> out;
                 for (py::ssize_t i = 0; i < t.size(); ++i)
                     out.push_back(s.motion.intensity(t.data()[i]));
                 return to_numpy(std::move(out));
             })
        .def("text", &stroke_toml)
        .def("meets_x", [](const stroke& s, double x) { return s.motion.meets_x(x); })
        .def("meets_y", [](const stroke& s, double y) { return s.motion.meets_y(y); });
    m.def("stroke_presets", &stroke_presets);
    m.def("stroke_shapes", &stroke_shapes);
    m.def("fit_strokes", [](const std::vector<stroke>& strokes, const array_handle& on, double margin_mm) {
        const fitted_strokes f = fit_strokes(strokes, on.faces(), margin_mm);
        return py::make_tuple(f.strokes, f.placed.from, f.placed.to, f.placed.scale);
    });
    m.def("apply_fits", [](const std::vector<stroke>& strokes, const array_handle& on) {
        return apply_fits(strokes, on.faces());
    });
}

} // namespace

void bind_values(py::module_& m)
{
    bind_array(m);
    bind_path(m);
    bind_stroke(m);
}

} // namespace tactor::python
