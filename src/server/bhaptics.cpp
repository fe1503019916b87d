// SPDX-License-Identifier: MIT
#include "server/bhaptics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/path/shape.hpp"
#include "core/split.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

constexpr double levels_hz = 10.0; // a status each 100 ms
constexpr std::size_t status_motors = 20;
constexpr double longest_frame_s = 60.0;
constexpr std::size_t most_touches = 64; // of a frame
constexpr unsigned most_changing = 8;    // submissions whose project is being changed

// Returns a member by its name in PascalCase or camelCase; null for none.
const json* find(const json& object, std::string name)
{
    if (!object.is_object())
        return nullptr;
    auto found = object.find(name);
    if (found == object.end()) {
        name.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
        found = object.find(name);
    }
    return found == object.end() ? nullptr : &*found;
}

std::optional<double> read_number(const json* v)
{
    std::optional<double> n;
    if (v != nullptr && v->is_number())
        n = v->get<double>();
    else if (v != nullptr && v->is_string())
        n = detail::parse_number_text<double>(v->get_ref<const std::string&>());
    return n && std::isfinite(*n) ? n : std::nullopt;
}

double number_or(const json& object, const char* name, double usual, double low, double high)
{
    return std::clamp(read_number(find(object, name)).value_or(usual), low, high);
}

std::string text_or(const json& object, const char* name, const std::string& usual)
{
    const json* v = find(object, name);
    return v != nullptr && v->is_string() ? v->get<std::string>() : usual;
}

template <class Each>
void for_each(const json& object, const char* name, Each each)
{
    if (const json* list = find(object, name); list != nullptr && list->is_array())
        for (const json& one : *list)
            each(one);
}

// Motors of a device in rows, as the SDK numbers them. A frame does not say where they are.
struct motor_grid {
    std::string_view begin; ///< of the position's name
    unsigned columns;
    unsigned rows;
};
constexpr std::array motor_grids{motor_grid{"Head", 6, 1}, motor_grid{"Hand", 1, 3}, motor_grid{"Foot", 1, 3},
                                 motor_grid{"Forearm", 3, 2}, motor_grid{"", 4, 5}};

const motor_grid* find_grid(std::string_view position)
{
    return std::find_if(motor_grids.begin(), motor_grids.end(),
                        [&](const motor_grid& m) { return position.starts_with(m.begin); });
}

// Returns the place of a motor in the unit square; nothing beyond the last one.
std::optional<point> find_motor(std::string_view position, double index)
{
    const motor_grid* const g = find_grid(position);
    if (!(index >= 0.0 && index < g->columns * g->rows))
        return {};
    const auto i = static_cast<unsigned>(index);
    const auto part = [](unsigned at, unsigned count) { return count == 1 ? 0.5 : at / (count - 1.0); };
    return point{part(i % g->columns, g->columns), part(i / g->columns, g->rows)};
}

point scale_to_array(const array& a, point in_square)
{
    std::vector<point> places;
    for (const tactor_spec& t : a.tactors)
        places.push_back(t.position);
    const detail::box b = detail::bounding_box(places);
    return {b.low.x_mm + in_square.x_mm * (b.high.x_mm - b.low.x_mm),
            b.low.y_mm + in_square.y_mm * (b.high.y_mm - b.low.y_mm)};
}

// Returns true for a device that a program plays on by default. An array has one place on the body, so the
// back and the right side would only overlay the front and the left.
bool is_played(std::string_view position)
{
    return !position.ends_with("Back") && !position.ends_with('R') && !position.ends_with("Right");
}

// Moves x, which is from 0 to 1 on the front, round the body. The back is beyond both ends.
double turn_round_body(double x, double angle_deg)
{
    const double u = x - angle_deg / 180.0;
    const double front = u - 2.0 * std::floor((u + 0.5) / 2.0); // from -0.5 to 1.5
    return std::clamp(front, 0.0, 1.0);
}

} // namespace

std::string frame_to_toml(const json& frame, const array& on)
{
    const std::string position = text_or(frame, "Position", "VestFront");
    const double duration_s = number_or(frame, "DurationMillis", 0.0, 0.0, 1e3 * longest_frame_s) / 1e3;
    if (!is_played(position) || duration_s < detail::bounds_of::duration_s.low)
        return {};
    std::string text;
    std::size_t touches = 0;
    const auto add = [&](const json& touch, std::optional<point> at) {
        const double intensity = number_or(touch, "Intensity", 0.0, 0.0, 100.0) / 100.0;
        if (!at || intensity == 0.0 || touches == most_touches)
            return;
        ++touches;
        const point p = scale_to_array(on, *at);
        text += fmt::format("[[stroke]]\npath = \"M {} {}\"\nduration_s = {}\nintensity = {}\nstart_s = 0\n"
                            "algorithm = \"continuous\"\n",
                            p.x_mm, p.y_mm, duration_s, intensity);
    };
    for_each(frame, "PathPoints", [&](const json& p) {
        add(p, point{number_or(p, "X", 0.5, 0.0, 1.0), number_or(p, "Y", 0.5, 0.0, 1.0)});
    });
    for_each(frame, "DotPoints",
             [&](const json& p) { add(p, find_motor(position, number_or(p, "Index", -1.0, -1.0, 1e6))); });
    return text;
}

std::optional<vrchat_motor> read_vrchat(std::string_view address, const array& on)
{
    constexpr std::string_view begin = "/avatar/parameters/bOSC";
    constexpr std::int32_t first_number = 1'000'000; // far from those that people choose
    if (!address.starts_with(begin))
        return {};
    std::string name(address);
    std::replace(name.begin(), name.end(), '/', '_');
    const auto words = detail::split(name, '_');
    const std::string position(words[words.size() - 2]);
    const auto index = detail::parse_number_text<unsigned>(words.back());
    const auto at = index ? find_motor(position, *index) : std::nullopt;
    if (!at || !is_played(position))
        return {};
    const auto kind = find_grid(position) - motor_grids.begin();
    return vrchat_motor{first_number + static_cast<std::int32_t>(100 * kind + *index),
                        scale_to_array(on, *at)};
}

void change_project(json& project, const json& parameters)
{
    const json none = json::object();
    const json* scale = find(parameters, "ScaleOption");
    const json* turn = find(parameters, "RotationOption");
    scale = scale == nullptr ? &none : scale;
    turn = turn == nullptr ? &none : turn;
    const double intensity = number_or(*scale, "Intensity", 1.0, 0.0, 100.0);
    const double duration = number_or(*scale, "Duration", 1.0, 0.01, 100.0);
    const double angle_deg = number_or(*turn, "OffsetAngleX", 0.0, -3600.0, 3600.0);
    const double up = number_or(*turn, "OffsetY", 0.0, -1.0, 1.0);
    if (intensity == 1.0 && duration == 1.0 && angle_deg == 0.0 && up == 0.0)
        return;
    const auto change = [&](const auto& self, json& j) -> void {
        for (auto& [name, value] : j.items()) {
            const std::optional<double> n = read_number(&value);
            if (value.is_structured())
                self(self, value);
            else if (n && name == "intensity")
                value = std::min(1.0, *n * intensity);
            else if (n &&
                     (name == "startTime" || name == "endTime" || name == "offsetTime" || name == "time"))
                value = *n * duration;
            else if (n && name == "x")
                value = turn_round_body(*n, angle_deg);
            else if (n && name == "y")
                value = std::clamp(*n - up, 0.0, 1.0);
        }
    };
    change(change, project);
}

void bhaptics_program::begin(client_number number)
{
    number_ = number;
    service_.receive(number_, {"subscribe", {{"events", {"levels", "stream"}}, {"levels_hz", levels_hz}}}, 0,
                     {});
    is_connected_ = !service_.output().is_unavailable();
    schedule_status();
}

// Parses on a planner's thread if the message is large.
void bhaptics_program::receive(std::string text, std::function<void(bool)> done)
{
    if (text.size() <= net::large_message) {
        handle_message(net::parse_json(text, most_nesting_).value_or(nullptr));
        if (done)
            done(true);
        return;
    }
    const auto parsed = std::make_shared<json>();
    run_on_planner([parsed, text = std::move(text),
                    most = most_nesting_] { *parsed = net::parse_json(text, most).value_or(nullptr); },
                   [this, parsed, done = std::move(done)] {
                       handle_message(*parsed);
                       if (done)
                           done(true);
                   });
}

void bhaptics_program::handle_message(const json& message)
{
    for (const auto& [name, handle] :
         {std::pair{"Register", &bhaptics_program::add_project}, {"Submit", &bhaptics_program::submit}}) {
        std::size_t left = most_entries; // the rest is ignored: no game sends so many at once
        for_each(message, name, [&, handle = handle](const json& entry) {
            if (left == 0)
                return;
            --left;
            (this->*handle)(entry);
        });
    }
}

void bhaptics_program::add_project(const json& entry)
{
    const std::string key = text_or(entry, "Key", "");
    const json* project = find(entry, "Project");
    if (key.empty() || key.size() > longest_key || project == nullptr || !project->is_object())
        return;
    std::string text = json({{"project", *project}}).dump(-1, ' ', false, json::error_handler_t::replace);
    const std::size_t key_bytes = json(key).dump(-1, ' ', false, json::error_handler_t::replace).size();
    const auto old = projects_.find(key);
    const std::size_t before = old == projects_.end() ? 0 : key.size() + old->second.size();
    if (bytes_ - before + key.size() + text.size() > most_bytes ||
        (before == 0 && (projects_.size() == most_projects || key_bytes_ + key_bytes > most_key_bytes)))
        return;
    key_bytes_ += before == 0 ? key_bytes : 0;
    bytes_ += key.size() + text.size() - before;
    projects_[key] = std::move(text);
    schedule_status();
}

void bhaptics_program::submit(const json& entry)
{
    const std::string type = text_or(entry, "Type", "");
    const std::string key = text_or(entry, "Key", "");
    if (type == "turnOffAll") {
        for (auto& [name, p] : playing_) {
            p.next.reset();
            p.is_off = true;
        }
        service_.receive(number_, {"cancel", {{"all", true}}}, 0, {});
    }
    if (key.empty() || key.size() > longest_key)
        return;
    if (type == "turnOff")
        turn_off(key);
    else if (type == "key")
        submit_project(key, entry);
    const json* const frame = type == "frame" ? find(entry, "Frame") : nullptr;
    if (frame == nullptr)
        return;
    std::string text = frame_to_toml(*frame, service_.tactors());
    if (text.empty())
        turn_off(key);
    else
        play(key, {{"toml", std::move(text)}, {"held", true}, {"options", {{"outside", "clamp"}}}});
}

void bhaptics_program::submit_project(const std::string& key, const json& entry)
{
    const auto project = projects_.find(key);
    if (project == projects_.end())
        return;
    const json* const given = find(entry, "Parameters");
    const auto changes = std::make_shared<const json>(given == nullptr ? json::object() : *given);
    const std::string name = text_or(*changes, "AltKey", key);
    const auto text = std::make_shared<std::string>(project->second);
    if (find(*changes, "ScaleOption") == nullptr && find(*changes, "RotationOption") == nullptr)
        return play(name, {{"tact", *text}, {"held", true}});
    if (changing_ == most_changing)
        return;
    ++changing_;
    run_on_planner(
        [text, changes] {
            json file = json::parse(*text);
            change_project(file, *changes);
            *text = file.dump();
        },
        [this, name, text] {
            --changing_;
            play(name, {{"tact", std::move(*text)}, {"held", true}});
        });
}

// Plays under a key, in place of what plays under it. While a request has no answer, only the newest
// submission is kept.
void bhaptics_program::play(const std::string& key, json params)
{
    if (key.size() > longest_key || (playing_.size() >= most_projects && !playing_.contains(key)))
        return;
    playing& p = playing_[key];
    std::size_t bytes = 0;
    for (const char* source : {"toml", "tact"})
        bytes += params.contains(source) ? params[source].get_ref<const std::string&>().size() : 0;
    if (p.is_asked) {
        if (bytes <= net::large_message)
            p.next = std::move(params);
        return;
    }
    p.is_asked = true;
    p.is_off = false;
    service_.receive(number_, {"play", std::move(params)}, bytes,
                     [weak = weak_from_this(), key](const reply_json& r, const net::rpc_fault* why) {
                         if (const auto self = weak.lock())
                             self->on_answer(key, why == nullptr
                                                      ? r["strokes"].get<std::vector<std::uint32_t>>()
                                                      : std::vector<std::uint32_t>());
                     });
}

// Notes the numbers at once, because the strokes may end soon. The rest waits: the service may be in the
// middle of another call.
void bhaptics_program::on_answer(const std::string& key, std::vector<std::uint32_t> strokes)
{
    playing& p = playing_[key];
    p.is_asked = false;
    boost::asio::post(io_,
                      [weak = weak_from_this(), key, old = std::exchange(p.strokes, std::move(strokes))] {
                          if (const auto self = weak.lock()) {
                              self->cancel(old);
                              self->go_on(key);
                          }
                      });
}

void bhaptics_program::go_on(const std::string& key)
{
    const auto found = playing_.find(key);
    if (found == playing_.end() || found->second.is_asked)
        return;
    playing& p = found->second;
    if (p.is_off)
        cancel(p.strokes);
    if (p.next)
        play(key, *std::exchange(p.next, {}));
    else
        forget(found);
    schedule_status();
}

// Forgets a key under which nothing plays or is asked for.
void bhaptics_program::forget(std::map<std::string, playing>::iterator p)
{
    if (p->second.strokes.empty() && !p->second.is_asked && !p->second.next)
        playing_.erase(p);
}

void bhaptics_program::turn_off(const std::string& key)
{
    const auto found = playing_.find(key);
    if (found == playing_.end())
        return;
    found->second.next.reset();
    found->second.is_off = true;
    cancel(found->second.strokes);
}

void bhaptics_program::cancel(const std::vector<std::uint32_t>& strokes)
{
    for (const std::uint32_t n : std::vector(strokes)) // an end removes it
        service_.receive(number_, {"cancel", {{"stroke", n}}}, 0, {});
}

void bhaptics_program::run_on_planner(std::function<void()> work, std::function<void()> done)
{
    service_.run_on_planner(number_, std::move(work), [weak = weak_from_this(), done = std::move(done)] {
        if (const auto self = weak.lock())
            done();
    });
}

void bhaptics_program::notify(std::string_view method, const reply_json& params)
{
    if (method == "levels") {
        levels_ = reply_json::array();
        for (const reply_json& dbfs : params["dbfs"])
            levels_.push_back(
                dbfs.is_number()
                    ? std::lround(100.0 * std::pow(10.0, std::min(0.0, dbfs.get<double>()) / 20.0))
                    : 0);
        return send_status();
    }
    if (method == "stream")
        is_connected_ = params["state"] != "lost" && params["state"] != "closing";
    else if (method == "stroke" && params["state"] != "started")
        for (auto p = playing_.begin(); p != playing_.end(); ++p)
            if (std::erase(p->second.strokes, params["stroke"].get<std::uint32_t>()) != 0) {
                forget(p);
                break;
            }
    schedule_status();
}

// Sends the status once for all changes of this turn.
void bhaptics_program::schedule_status()
{
    if (std::exchange(tells_, true))
        return;
    boost::asio::post(io_, [this, weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            tells_ = false;
            send_status();
        }
    });
}

void bhaptics_program::send_status()
{
    if (to_->queued_bytes() >= enough_waiting)
        return;
    reply_json registered = reply_json::array();
    for (const auto& [key, text] : projects_)
        registered.push_back(key);
    reply_json active = reply_json::array();
    for (const auto& [key, p] : playing_)
        active.push_back(key);
    reply_json motors = levels_;
    while (motors.size() < status_motors)
        motors.push_back(0);
    reply_json positions = reply_json::array();
    if (is_connected_)
        positions = {"Vest", "Head", "ForearmL", "HandL", "FootL"};
    to_->send(net::json_line({{"RegisteredKeys", std::move(registered)},
                              {"ActiveKeys", std::move(active)},
                              {"ConnectedDeviceCount", positions.size()},
                              {"ConnectedPositions", std::move(positions)},
                              {"Status", {{"VestFront", std::move(motors)}}}}));
}

} // namespace tactor::server
