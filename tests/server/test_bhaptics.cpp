// SPDX-License-Identifier: MIT
// Programs for the bHaptics player: frames as strokes, changed projects, and a program on the service.
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/stroke.hpp>

#include "net/rpc.hpp"
#include "server/bhaptics.hpp"
#include "service_rig.hpp"

namespace bhaptics_test {

using namespace tactor;
using namespace tactor::test;
using server::bhaptics_program;

namespace {

std::vector<stroke> strokes(const json& frame, const char* array = "palm-3x3")
{
    return parse_strokes_toml(server::frame_to_toml(frame, preset_array(array)), "frame");
}

bool is_silent(const json& frame)
{
    return server::frame_to_toml(frame, preset_array("palm-3x3")).empty();
}

json path_point(double x, double y, double intensity)
{
    return {{"X", x}, {"Y", y}, {"Intensity", intensity}, {"MotorCount", 3}};
}

json path_frame(double ms, const json& points)
{
    return {{"DurationMillis", ms}, {"Position", "VestFront"}, {"PathPoints", points}};
}

/// A program that is connected to a service; its messages are in `box`.
struct program_rig : running_rig {
    explicit program_rig(const changes& change = {}) : running_rig(change)
    {
        ok(watcher, "subscribe", {{"events", {"strokes"}}});
        number = all->connect(program, server::client_kind::bhaptics, "127.0.0.1");
        program->begin(number);
    }
    void say(const json& message) { program->receive(message.dump()); }
    static json submit(const char* type, const std::string& key, const json& more = json::object())
    {
        json one{{"Type", type}, {"Key", key}};
        one.update(more);
        return {{"Submit", {one}}};
    }
    void frame(const std::string& key, double ms, const json& points)
    {
        say(submit("frame", key, {{"Frame", path_frame(ms, points)}}));
    }
    json last() const { return box->all.empty() ? json::object() : box->all.back(); }
    bool plays(const std::vector<std::string>& keys) const
    {
        return !box->all.empty() && last()["ActiveKeys"] == json(keys);
    }
    /// Returns how many strokes came to a state.
    std::size_t count(const std::string& state) const
    {
        std::size_t n = 0;
        for (const json& m : watcher.box->notifications("stroke"))
            n += m["state"] == state ? 1U : 0U;
        return n;
    }
    std::size_t count_ends() const { return count("finished") + count("cancelled") + count("interrupted"); }

    std::shared_ptr<inbox> box = std::make_shared<inbox>();
    std::shared_ptr<bhaptics_program> program = std::make_shared<bhaptics_program>(io, *all, box, 64);
    connected watcher = client();
    client_number number = 0;
};

} // namespace

TEST_CASE("each touch of a frame rests on the array's bounding box for the frame's time")
{
    const json points = {path_point(0.0, 0.0, 100), path_point(1.0, 1.0, 50), path_point(0.25, 0.5, 1)};
    const auto all = strokes(path_frame(80, points));
    REQUIRE(all.size() == 3);
    const point places[] = {{0, 0}, {40, 40}, {10, 20}};
    const double intensities[] = {1.0, 0.5, 0.01};
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(distance_mm(all[i].motion.position(0.0), places[i]) < 1e-9);
        CHECK(distance_mm(all[i].motion.position(0.08), places[i]) < 1e-9);
        CHECK(all[i].motion.intensity(0.04) == doctest::Approx(intensities[i]));
        CHECK(all[i].motion.duration_s() == doctest::Approx(0.08));
        CHECK(all[i].start_s.value_or(-1.0) == 0.0);
        CHECK(all[i].choices.algorithm == algorithm_kind::continuous);
    }
}

TEST_CASE("motors of a frame lie in the grid of their device")
{
    const auto place = [](const char* position, int index) {
        const auto all = strokes({{"durationMillis", 100},
                                  {"position", position},
                                  {"dotPoints", {{{"index", index}, {"intensity", 100}}}}});
        REQUIRE(all.size() == 1);
        return all.front().motion.position(0.0);
    };
    CHECK(distance_mm(place("VestFront", 0), {0, 0}) < 1e-9);
    CHECK(distance_mm(place("VestFront", 3), {40, 0}) < 1e-9);
    CHECK(distance_mm(place("VestFront", 4), {0, 10}) < 1e-9);
    CHECK(distance_mm(place("VestFront", 19), {40, 40}) < 1e-9);
    CHECK(distance_mm(place("Head", 5), {40, 20}) < 1e-9);
    CHECK(distance_mm(place("HandL", 2), {20, 40}) < 1e-9);
    CHECK(distance_mm(place("ForearmL", 4), {20, 40}) < 1e-9);
}

TEST_CASE("what a frame says wrongly or not at all is silent, and numbers may be texts")
{
    const json one = json::array({path_point(0.5, 0.5, 100)});
    CHECK(is_silent(path_frame(0, one)));
    CHECK(is_silent(path_frame(-5, one)));
    CHECK(is_silent(path_frame(100, json::array())));
    CHECK(is_silent(path_frame(100, json::array({path_point(0.5, 0.5, 0)}))));
    CHECK(is_silent({{"DurationMillis", 100}, {"PathPoints", "here"}}));
    CHECK(is_silent({{"DurationMillis", 100}, {"PathPoints", {1, nullptr, "x", json::array()}}}));
    for (const json& index : {json(-1), json(20), json(1e300), json("x"), json(nullptr), json::array()})
        CHECK(is_silent({{"DurationMillis", 100}, {"DotPoints", {{{"Index", index}, {"Intensity", 100}}}}}));
    for (const char* behind : {"VestBack", "ForearmR", "Right", "HandR"}) {
        json frame = path_frame(100, one);
        frame["Position"] = behind;
        CHECK(is_silent(frame));
    }
    for (const json& frame : {json(), json(7), json::array(), json("frame")})
        CHECK(is_silent(frame));
    const auto said = strokes(
        {{"DurationMillis", "1e9"}, {"PathPoints", {{{"X", "7"}, {"Y", "0.25"}, {"Intensity", "1e99"}}}}});
    REQUIRE(said.size() == 1);
    CHECK(said[0].motion.position(0.0) == point{40, 10});
    CHECK(said[0].motion.intensity(0.0) == 1.0);
    CHECK(said[0].motion.duration_s() == 60.0);
    const json many(1000, path_point(0.5, 0.5, 100));
    CHECK(strokes(path_frame(100, many)).size() == 64);
}

TEST_CASE("motors that an avatar of VRChat touches have their places and numbers of their own")
{
    const array a = preset_array("palm-3x3");
    const auto first = server::read_vrchat("/avatar/parameters/bOSC_v1_VestFront_0", a);
    const auto last = server::read_vrchat("/avatar/parameters/bOSC/v2/VestFront/19", a);
    const auto head = server::read_vrchat("/avatar/parameters/bOSC_v1_Head_0", a);
    REQUIRE((first && last && head));
    CHECK(distance_mm(first->place, {0, 0}) < 1e-9);
    CHECK(distance_mm(last->place, {40, 40}) < 1e-9);
    CHECK((first->number != last->number && first->number != head->number));
    for (const char* other : {"", "/tactor/play", "/avatar/parameters/x", "/avatar/parameters/bOSC",
                              "/avatar/parameters/bOSC_VestFront_20", "/avatar/parameters/bOSC_VestBack_2"})
        CHECK_FALSE(server::read_vrchat(other, a));
}

TEST_CASE("a project is scaled and turned wherever its numbers are")
{
    const json project = {
        {"project",
         {{"layout", {{"layouts", {{"VestFront", {{{"index", 0}, {"x", "0.5"}, {"y", 0.5}}}}}}}},
          {"tracks",
           {{{"effects",
              {{{"startTime", 100}, {"offsetTime", "50"}, {"intensity", "0.4"}, {"name", "x"}}}}}}}}}};
    json changed = project;
    server::change_project(changed, {{"scaleOption", {{"intensity", 2}, {"duration", 0.5}}}});
    const json& effect = changed["project"]["tracks"][0]["effects"][0];
    CHECK(effect["startTime"] == 50.0);
    CHECK(effect["offsetTime"] == 25.0);
    CHECK(effect["intensity"] == 0.8);
    CHECK(effect["name"] == "x");
    server::change_project(changed, {{"ScaleOption", {{"Intensity", 10}}}});
    CHECK(changed["project"]["tracks"][0]["effects"][0]["intensity"] == 1.0);
    const auto turn = [&](double angle, double up) {
        json turned = project;
        server::change_project(turned, {{"rotationOption", {{"offsetAngleX", angle}, {"offsetY", up}}}});
        const json& at = turned["project"]["layout"]["layouts"]["VestFront"][0];
        const auto number = [](const json& v) {
            return v.is_string() ? std::stod(v.get<std::string>()) : v.get<double>();
        };
        return point{number(at["x"]), number(at["y"])};
    };
    CHECK(turn(0, 0) == point{0.5, 0.5});
    CHECK(turn(45, 0.25) == point{0.25, 0.25});
    CHECK(turn(-45, 0) == point{0.75, 0.5});
    CHECK(turn(360, 0) == point{0.5, 0.5});
    CHECK(turn(120, 0) == point{0.0, 0.5}); // on the back, nearer to the left edge
    CHECK(turn(240, 0) == point{1.0, 0.5});
}

TEST_CASE("a program gets a status, at changes and ten times a second")
{
    program_rig rig;
    rig.until([&] { return !rig.box->all.empty(); });
    const json first = rig.last();
    CHECK(first["RegisteredKeys"] == json::array());
    CHECK(first["ActiveKeys"] == json::array());
    CHECK(first["ConnectedDeviceCount"] == first["ConnectedPositions"].size());
    CHECK(first["ConnectedDeviceCount"] > 0);
    CHECK(first["Status"]["VestFront"] == json(std::vector<int>(20)));
    const std::size_t before = rig.box->all.size();
    rig.until([&] { return rig.box->all.size() >= before + 3; });
    rig.say({{"register", {{{"key", "a"}, {"project", {{"tracks", json::array()}}}}}}});
    rig.until([&] { return rig.last()["RegisteredKeys"] == json({"a"}); });
}

TEST_CASE("a frame plays under its key, and the newest one follows while a request has no answer")
{
    program_rig rig;
    rig.frame("a", 50, {path_point(0.5, 0.5, 100), path_point(0.0, 0.0, 100)});
    rig.until([&] { return rig.count("started") == 2 && rig.count_ends() == 2 && rig.plays({}); });
    rig.frame("a", 60000, json::array({path_point(0.5, 0.5, 100)}));
    rig.frame("b", 60000, json::array({path_point(0.5, 0.5, 100)}));
    rig.until([&] { return rig.count("started") == 4; });
    rig.say(rig.submit("turnOff", "a"));
    rig.frame("b", 100, json::array());
    rig.until([&] { return rig.count_ends() == 4 && rig.plays({}); });
    for (const double x : {0.1, 0.2, 0.3, 0.4, 0.5})
        rig.frame("c", 60000, json::array({path_point(x, 0.5, 100)}));
    // The newest takes the place of the first, which may end before it starts.
    rig.until([&] { return rig.count_ends() == 5 && rig.plays({"c"}); });
    rig.say(rig.submit("turnOff", "c"));
    rig.until([&] { return rig.count_ends() == 6 && rig.plays({}); });
    const std::size_t started = rig.count("started");
    rig.frame("d", 60000, json::array({path_point(0.5, 0.5, 100)}));
    rig.until([&] { return rig.count("started") == started + 1; });
    rig.say(rig.submit("turnOffAll", ""));
    rig.until([&] { return rig.count_ends() == 7 && rig.plays({}); });
    // A frame that may not be planned yet never sounds: it becomes no stroke, or one that is cancelled at
    // once.
    const std::size_t finished = rig.count("finished");
    rig.frame("e", 60000, json::array({path_point(0.5, 0.5, 100)}));
    rig.say(rig.submit("turnOffAll", ""));
    rig.frame("f", 100, json::array({path_point(0.5, 0.5, 100)}));
    rig.until([&] { return rig.count("finished") == finished + 1 && rig.plays({}); });
    CHECK(rig.count("started") == started + 2);
}

TEST_CASE("a registered project plays with its key, scaled as each submission asks")
{
    // A path on the front: 0.3 s along the top, from left to right.
    const json swipe = json::parse(R"({
        "layout": {"layouts": {"VestFront": []}},
        "tracks": [{"enable": true, "effects": [{"startTime": 0, "offsetTime": 300, "modes": {"VestFront": {
            "mode": "PATH_MODE", "dotMode": {"feedback": []}, "pathMode": {"feedback": [{
                "movingPattern": "CONST_SPEED", "playbackType": "NONE", "pointList": [
                    {"x": "0.0", "y": "0.0", "intensity": "1.0", "time": "0"},
                    {"x": "1.0", "y": "0.0", "intensity": "1.0", "time": "300"}]}]}}}}]}]})");
    program_rig rig;
    const auto frames_of_last = [&rig] {
        const std::size_t ends = rig.count_ends();
        rig.until([&] { return rig.count_ends() == ends + 1 && rig.plays({}); });
        return rig.watcher.box->notifications("stroke").back()["frames"].get<double>();
    };
    rig.say({{"Register", json::array({{{"Key", "swipe"}, {"Project", swipe}},
                                       {{"Key", "bad"}, {"Project", {{"tracks", 7}}}}})}});
    rig.say(rig.submit("key", "swipe"));
    const double once = frames_of_last();
    CHECK(once >= 0.3 * 48000);
    const json twice = {{"Parameters", {{"ScaleOption", {{"Duration", 2.0}, {"Intensity", 0.5}}}}}};
    rig.say(rig.submit("key", "swipe", twice));
    CHECK(frames_of_last() == doctest::Approx(once + 0.3 * 48000).epsilon(0.1));
    // A project that cannot be read frees its key, and the next submission plays as registered.
    rig.say(rig.submit("key", "bad"));
    rig.say(rig.submit("key", "nobody"));
    rig.say(rig.submit("key", "swipe"));
    CHECK(frames_of_last() == once);
    CHECK(rig.count("started") == 3);
    // Two submissions with other keys play together.
    rig.say(rig.submit("key", "swipe", {{"Parameters", {{"AltKey", "left"}}}}));
    rig.say(
        rig.submit("key", "swipe",
                   {{"Parameters", {{"AltKey", "right"}, {"RotationOption", {{"OffsetAngleX", 90.0}}}}}}));
    rig.until([&] { return rig.count("finished") == 5 && rig.plays({}); });
}

TEST_CASE("messages that make no sense are ignored, and floods stay within the limits")
{
    program_rig rig;
    for (const char* text :
         {"", "{", "[]", "7", "null", R"({"Submit":7})", R"({"Submit":[7,null,{}]})",
          R"({"Submit":[{"Type":"key","Key":"nobody"}]})", R"({"Register":[{"Key":1}]})",
          R"({"Submit":[{"Type":"frame","Key":"a"}]})", R"({"Submit":[{"Type":7,"Key":[]}]})"})
        rig.program->receive(text);
    rig.program->receive(std::string(60000, '['));
    bool done = false;
    rig.program->receive(std::string(1U << 20, '['), [&done](bool go_on) { done = go_on; });
    rig.until([&] { return done; });
    for (int i = 0; i < 2000; ++i)
        rig.frame("key " + std::to_string(i), 60000, json::array({path_point(0.5, 0.5, 100)}));
    rig.until([&] { return rig.count("started") > 0; });
    CHECK(rig.all->status_json()["strokes"].size() <= 64);
    const json project = {{"tracks", json::array()}, {"name", std::string(900000, 'x')}};
    for (int i = 0; i < 40; ++i)
        rig.say({{"Register", {{{"Key", "big " + std::to_string(i)}, {"Project", project}}}}});
    rig.until([&] { return !rig.last()["RegisteredKeys"].empty(); });
    const auto kept = rig.last()["RegisteredKeys"].size();
    CHECK(kept * 900000 <= bhaptics_program::most_bytes);
    rig.say(rig.submit("turnOffAll", ""));
    rig.until([&] { return rig.plays({}); });
}

} // namespace bhaptics_test
