// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "python/plan_handle.hpp"

namespace tactor::python {
namespace {

// Frames between two looks for Ctrl-C: some 10 ms of work.
constexpr std::uint64_t frames_at_once = 1 << 18;

using placed = std::pair<std::optional<double>, const plan_handle*>;

bool says(const py::dict& options, const char* name)
{
    return options.contains(name) && !options[name].is_none();
}

// A score sounds as its first plan was meant to, but for what is said here.
score make_score(const array_handle& on, const std::vector<placed>& plans, const py::dict& options)
{
    if (plans.empty())
        throw error(error_kind::bad_input, "plans", "there are none", "give at least one");
    wishes w;
    w.sound = plans.front().second->sound;
    take_options(w, options, 0);
    // A plan that was recorded says how many channels it had without a marker.
    if (w.sound.marker_channel && w.sound.channels != 0 && !says(options, "channels"))
        w.sound.channels = std::max(w.sound.channels, *w.sound.marker_channel + 1);
    const without_lock free;
    std::vector<placed_plan> all;
    for (const auto& [start_s, p] : plans) {
        check_same_array(*p, on.value());
        all.push_back(p->at(start_s));
    }
    return {on.value(), std::move(all), settled(on.value(), w.sound)};
}

void process(const score& s, format_kind f, std::span<std::byte> out)
{
    renderer r(s, f);
    const std::size_t frame = s.channels() * bytes_of(f);
    for (std::uint64_t done = 0; done < s.frames();) {
        const std::uint64_t n = std::min(frames_at_once, s.frames() - done);
        r.process(out.subspan(done * frame, n * frame));
        done += n;
        if (!r.failure().empty())
            throw error(error_kind::runtime, "render", r.failure());
        if (done < s.frames())
            check_signals();
    }
}

py::array render(const score& s, const std::string& format, const py::dtype& dtype)
{
    const auto f = from_string<format_kind>(format);
    const std::size_t bytes = static_cast<std::size_t>(s.frames()) * s.channels() * bytes_of(f);
    auto out = std::make_unique_for_overwrite<std::byte[]>(bytes);
    {
        const without_lock free;
        process(s, f, {out.get(), bytes});
    }
    std::byte* const first = out.get();
    const py::capsule owner(out.release(), [](void* p) { delete[] static_cast<std::byte*>(p); });
    return {
        dtype, {static_cast<py::ssize_t>(s.frames()), static_cast<py::ssize_t>(s.channels())}, first, owner};
}

void write(const score& s, const std::string& file, const std::string& format)
{
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

void bind_score(py::module_& m)
{
    py::class_<score>(m, "Score")
        .def(py::init(&make_score))
        .def_property_readonly("frames", &score::frames)
        .def_property_readonly("channels", &score::channels)
        .def_property_readonly("rate", &score::rate)
        .def_property_readonly("starts", &score::starts)
        .def("render", &render)
        .def("write", &write);
}

} // namespace tactor::python
