// SPDX-License-Identifier: MIT
#include "python/options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/kind_names.hpp"
#include "core/option_bounds.hpp"
#include "core/words.hpp"

namespace tactor::python {
namespace {

namespace of = detail::option_bounds;

[[noreturn]] void refuse(const std::string& name, const std::string& why, const std::string& hint = {})
{
    throw error(error_kind::bad_input, name, why, hint).with_field(name);
}

std::string shown(py::handle v)
{
    try {
        return py::module_::import("tactor._checks").attr("_shown")(v).cast<std::string>();
    } catch (py::error_already_set&) { // its repr() failed
        return "that";
    }
}

// No complex number and no time of NumPy's, which would lose a part of what they say.
bool is_plain(py::handle v)
{
    return py::module_::import("tactor._checks").attr("_is_plain")(v).cast<bool>();
}

double number(const std::string& name, py::handle v, detail::bounds b)
{
    const std::string range = fmt::format("{} to {}", plain_number(b.low), plain_number(b.high));
    if (!is_plain(v))
        refuse(name, fmt::format("{} is not a number", shown(v)), range);
    double d = PyFloat_AsDouble(v.ptr());
    bool is_one = !py::isinstance<py::bool_>(v);
    if (PyErr_Occurred() != nullptr) {
        is_one = PyErr_ExceptionMatches(PyExc_OverflowError) != 0; // a whole number that no double holds
        PyErr_Clear();
        d = HUGE_VAL;
    }
    if (!is_one)
        refuse(name, fmt::format("{} is not a number", shown(v)), range);
    const bool is_rounded = PyLong_Check(v.ptr()) && !py::float_(d).equal(v);
    if (!(d >= b.low && d <= b.high) || is_rounded)
        refuse(name, fmt::format("{} is out of range", shown(v)), range);
    return d;
}

double whole(const std::string& name, py::handle v, detail::bounds b)
{
    const double d = number(name, v, b);
    if (d != std::floor(d))
        refuse(name, fmt::format("{} is not a whole number", shown(v)));
    return d;
}

bool truth(const std::string& name, py::handle v)
{
    const int t = PyObject_IsTrue(v.ptr());
    const bool is_one = py::isinstance<py::bool_>(v) || py::hasattr(v, "dtype");
    if (!is_one || t < 0) {
        PyErr_Clear();
        refuse(name, fmt::format("{} is neither True nor False", shown(v)));
    }
    return t != 0;
}

bool compensation(const std::string& name, py::handle v)
{
    const std::string said = py::isinstance<py::str>(v) ? v.cast<std::string>() : "";
    if (said != "none" && said != "low-speed")
        refuse(name, fmt::format("{} is not known", shown(v)), "one of none, low-speed");
    return said != "none";
}

template <class Enum>
Enum one_of(const std::string& name, py::handle v)
{
    if (py::isinstance<py::str>(v))
        if (const auto e = detail::kind_named<Enum>(v.cast<std::string>()))
            return *e;
    refuse(name, fmt::format("{} is not known", shown(v)),
           fmt::format("one of {}", fmt::join(detail::names_of<Enum>(), ", ")));
}

std::string text(const std::string& name, py::handle v)
{
    if (!py::isinstance<py::str>(v))
        refuse(name, fmt::format("{} is no text", shown(v)), "");
    auto said = v.cast<std::string>();
    if (said.find('\0') != std::string::npos)
        refuse(name, fmt::format("{} has a zero byte in it", shown(v)), "");
    return said;
}

// Seed and texture are options of their own.
void take_waveform(waveform& into, const std::string& said)
{
    const waveform w = parse_waveform(said);
    into.kind = w.kind;
    into.low_hz = w.low_hz;
    into.high_hz = w.high_hz;
    into.recorded = w.recorded;
}

// HZ, "HZ" or "HZ:DEPTH".
modulation modulation_of(const std::string& name, py::handle v)
{
    return parse_modulation(py::isinstance<py::str>(v) ? v.cast<std::string>()
                                                       : fmt::format("{}", number(name, v, {0, 20000})));
}

using setter = std::function<void(wishes&, const std::string&, py::handle)>;

setter numbers(detail::bounds b, void (*set)(wishes&, double))
{
    return [=](wishes& w, const std::string& name, py::handle v) { set(w, number(name, v, b)); };
}

setter counts(detail::bounds b, void (*set)(wishes&, double))
{
    return [=](wishes& w, const std::string& name, py::handle v) { set(w, whole(name, v, b)); };
}

drive_limits& limits(wishes& w)
{
    if (!w.sound.limits)
        w.sound.limits.emplace();
    return *w.sound.limits;
}

std::map<std::string, setter> planning()
{
    using W = wishes&;
    return {
        {"algorithm", [](W w, auto& n, py::handle v) { w.plan.algorithm = one_of<algorithm_kind>(n, v); }},
        {"faces", [](W w, auto& n, py::handle v) { w.plan.faces = one_of<faces_kind>(n, v); }},
        {"soa", numbers({-1e9, 1e9}, [](W w, double d) { w.plan.soa_s = d; })},
        {"burst", numbers(of::burst, [](W w, double d) { w.plan.burst_s = d; })},
        {"slope", numbers(of::slope, [](W w, double d) { w.slope = d; })},
        {"intercept", numbers(of::intercept, [](W w, double d) { w.intercept_s = d; })},
        {"duration", numbers({0.001, 86400}, [](W w, double d) { w.duration_s = d; })},
        {"speed", numbers(of::speed, [](W w, double d) { w.speed_mm_s = d; })},
        {"usual_speed", numbers(of::speed, [](W w, double d) { w.usual_speed_mm_s = d; })},
        {"timing", [](W w, auto& n, py::handle v) { w.plan.timing = one_of<timing_kind>(n, v); }},
        {"outside", [](W w, auto& n, py::handle v) { w.plan.outside = one_of<outside_kind>(n, v); }},
        {"fit", [](W w, auto& n, py::handle v) { w.fit = truth(n, v); }},
        {"fit_margin", numbers({0, 1e6}, [](W w, double d) { w.fit_margin_mm = d; })},
        {"snap", [](W w, auto& n, py::handle v) { w.plan.snap = truth(n, v); }},
        {"drop_points", [](W w, auto& n, py::handle v) { w.plan.drop_points = truth(n, v); }},
        {"overlap", [](W w, auto& n, py::handle v) { w.plan.overlap = one_of<overlap_kind>(n, v); }},
        {"compensate", [](W w, auto& n, py::handle v) { w.compensate = compensation(n, v); }},
        {"observer", [](W w, auto& n, py::handle v) { w.observer = one_of<observer_kind>(n, v); }},
        {"sigma_mm",
         numbers({least_sigma_mm, most_sigma_mm}, [](W w, double d) { w.low_speed.sigma_mm = d; })},
        {"sigma_v_mm_s", numbers({least_sigma_v_mm_s, most_sigma_v_mm_s},
                                 [](W w, double d) { w.low_speed.sigma_v_mm_s = d; })},
        {"carrier", numbers(of::carrier, [](W w, double d) { w.plan.carrier_hz = d; })},
        {"waveform", [](W w, auto& n, py::handle v) { take_waveform(w.plan.wave, text(n, v)); }},
        {"am", [](W w, auto& n, py::handle v) { w.plan.am = modulation_of(n, v); }},
        {"noise_seed",
         [](W w, auto& n, py::handle v) {
             w.plan.wave.seed = static_cast<std::uint64_t>(whole(n, v, of::noise_seed));
         }},
        {"texture", [](W w, auto& n, py::handle v) { w.plan.wave.texture = one_of<texture_kind>(n, v); }},
        {"intensity_scale", [](W w, auto& n, py::handle v) { w.plan.scale.kind = one_of<scale_kind>(n, v); }},
        {"stevens_exponent", numbers(of::stevens_exponent, [](W w, double d) { w.plan.scale.exponent = d; })},
        {"texture_mm", numbers(of::texture_mm, [](W w, double d) { w.plan.wave.texture_mm = d; })},
    };
}

std::map<std::string, setter> sounding()
{
    using W = wishes&;
    return {
        {"phase", [](W w, auto& n, py::handle v) { w.sound.phase = one_of<phase_kind>(n, v); }},
        {"ramp", numbers(of::ramp, [](W w, double d) { w.sound.ramp_s = d; })},
        {"envelope", [](W w, auto& n, py::handle v) { w.sound.envelope.kind = one_of<envelope_kind>(n, v); }},
        {"attack", numbers(of::attack, [](W w, double d) { w.sound.envelope.attack_s = d; })},
        {"release", numbers(of::release, [](W w, double d) { w.sound.envelope.release_s = d; })},
        {"tukey_part", numbers({0, 1}, [](W w, double d) { w.sound.envelope.tukey_part = d; })},
        {"level_dbfs", numbers(of::level_dbfs,
                               [](W w, double d) {
                                   w.sound.level_dbfs = d;
                                   w.sound.sl_db.reset();
                               })},
        {"sl", numbers(of::sl, [](W w, double d) { w.sound.sl_db = d; })},
        {"rate", counts(of::rate, [](W w, double d) { w.sound.rate = static_cast<unsigned>(d); })},
        {"channels", counts({1, 16384}, [](W w, double d) { w.sound.channels = static_cast<unsigned>(d); })},
        {"marker_channel",
         counts({0, 16383}, [](W w, double d) { w.sound.marker_channel = static_cast<unsigned>(d); })},
        {"marker_s", numbers({1e-6, 10}, [](W w, double d) { w.sound.marker_s = d; })},
        {"power_dbfs", numbers({-120, 60}, [](W w, double d) { limits(w).power_dbfs = d; })},
        {"max_drive_s", numbers({0.1, 3600}, [](W w, double d) { limits(w).max_drive_s = d; })},
        {"drive_window_s", numbers({0.1, 3600}, [](W w, double d) { limits(w).window_s = d; })},
    };
}

// Of people who differ: a comparison's.
std::map<std::string, setter> spreading()
{
    using W = wishes&;
    return {
        {"spread", counts({2, 100000}, [](W w, double d) { w.spread.people = static_cast<unsigned>(d); })},
        {"spread_seed",
         counts({0, 4294967295.0}, [](W w, double d) { w.spread.seed = static_cast<std::uint64_t>(d); })},
        {"spread_sigma", numbers({1, 100}, [](W w, double d) { w.spread.sigma_factor = d; })},
        {"spread_threshold_db", numbers({0, 60}, [](W w, double d) { w.spread.threshold_db = d; })},
        {"spread_place_mm", numbers({0, 1000}, [](W w, double d) { w.spread.place_mm = d; })},
    };
}

const std::map<std::string, setter>& known()
{
    static const std::map<std::string, setter> all = [] {
        auto every = planning();
        every.merge(sounding());
        every.merge(spreading());
        return every;
    }();
    return all;
}

void exclude(const py::dict& given, const char* a, const char* b)
{
    const auto says = [&given](const char* name) { return given.contains(name) && !given[name].is_none(); };
    if (says(a) && says(b))
        refuse(a, fmt::format("there is also {}", b), "give one of them");
}

void take_phantom(wishes& w, py::handle v, std::size_t tactors)
{
    if (py::hasattr(v, "weights"))
        w.plan.custom_phantom = model_of(py::reinterpret_borrow<py::object>(v), tactors);
    else
        w.plan.phantom = one_of<phantom_kind>("phantom", v);
}

} // namespace

void take_options(wishes& into, const py::dict& given, std::size_t tactors)
{
    exclude(given, "duration", "speed");
    exclude(given, "level_dbfs", "sl");
    std::string of_spread;
    for (const auto& [key, value] : given) {
        if (value.is_none())
            continue;
        const auto name = key.cast<std::string>();
        if (name == "phantom") {
            take_phantom(into, value, tactors);
            continue;
        }
        const auto o = known().find(name);
        if (o == known().end())
            throw py::type_error(fmt::format("there is no option '{}'", name));
        o->second(into, name, value);
        if (name.starts_with("spread_"))
            of_spread = name;
    }
    if (!of_spread.empty() && into.spread.people == 0)
        refuse(of_spread, "there is no spread", "say spread=N, too");
    if (into.fit_margin_mm > 0.0 && !into.fit)
        refuse("fit_margin", "there is no fit", "say fit=True, too");
    if (into.plan.scale.kind == scale_kind::sl)
        into.plan.scale.sl_db = into.sound.sl_db.value_or(0.0);
    timing_profile& p = into.plan.profile;
    if (into.slope || into.intercept_s) {
        p.slope = into.slope.value_or(p.slope);
        p.intercept_s = into.intercept_s.value_or(p.intercept_s);
        p.max_soa_s = p.intercept_s / (1.0 - p.slope);
    }
}

std::vector<std::string> option_names()
{
    std::vector<std::string> names{"phantom"};
    for (const auto& o : known())
        names.push_back(o.first);
    std::sort(names.begin(), names.end());
    return names;
}

} // namespace tactor::python
