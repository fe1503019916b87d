// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "options/option.hpp"
#include "plan/curve_impl.hpp"
#include "python/plan_handle.hpp"

namespace tactor::python {
namespace {

// Frames between two looks for Ctrl-C: some 10 ms of work.
constexpr std::uint64_t frames_at_once = 1 << 18;

// A plan, its start, true if it was made for another array, and this array's file for what it leaves open.
using score_part = std::tuple<std::optional<double>, const plan_handle*, bool, const setup*>;

render_options settle_sound(const plan_handle& p, const py::dict& given, bool elsewhere, const setup* file)
{
    wishes w;
    w.place = options::in_score;
    w.render = p.sound;
    if (elsewhere)
        for (const std::string& name : p.sound_options)
            w.given.set(index(*options::find(name)));
    take_options(w, given, 0, file);
    // A plan that was recorded says how many channels it had without a marker.
    if (w.render.marker_channel && w.render.channels != 0 && !w.channels)
        w.render.channels = std::max(w.render.channels, *w.render.marker_channel + 1);
    return w.render;
}

[[noreturn]] void refuse_different(const std::string& name, const std::string& a, const std::string& b)
{
    throw error(error_kind::bad_input, name, fmt::format("the plans differ: {} and {}", a, b),
                fmt::format("say {}= here, which counts for all of them", name))
        .with_field(name);
}

std::string value_text(const std::optional<double>& d)
{
    return d ? plain_number(*d) : "none";
}

// Refuses sounds that differ in what a score has once.
void check_alike(const render_options& a, const render_options& b)
{
    const auto check = [](const char* name, const auto& x, const auto& y, auto text) {
        if (x != y)
            refuse_different(name, text(x), text(y));
    };
    check("rate", a.rate, b.rate, [](unsigned hz) { return fmt::format("{} Hz", hz); });
    check("phase", a.phase, b.phase, [](phase_kind k) { return std::string(to_string(k)); });
    check("ramp", a.ramp_s, b.ramp_s, value_text);
    check("attack", a.envelope.attack_s, b.envelope.attack_s, value_text);
    check("release", a.envelope.release_s, b.envelope.release_s, value_text);
    check("envelope", a.envelope, b.envelope, envelope_text);
    if (a.sl_db.has_value() != b.sl_db.has_value())
        refuse_different("sl", value_text(a.sl_db), value_text(b.sl_db));
    if (a.marker_channel && b.marker_channel)
        check("marker_channel", *a.marker_channel, *b.marker_channel,
              [](unsigned c) { return std::to_string(c); });
}

double level_db(const render_options& o)
{
    return o.sl_db.value_or(o.level_dbfs);
}

// Returns the sound of them all, at the level of the loudest.
render_options joined(std::span<const render_options> sounds)
{
    render_options all = sounds.front();
    for (const render_options& o : sounds) {
        check_alike(all, o);
        all.channels = std::max(all.channels, o.channels);
        if (!all.marker_channel && o.marker_channel) {
            all.marker_channel = o.marker_channel;
            all.marker_s = o.marker_s;
        }
        if (level_db(o) > level_db(all)) {
            all.level_dbfs = o.level_dbfs;
            all.sl_db = o.sl_db;
        }
    }
    return all;
}

// Collects everything but plans and array that changes samples.
py::tuple recipe(const render_options& o)
{
    const py::object limits =
        o.limits ? py::object(py::make_tuple(o.limits->power_dbfs, o.limits->max_drive_s, o.limits->window_s))
                 : py::object(py::none());
    return py::make_tuple(o.rate, std::string(to_string(o.phase)), o.ramp_s, envelope_text(o.envelope),
                          o.envelope.attack_s, o.envelope.release_s, o.channels, o.marker_channel, o.marker_s,
                          limits, o.sl_db.has_value());
}

// Makes a score. Each plan keeps its level; the rest is common to them.
py::tuple make_score(const array_handle& on, const std::vector<score_part>& plans, const py::dict& given)
{
    if (plans.empty())
        throw error(error_kind::bad_input, "plans", "there are none", "give at least one");
    std::vector<render_options> sounds;
    std::vector<double> levels;
    for (const auto& [start_s, p, elsewhere, file] : plans) {
        check_same_array(*p, on.value());
        sounds.push_back(settle_sound(*p, given, elsewhere, file));
        levels.push_back(level_db(sounds.back()));
    }
    const render_options common = settled(on.value(), joined(sounds));
    const auto made = [&] {
        const without_lock free;
        std::vector<placed_plan> all;
        for (std::size_t i = 0; i < plans.size(); ++i) {
            all.push_back(std::get<1>(plans[i])->at(std::get<0>(plans[i])));
            if (levels[i] != level_db(common))
                all.back().plan = detail::scaled(std::move(all.back().plan),
                                                 std::pow(10.0, (levels[i] - level_db(common)) / 20.0));
        }
        return score(on.value(), std::move(all), common);
    }();
    return py::make_tuple(made, recipe(common) + py::make_tuple(py::tuple(py::cast(levels))));
}

// Checks for Ctrl-C without the lock: throws what Python's handler raised.
void check_signals()
{
    const with_lock lock;
    if (in_python([] { return PyErr_CheckSignals(); }) != 0)
        throw py::error_already_set();
}

// Makes the next frames of a score, block by block.
class block_renderer {
public:
    block_renderer(const score& s, const std::string& format)
        : renderer_(s, from_string<format_kind>(format)),
          frame_(s.channels() * sample_bytes(from_string<format_kind>(format)))
    {
    }

    /// Fills memory with frames, which it is a whole number of.
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
    void into(const py::buffer& to)
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
    std::size_t frame_; ///< bytes
};

void write(const score& s, const std::string& file, const std::string& format)
{
    static_cast<void>(options::read_value(*options::find("sample_format"), format));
    const auto f = from_string<format_kind>(format);
    const without_lock free;
    std::uint64_t next = frames_at_once;
    write_wav(s, f, std::filesystem::path(file), [&](std::uint64_t done, std::uint64_t) {
        if (done >= next) {
            next = done + frames_at_once;
            check_signals();
        }
        return true;
    });
}

} // namespace

py::tuple plan_recipe(const plan_handle& p)
{
    return recipe(settled(p.on->value(), p.sound)) + py::make_tuple(level_db(p.sound));
}

void bind_score(py::module_& m)
{
    m.def("make_score", &make_score);
    py::class_<score>(m, "Score")
        .def_property_readonly("frames", &score::frames)
        .def_property_readonly("channels", &score::channels)
        .def_property_readonly("rate", &score::rate)
        .def_property_readonly("starts", &score::starts)
        .def("write", &write);
    py::class_<block_renderer>(m, "Renderer")
        .def(py::init<const score&, const std::string&>())
        .def("into", &block_renderer::into)
        .def("skip", &block_renderer::skip);
}

} // namespace tactor::python
