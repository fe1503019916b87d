// SPDX-License-Identifier: MIT
#include "server/stroke_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/kind_names.hpp"
#include "core/option_bounds.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
namespace of = detail::option_bounds;

template <typename Kind>
Kind word(const json& v, const std::string& what)
{
    if (v.is_string())
        if (const auto k = detail::kind_named<Kind>(v.get_ref<const std::string&>()))
            return *k;
    bad_param(what,
              v.is_string() ? fmt::format("\"{}\" is not known", v.get_ref<const std::string&>())
                            : "it is no text",
              fmt::format("one of {}", fmt::join(detail::names_of<Kind>(), ", ")));
}

bool flag(const json& v, const std::string& what)
{
    if (!v.is_boolean())
        bad_param(what, "it is neither true nor false");
    return v.get<bool>();
}

const std::string& text(const json& v, const std::string& what)
{
    if (!v.is_string())
        bad_param(what, "it is no text");
    return v.get_ref<const std::string&>();
}

// What the library reads of a text.
template <typename Parse>
auto parsed(Parse parse, const json& v, const std::string& what)
{
    try {
        return parse(text(v, what));
    } catch (const error& e) {
        bad_param(what, std::string(e.why()), std::string(e.hint()));
    }
}

// Files are the server's own: no client names one.
waveform named_wave(const json& v, const std::string& what, waveform before)
{
    const std::string& name = text(v, what);
    if (waveform_names_file(name))
        bad_param(what, "a client may name no file", "one of sine, square, triangle, sawtooth, noise:LO-HI");
    waveform w = parsed([](std::string_view t) { return parse_waveform(t); }, v, what);
    w.seed = before.seed;
    return w;
}

bool compensation(const json& v, const std::string& what)
{
    const std::string& name = text(v, what);
    if (name != "none" && name != "low-speed")
        bad_param(what, fmt::format("\"{}\" is not known", name), "one of none, low-speed");
    return name != "none";
}

struct option {
    std::string_view name;
    bool live; ///< strokes that are fed point by point know it
    void (*put)(stroke_settings& s, const json& v, const std::string& what);
};

using set = stroke_settings;

// As the command line takes them.
constexpr std::array options{
    option{
        "algorithm", true,
        [](set& s, const json& v, const std::string& w) { s.plan.algorithm = word<algorithm_kind>(v, w); }},
    option{"phantom", true,
           [](set& s, const json& v, const std::string& w) { s.plan.phantom = word<phantom_kind>(v, w); }},
    option{"faces", true,
           [](set& s, const json& v, const std::string& w) { s.plan.faces = word<faces_kind>(v, w); }},
    option{"duration", false,
           [](set& s, const json& v, const std::string& w) {
               s.duration_s = number(v, w, 0.001, 86400);
               s.speed_mm_s.reset();
           }},
    option{"speed", false,
           [](set& s, const json& v, const std::string& w) {
               s.speed_mm_s = number(v, w, of::speed);
               s.duration_s.reset();
           }},
    option{"soa", true,
           [](set& s, const json& v, const std::string& w) { s.plan.soa_s = number(v, w, -1e9, 1e9); }},
    option{"burst", true,
           [](set& s, const json& v, const std::string& w) { s.plan.burst_s = number(v, w, of::burst); }},
    option{
        "slope", true,
        [](set& s, const json& v, const std::string& w) { s.plan.profile.slope = number(v, w, of::slope); }},
    option{"intercept", true,
           [](set& s, const json& v, const std::string& w) {
               s.plan.profile.intercept_s = number(v, w, of::intercept);
           }},
    option{"timing", false,
           [](set& s, const json& v, const std::string& w) { s.plan.timing = word<timing_kind>(v, w); }},
    option{"outside", true,
           [](set& s, const json& v, const std::string& w) { s.plan.outside = word<outside_kind>(v, w); }},
    option{"snap", false, [](set& s, const json& v, const std::string& w) { s.plan.snap = flag(v, w); }},
    option{"drop_points", false,
           [](set& s, const json& v, const std::string& w) { s.plan.drop_points = flag(v, w); }},
    option{"overlap", false,
           [](set& s, const json& v, const std::string& w) { s.plan.overlap = word<overlap_kind>(v, w); }},
    option{
        "carrier", true,
        [](set& s, const json& v, const std::string& w) { s.plan.carrier_hz = number(v, w, of::carrier); }},
    option{"waveform", true,
           [](set& s, const json& v, const std::string& w) { s.plan.wave = named_wave(v, w, s.plan.wave); }},
    option{"am", true,
           [](set& s, const json& v, const std::string& w) { s.plan.am = parsed(parse_modulation, v, w); }},
    option{"noise_seed", true,
           [](set& s, const json& v, const std::string& w) {
               const double seed = number(v, w, of::noise_seed);
               if (seed != std::floor(seed))
                   bad_param(w, "it is no whole number");
               s.plan.wave.seed = static_cast<std::uint64_t>(seed);
           }},
    option{"envelope", true,
           [](set& s, const json& v, const std::string& w) {
               const burst_envelope e = parsed(parse_envelope, v, w);
               s.render.envelope.kind = e.kind;
               s.render.envelope.tukey_part = e.tukey_part;
           }},
    option{"attack", true,
           [](set& s, const json& v, const std::string& w) {
               s.render.envelope.attack_s = number(v, w, of::attack);
           }},
    option{"release", true,
           [](set& s, const json& v, const std::string& w) {
               s.render.envelope.release_s = number(v, w, of::release);
           }},
    option{"phase", true,
           [](set& s, const json& v, const std::string& w) { s.render.phase = word<phase_kind>(v, w); }},
    option{"ramp", true,
           [](set& s, const json& v, const std::string& w) { s.render.ramp_s = number(v, w, of::ramp); }},
    option{"level_dbfs", true,
           [](set& s, const json& v, const std::string& w) {
               s.render.level_dbfs = number(v, w, of::level_dbfs);
               s.render.sl_db.reset();
           }},
    option{"sl", true,
           [](set& s, const json& v, const std::string& w) { s.render.sl_db = number(v, w, of::sl); }},
    option{"intensity_scale", true,
           [](set& s, const json& v, const std::string& w) { s.plan.scale.kind = word<scale_kind>(v, w); }},
    option{"stevens_exponent", true,
           [](set& s, const json& v, const std::string& w) {
               s.plan.scale.exponent = number(v, w, of::stevens_exponent);
           }},
    option{"compensate", false,
           [](set& s, const json& v, const std::string& w) { s.compensate = compensation(v, w); }},
    option{"sigma_mm", false,
           [](set& s, const json& v, const std::string& w) {
               s.low_speed.sigma_mm = number(v, w, least_sigma_mm, most_sigma_mm);
           }},
    option{"sigma_v_mm_s", false,
           [](set& s, const json& v, const std::string& w) {
               s.low_speed.sigma_v_mm_s = number(v, w, least_sigma_v_mm_s, most_sigma_v_mm_s);
           }},
};

void check_pair(const json& given, const char* a, const char* b)
{
    if (given.contains(a) && given.contains(b))
        bad_param(fmt::format("options.{}", b), fmt::format("there is also options.{}", a),
                  "give one of them");
}

} // namespace

stroke_settings with_options(stroke_settings s, const json& given, options_for which)
{
    if (!given.is_object())
        bad_param("options", "they are no object", R"(such as {"algorithm":"continuous"})");
    check_pair(given, "duration", "speed");
    check_pair(given, "level_dbfs", "sl");
    for (const auto& [name, value] : given.items()) {
        const std::string what = "options." + name;
        const auto o = std::find_if(options.begin(), options.end(),
                                    [&n = name](const option& x) { return x.name == n; });
        if (o == options.end()) {
            std::vector<std::string_view> names;
            for (const option& x : options)
                names.push_back(x.name);
            bad_param(what, "there is no such option", fmt::format("one of {}", fmt::join(names, ", ")));
        }
        if (which == options_for::live && !o->live)
            bad_param(what, "a live stroke does not know it", "its points say when it is where");
        o->put(s, value, what);
    }
    for (const char* name : {"sigma_mm", "sigma_v_mm_s"})
        if (given.contains(name) && !s.compensate)
            bad_param(fmt::format("options.{}", name), "nothing here uses it",
                      "add options.compensate low-speed");
    if (given.contains("slope") || given.contains("intercept")) {
        timing_profile& p = s.plan.profile;
        p.max_soa_s = p.intercept_s / (1.0 - p.slope);
    }
    if (s.plan.scale.kind == scale_kind::sl) {
        s.plan.scale.sl_db = s.render.sl_db.value_or(0.0);
        if (!(s.plan.scale.sl_db > 0.0))
            bad_param("options.intensity_scale", "sl is a part of a sensation level above 0 dB",
                      "add options.sl, such as 7");
    }
    return s;
}

} // namespace tactor::server
