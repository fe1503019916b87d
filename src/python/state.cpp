// SPDX-License-Identifier: MIT
// Paths and strokes as bytes: their members in MessagePack. Numbers keep their last bit.
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"
#include "python/binding.hpp"

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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(recording, file, rate_hz, samples, sha256, missing)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(modulation, hz, depth)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(carrier_part, part, hz)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_choices, algorithm, phantom, faces, soa_s, burst_s, level_db)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_fit, margin_mm, group)
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

// Copies a list as it lies in memory: as JSON a million points take ten times as much.
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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(stroke_sound, carrier_hz, carrier_profile, wave, am)

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
        j["moves"] = drawn.moves->given();
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

std::string write(const nlohmann::json& value)
{
    std::string state;
    nlohmann::json::to_msgpack(value, state);
    return state;
}

template <class T>
T read(std::string_view state)
try {
    return nlohmann::json::from_msgpack(state.begin(), state.end()).get<T>();
} catch (const nlohmann::json::exception&) {
    throw error(error_kind::bad_input, "pickle", "its bytes are not those of a path or stroke",
                "make it anew with this version of tactor");
}

} // namespace

std::string write_state(const path& p)
{
    return write(p);
}

std::string write_state(const stroke& s)
{
    return write(s);
}

path read_path(std::string_view state)
{
    return read<path>(state);
}

stroke read_stroke(std::string_view state)
{
    return read<stroke>(state);
}

} // namespace tactor::python
