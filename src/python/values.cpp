// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/trajectory/impl.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "files/output_file.hpp"
#include "files/setup_text.hpp"
#include "files/text_file.hpp"
#include "options/settle.hpp"
#include "python/binding.hpp"
#include "python/options.hpp"

namespace tactor::python {
namespace {

using tactor_row =
    std::tuple<double, double, unsigned, double, double, std::optional<double>, int, std::string,
               std::vector<std::pair<double, double>>, std::optional<double>, std::optional<double>>;

// Place of an array on the body: site, up, place, turn_deg, body_mm.
using worn_row = std::tuple<std::string, std::string, std::optional<std::pair<double, double>>,
                            std::optional<double>, std::optional<double>>;

array_handle make_array(const std::string& name, const std::vector<tactor_row>& rows, const worn_row& worn)
{
    array a;
    a.name = name;
    std::optional<std::pair<double, double>> place;
    std::tie(a.site, a.up, place, a.turn_deg, a.body_mm) = worn;
    if (place)
        a.place = point{place->first, place->second};
    for (const auto& [x, y, channel, gain, most, threshold, polarity, actuator, thresholds, rise_s, um] :
         rows) {
        a.tactors.push_back(
            {{x, y}, channel, gain, most, threshold, polarity, from_string<actuator_kind>(actuator)});
        for (const auto& [hz, dbfs] : thresholds)
            a.tactors.back().thresholds.push_back({hz, dbfs});
        a.tactors.back().rise_s = rise_s;
        a.tactors.back().displacement_um_at_0dbfs = um;
    }
    return array_handle(std::move(a));
}

std::vector<tactor_row> list_rows(const array_handle& h)
{
    std::vector<tactor_row> rows;
    for (const tactor_spec& t : h.value().tactors) {
        std::vector<std::pair<double, double>> thresholds;
        for (const threshold_point& p : t.thresholds)
            thresholds.emplace_back(p.hz, p.dbfs);
        rows.emplace_back(t.position.x_mm, t.position.y_mm, t.channel, t.gain_db, t.max_dbfs,
                          t.threshold_dbfs, t.polarity, to_string(t.actuator), std::move(thresholds),
                          t.rise_s, t.displacement_um_at_0dbfs);
    }
    return rows;
}

using numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Makes a value of each row of an array.
template <class Make>
auto read_rows(const numbers& a, Make make)
{
    std::vector<decltype(make(a.data()))> rows;
    for (py::ssize_t i = 0; i < a.shape(0); ++i)
        rows.push_back(make(a.data(i)));
    return rows;
}

py::tuple pair(point p)
{
    return py::make_tuple(p.x_mm, p.y_mm);
}

// Returns the place that `find` gives for each number, as an (n, 2) array.
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

// Writes a file whole or not at all.
void write_text(const std::string& file, const std::string& text)
{
    const without_lock free;
    detail::output_file out(file, {}, detail::owner_kind::caller);
    out.write(text.data(), static_cast<std::int64_t>(text.size()));
    out.commit();
}

std::string read_text(const std::string& file)
{
    constexpr std::size_t most = std::size_t{1} << 30;
    const without_lock free;
    return std::string(std::string_view(detail::read_text_file(file, most)));
}

setup checked(setup s)
{
    static_cast<void>(options::read_defaults(s));
    return s;
}

void bind_array(py::module_& m)
{
    m.def("read_text", &read_text);
    m.def("write_text", &write_text);
    py::class_<array_handle, std::shared_ptr<array_handle>>(m, "Array")
        .def(py::init(&make_array))
        .def_static("preset", [](const std::string& name) { return array_handle(preset_array(name)); })
        .def_static("grid",
                    [](std::string name, unsigned rows, unsigned columns, double x, double y) {
                        return array_handle(make_grid(std::move(name), rows, columns, x, y));
                    })
        .def_property_readonly("name", [](const array_handle& h) { return h.value().name; })
        .def_property_readonly("site", [](const array_handle& h) { return h.value().site; })
        .def_property_readonly("up", [](const array_handle& h) { return h.value().up; })
        .def_property_readonly("place",
                               [](const array_handle& h) {
                                   const std::optional<point>& p = h.value().place;
                                   return p ? py::object(pair(*p)) : py::object(py::none());
                               })
        .def_property_readonly("turn_deg", [](const array_handle& h) { return h.value().turn_deg; })
        .def_property_readonly("body_mm", [](const array_handle& h) { return h.value().body_mm; })
        .def_property_readonly("channels", [](const array_handle& h) { return h.value().channels(); })
        .def_property_readonly("rows", &list_rows)
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
            return pair(h.faces().nearest({x, y}));
        });
    m.def("array_presets", [] { return array_presets(); });

    py::class_<setup>(m, "Setup")
        .def_static("load", [](const std::string& file) { return checked(load_setup(file)); })
        .def_static("parse", [](const std::string& text) { return checked(parse_setup(text, "array")); })
        .def("besides", [](const setup& s) { return detail::besides_text(s); })
        .def("origin",
             [](const setup& s) {
                 return s.calibration ? detail::origin_text(*s.calibration) : std::string();
             })
        .def_property_readonly("array", [](const setup& s) -> std::optional<array_handle> {
            return s.array ? std::optional<array_handle>(std::in_place, *s.array) : std::nullopt;
        });
}

void bind_path(py::module_& m)
{
    py::class_<path>(m, "Path")
        .def_static("svg", [](const std::string& data) { return path::from_svg(data); })
        .def_static(
            "polyline",
            [](const numbers& a) {
                return path::polyline(read_rows(a, [](const double* r) { return point{r[0], r[1]}; }));
            })
        .def_static("arc",
                    [](double x, double y, double radius, double from, double sweep) {
                        return path::arc({x, y}, radius, from, sweep);
                    })
        .def_static("from_state", [](const py::bytes& b) { return read_path(std::string(b)); })
        .def("state", [](const path& p) { return py::bytes(write_state(p)); })
        .def_property_readonly("data", &path::svg)
        .def_property_readonly("length_mm", &path::length_mm)
        .def("at", [](const path& p, double s) { return pair(p.at(s)); })
        .def("at_all",
             [](const path& p, const numbers& all) { return places(all, [&](double s) { return p.at(s); }); })
        .def("meets_x", &path::meets_x)
        .def("meets_y", &path::meets_y);
}

stroke timed(const std::string& name, const numbers& rows, double intensity_max)
{
    detail::recorded_points recorded(intensity_max);
    for (const timed_point& p : read_rows(rows, [](const double* r) {
             return timed_point{r[0], {r[1], r[2]}, r[3]};
         }))
        recorded.add(p);
    const trajectory motion = trajectory::timed(recorded.take());
    return {.name = name, .motion = motion, .warnings = recorded.warnings()};
}

stroke along(const std::string& name, const path& p, std::optional<double> duration_s,
             std::optional<double> speed_mm_s, double intensity)
{
    const double speed = speed_mm_s.value_or(default_speed_mm_s);
    if (!duration_s && !(speed > 0.0 && std::isfinite(speed)))
        throw error(error_kind::bad_input, "speed", "it is not above 0", "give mm/s");
    stroke s{name, trajectory::along(p, duration_s.value_or(p.length_mm() / speed), intensity)};
    if (!duration_s)
        s.speed_mm_s = speed;
    s.usual_pace = !duration_s && !speed_mm_s;
    return s;
}

// Writes TOML; a preset by its name, which keeps its note.
std::string stroke_toml(const stroke& s)
{
    for (const std::string& name : stroke_presets())
        if (name == s.name && write_state(preset_stroke(name)) == write_state(s))
            return "[stroke]\npreset = " + detail::toml_string(name) + "\n";
    return detail::stroke_text(s);
}

std::vector<profile_point> read_profile(const numbers& rows)
{
    return read_rows(rows, [](const double* r) { return profile_point{r[0], r[1]}; });
}

// Tables of two columns, of the rests of three; those of speed and intensity without rows: even.
stroke moving(const std::string& name, const path& p, std::optional<double> duration_s,
              std::optional<double> speed_mm_s, double intensity, const std::string& easing,
              const numbers& speeds, const numbers& intensities, const numbers& rests)
{
    movement m{duration_s, from_string<easing_kind>(easing), read_profile(speeds), read_profile(intensities),
               read_rows(rests, [](const double* r) {
                   return rest{r[0], r[1], r[2]};
               })};
    double resting_s = 0.0;
    for (const rest& r : m.rests)
        resting_s += r.time_s;
    const bool usual = !duration_s && !speed_mm_s && m.speed_mm_s.empty();
    if (m.speed_mm_s.empty() && speed_mm_s)
        m.speed_mm_s = {{0.0, *speed_mm_s}};
    stroke s{name, trajectory::along(p, m, intensity)};
    if (!duration_s)
        s.speed_mm_s = p.length_mm() / (s.motion.duration_s() - resting_s);
    s.usual_pace = usual;
    return s;
}

// Returns a stroke's options by the names of plan()'s.
py::dict choices_dict(const stroke& s)
{
    py::dict d;
    if (s.choices.algorithm)
        d["algorithm"] = std::string(to_string(*s.choices.algorithm));
    if (s.choices.phantom)
        d["phantom"] = std::string(to_string(*s.choices.phantom));
    if (s.choices.faces)
        d["faces"] = std::string(to_string(*s.choices.faces));
    if (s.choices.soa_s)
        d["soa"] = *s.choices.soa_s;
    if (s.choices.burst_s)
        d["burst"] = *s.choices.burst_s;
    return d;
}

void bind_stroke(py::module_& m)
{
    py::class_<stroke>(m, "Stroke")
        .def_static("along", &along)
        .def_static("moving", &moving)
        .def_static("timed", &timed)
        .def_static("preset", [](const std::string& name) { return preset_stroke(name); })
        .def_static("shape", [](const std::string& name) { return shape_stroke(name); })
        .def_static("load", [](const std::string& file,
                               double intensity_max) { return load_strokes(file, intensity_max); })
        .def_static("parse", [](const std::string& text, const std::string& name,
                                double intensity_max) { return parse_strokes(text, name, intensity_max); })
        .def_static("from_state", [](const py::bytes& b) { return read_stroke(std::string(b)); })
        .def("state", [](const stroke& s) { return py::bytes(write_state(s)); })
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
                 s.sound.carrier_profile = detail::from_the_end(s.sound.carrier_profile);
                 return s;
             })
        .def("with_intensity",
             [](stroke s, double factor) {
                 s.motion = s.motion.with_intensity(factor);
                 return s;
             })
        .def_readonly("name", &stroke::name)
        .def_readonly("start_s", &stroke::start_s)
        .def_property_readonly("start_from",
                               [](const stroke& s) { return std::string(to_string(s.anchor.from)); })
        .def_property_readonly("choices", &choices_dict)
        .def_property_readonly("carrier_hz", [](const stroke& s) { return s.sound.carrier_hz; })
        .def_property_readonly("level_db", [](const stroke& s) { return s.choices.level_db; })
        .def_readonly("speed_mm_s", &stroke::speed_mm_s)
        .def_readonly("warnings", &stroke::warnings)
        .def_property_readonly("note", [](const stroke& s) { return std::string(to_string(s.note)); })
        .def_property_readonly("duration_s", [](const stroke& s) { return s.motion.duration_s(); })
        .def_property_readonly("length_mm", [](const stroke& s) { return s.motion.length_mm(); })
        .def("position", [](const stroke& s, double t) { return pair(s.motion.position(t)); })
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
    m.def("stroke_presets", [] { return stroke_presets(); });
    m.def("stroke_shapes", [] { return stroke_shapes(); });
    m.def("fit_strokes", [](const std::vector<stroke>& strokes, const array_handle& on, double margin_mm) {
        const fitted_strokes f = fit_strokes(strokes, on.faces(), margin_mm);
        return py::make_tuple(f.strokes, pair(f.placed.from), pair(f.placed.to), f.placed.scale);
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
