// SPDX-License-Identifier: MIT
// Vibrations of .haptic and AHAP files; tests/cli/test_content.py measures how they sound.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/waveform.hpp>

#include "caught.hpp"
#include "files/vibration_file.hpp"
#include "has.hpp"

namespace vibration_test {

using namespace tactor;

namespace {

vibration haptic(const std::string& envelopes)
{
    return detail::read_haptic(
        R"({"version": {"major": 1, "minor": 0, "patch": 0}, "signals": {"continuous": {"envelopes": )" +
            envelopes + "}}}",
        "a.haptic");
}

vibration ahap(const std::string& pattern)
{
    return detail::read_ahap(R"({"Version": 1.0, "Pattern": [)" + pattern + "]}", "a.ahap");
}

} // namespace

TEST_CASE("a .haptic file has its points, and an emphasis at some of them")
{
    const vibration v = haptic(
        R"({"amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 0.1, "amplitude": 1, "emphasis": {"amplitude": 0.7, "frequency": 0.3}}, {"time": 0.1, "amplitude": 0, "emphasis": null}, {"time": 2, "amplitude": 0.25}], "frequency": [{"time": 0.5, "frequency": 1}]})");
    CHECK(v.amplitude == std::vector<timed_value>{{0.0, 0.5}, {0.1, 1.0}, {0.1, 0.0}, {2.0, 0.25}});
    CHECK(v.frequency == std::vector<timed_value>{{0.5, 1.0}});
    CHECK(v.emphases == std::vector<emphasis>{{0.1, 0.7, 0.3}});
    CHECK(v.duration_s == 2.0);
    CHECK(v.actuator == actuator_numbers{});
    CHECK_FALSE(v.own_actuator);
    CHECK(
        haptic(
            R"({"amplitude": [{"time": 0, "amplitude": 1}, {"time": 1, "amplitude": 1}], "frequency": null})")
            .frequency.empty());
    has(caught_message(
            [] { haptic(R"({"amplitude": [{"time": 1, "amplitude": 1}, {"time": 0.5, "amplitude": 1}]})"); }),
        "signals.continuous.envelopes.amplitude[1].time: it is before that of the previous point");
    has(caught_message([] { haptic("{}"); }), "signals.continuous.envelopes.amplitude: it is missing");
    has(caught_message([] { haptic(R"({"amplitude": [{"time": 0, "amplitude": 1}, {"time": 1}]})"); }),
        "amplitude: it is missing");
    has(caught_message([] { detail::read_haptic(R"({"version": {"major": 2}})", "b.haptic"); }),
        "version 2 is not supported");
    has(caught_message([] { detail::read_haptic(R"({"signals": {"impulses": []}})", "b.haptic"); }),
        "version.major: it is missing");
}

TEST_CASE("AHAP: events that overlap add up to at most 1, and their frequency is their mean by amplitude")
{
    const vibration v = ahap(
        R"({"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 2, "EventParameters": [{"ParameterID": "HapticIntensity", "ParameterValue": 0.5}, {"ParameterID": "HapticSharpness", "ParameterValue": 0}]}},
{"Event": {"Time": 1, "EventType": "HapticContinuous", "EventDuration": 2, "EventParameters": [{"ParameterID": "HapticIntensity", "ParameterValue": 0.5}, {"ParameterID": "HapticSharpness", "ParameterValue": 1}]}})");
    CHECK(v.duration_s == 3.0);
    CHECK(v.amplitude ==
          std::vector<timed_value>{{0, 0.25}, {1, 0.25}, {1, 0.5}, {2, 0.5}, {2, 0.25}, {3, 0.25}});
    CHECK(v.frequency == std::vector<timed_value>{{0, 0}, {1, 0}, {1, 0.5}, {2, 0.5}, {2, 1}, {3, 1}});
    CHECK(v.own_actuator);
    CHECK(
        ahap(
            R"({"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 1}}, {"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 1}},)")
            .amplitude == std::vector<timed_value>{{0, 1}, {1, 1}});
}

TEST_CASE("AHAP: curves hold between each other, and a parameter steps")
{
    const vibration v = ahap(
        R"({"Event": {"Time": 0, "EventType": "HapticContinuous", "EventDuration": 4}},
{"ParameterCurve": {"ParameterID": "HapticIntensityControl", "Time": 2, "ParameterCurveControlPoints": [{"Time": 0, "ParameterValue": 0.5}, {"Time": 1, "ParameterValue": 2}]}},
{"Parameter": {"ParameterID": "HapticIntensityControl", "Time": 1, "ParameterValue": 0}})");
    const auto amplitude = [&v](double t_s) {
        double found = -1.0;
        for (const timed_value& p : v.amplitude)
            if (p.t_s <= t_s)
                found = p.value;
        return found;
    };
    CHECK(amplitude(0.9) == 1.0);
    CHECK(amplitude(1.0) == 0.0);
    CHECK(amplitude(1.9) == 0.0);
    CHECK(amplitude(2.0) == 0.25);
    CHECK(amplitude(2.25) == doctest::Approx(0.875 * 0.875)); // a point of the square of 0.5 + 1.5 t
    CHECK(amplitude(4.0) == 1.0);
}

TEST_CASE("what a program makes is checked as a file is")
{
    waveform w{.kind = waveform_kind::recording, .texture = texture_kind::time};
    const auto refusal = [&w](auto change) {
        vibration v = haptic(
            R"({"amplitude": [{"time": 0, "amplitude": 1}, {"time": 1, "amplitude": 1, "emphasis": {"amplitude": 1, "frequency": 1}}]})");
        change(v);
        w.recorded = std::make_shared<const recording>(recording{.source = v});
        return caught_message([&w] { validate(w); });
    };
    CHECK(refusal([](vibration&) {}).empty());
    has(refusal([](vibration& v) { v.duration_s = 0.0; }), "no duration");
    has(refusal([](vibration& v) { v.amplitude.clear(); }), "no amplitude");
    has(refusal([](vibration& v) { v.amplitude[1].t_s = -1.0; }), "a time of its vibration");
    has(refusal([](vibration& v) { v.frequency = {{0.0, std::nan("")}}; }), "a value of its vibration");
    has(refusal([](vibration& v) { v.emphases[0].frequency = 2.0; }), "an emphasis is out of range");
    has(refusal([](vibration& v) { v.actuator.low_hz = 0.0; }), "a frequency of its actuator");
    has(refusal([](vibration& v) { v.actuator.emphasis_low_s = 0.0; }), "an emphasis of its actuator");
    has(refusal([](vibration& v) { v.actuator.ducking = 2.0; }), "a part of its actuator");
}

} // namespace vibration_test
