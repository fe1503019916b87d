// SPDX-License-Identifier: MIT
/// \file
/// Contents of session.json. The dry run prints some of them, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/render.hpp>
#include <tactor/setup.hpp>

#include "core/members.hpp"
#include "files/plan/plan_members.hpp"
#include "study/bids/dataset.hpp"
#include "study/data/definition.hpp"
#include "study/session/experiment_session.hpp"

namespace tactor::study {

/// Level of stimuli. Exactly one of the two members has a value.
struct listed_level {
    std::optional<double> sl_db = {};
    std::optional<double> dbfs = {};
};

/// Noise that hides the sound of the array.
struct listed_noise {
    std::string color = {};
    double level_dbfs = 0.0;
    double fade_s = 0.0;
    std::string duration = {}; ///< "run" or "stimulus"
};

/// A stimulus with the SHA-256 of its plans.
struct listed_stimulus {
    std::string sha256 = {};
    std::string motion = {};
    std::string method = {};
    double weakened_db = 0.0;
    std::optional<double> value = {};
    std::optional<listed_level> level = {};
};

/// Path that an observer is predicted to feel.
struct listed_prediction {
    std::string observer = {};
    std::string motion = {};
    std::string method = {};
    std::string felt = {};
};

/// Thresholds of the array, and who was measured how.
struct listed_calibration {
    calibration_origin origin = {};
    std::vector<std::string> warnings = {};
};

/// Number of a serial port's baud rate.
struct listed_serial {
    unsigned baud = 0;
};

/// Channel, lines and ports of a session's codes, and the meanings of its numbers.
struct listed_codes {
    std::optional<unsigned> channel = {};
    std::optional<double> bit_ms = {};
    std::optional<std::vector<unsigned>> lines = {};
    std::optional<listed_serial> serial = {};
    std::optional<bool> lsl = {};
    std::optional<detail::by_name<std::string>> numbers = {};
};

/// The definition of a session's experiment.
struct listed_definition {
    std::string name = {};
    std::string sha256 = {};
    std::string text = {};
};

struct listed_versions {
    std::string tactor = {};
    std::string build = {};
};

/// Pulses that showed the numbers of stimuli on lines or at a serial port. Times are relative to the first
/// samples at the DAC.
struct listed_pulses {
    std::uint64_t sent = 0;
    std::uint64_t missed = 0;
    double mean_late_s = 0.0;
    double worst_late_s = 0.0;
};

/// A time at which the device was opened.
struct listed_stream {
    unsigned stream = 0;
    std::string opened = {};
    std::string device = {};
    std::optional<std::string> masker = {};
    std::optional<listed_noise> masking = {};
    std::string display = {};
    std::string format = {};
    unsigned period_frames = 0;
    unsigned buffer_frames = 0;
    bool realtime = false;
    bool locked_memory = false;
    std::optional<listed_pulses> pulses = {};
};

/// A tactor that the participant felt in the walk over the array.
struct listed_step {
    unsigned tactor = 0;
    std::string asked = {};
};

/// Everything that session.json can have. A new session has neither the consent nor later members.
struct session_record {
    std::string participant = {};
    bool simulated = false;
    std::optional<std::string> simulation = {};
    std::uint64_t seed = 0;
    std::optional<std::string> group = {};
    std::optional<unsigned> session = {};
    std::optional<std::size_t> order_row = {};
    std::vector<std::string> order = {};
    listed_level level = {};
    std::optional<std::string> hand = {};
    std::optional<detail::by_name<std::vector<double>>> rests_s = {};
    array tactors = {};
    bool thresholds_assumed = false;
    std::optional<listed_calibration> calibration = {};
    std::optional<listed_codes> codes = {};
    unsigned rate = 0;
    unsigned channels = 0;
    std::optional<listed_noise> masking = {};
    std::optional<std::string> masker = {};
    std::vector<listed_stimulus> stimuli = {};
    std::optional<std::vector<listed_prediction>> predictions = {};
    listed_definition experiment = {};
    listed_versions versions = {};
    std::optional<std::string> device = {};
    std::optional<std::string> sound_server = {};
    std::optional<std::string> masker_sound_server = {};
    std::vector<listed_stream> streams = {};
    std::optional<std::string> date = {};
    std::optional<std::string> consent = {};
    std::optional<std::vector<listed_step>> walk = {};
    std::optional<detail::by_name<std::vector<std::string>>> answers = {};
};

/// Returns the content that session.json has when a session begins.
nlohmann::ordered_json describe_session(const prepared_experiment& p,
                                        const std::optional<simulation>& simulate, const std::string& masker);

/// Returns the schema of session.json.
nlohmann::ordered_json session_schema();

/// Returns the level in render options.
listed_level list_level(const render_options& o);

/// Returns the noise of a definition, if any.
std::optional<listed_noise> list_noise(const masking_definition& m);

/// Returns all stimuli of a session.
std::vector<listed_stimulus> list_stimuli(const prepared_experiment& p);

template <class Io, detail::either<listed_level> Level>
void members(Io& io, Level& v)
{
    constexpr detail::about one{"dB above each threshold, or the carrier's peak; the other is null"};
    io.describe_or_null("sl_db", v.sl_db, one);
    io.describe_or_null("dbfs", v.dbfs, {one.text, detail::up_to_0});
}

template <class Io, detail::either<listed_noise> Noise>
void members(Io& io, Noise& v)
{
    io.one_of("noise", v.color, {"white", "pink"}, {"white or pink"});
    io("level_dbfs", v.level_dbfs, {"root mean square, dBFS", detail::up_to_0});
    io("fade_s", v.fade_s, {"duration of each fade", detail::from_0});
    io.one_of("while", v.duration, {"stimulus", "run"}, {"stimulus or run"});
}

template <class Io, detail::either<listed_stimulus> Stimulus>
void members(Io& io, Stimulus& v)
{
    constexpr detail::about names{"SHA-256 of its plans, and its motion and method"};
    io("sha256", v.sha256, names);
    io("motion", v.motion, names);
    io("method", v.method, names);
    io("weakened_db", v.weakened_db,
       {"how much it is weakened so that no tactor exceeds its level, 0 or below", detail::up_to_0});
    io("value", v.value, {"its value; only for a run that varies one"});
    io("level", v.level, {"its level; only for a method with its own"});
}

template <class Io, detail::either<listed_prediction> Prediction>
void members(Io& io, Prediction& v)
{
    constexpr detail::about names{"observer of {command:compare}, and motion and method of the stimulus"};
    io("observer", v.observer, names);
    io("motion", v.motion, names);
    io("method", v.method, names);
    io("felt", v.felt, {"the path, in the form of a drawing in the trials' tables"});
}

template <class Io, detail::either<listed_calibration> Calibration>
void members(Io& io, Calibration& v)
{
    auto& c = v.origin;
    io("participant", c.participant, {"code of the participant whose thresholds these are"});
    io("method", c.method, {"method and rule of the calibration"});
    io.describe_or_null("rule", c.rule, {"method and rule of the calibration"});
    io("carrier_hz", c.carrier_hz, {"carrier, and duration of each interval", detail::above_0});
    io("interval_s", c.interval_s, {"carrier, and duration of each interval", detail::above_0});
    io.describe_or_null("feedback", c.feedback,
                        {"whether the participant was told which answers were right"});
    io.describe_or_null("masker", c.masker, {"the masking noise; null without"});
    io.describe_or_null("date", c.date, {"when it began, UTC"});
    io.describe_or_null("seed", c.seed, {"its seed"});
    io("simulated", c.simulated, {"whether a model answered"});
    io.list("tactors", c.tactors, {"all that were measured"}, [](auto& inner, auto& m, std::size_t) {
        inner("tactor", m.tactor, {"its number"});
        inner.describe_or_null("threshold_dbfs", m.threshold_dbfs,
                               {"its threshold; null if it was not felt"});
        inner.describe_or_null("sd_db", m.sd_db,
                               {"standard deviation of the threshold's levels, or null", detail::from_0});
        inner("trials", m.trials, {"how many trials it had"});
        inner("posterior_sd_db", m.posterior_sd_db,
              {"only for QUEST+: the posterior standard deviation", detail::from_0});
    });
    io("warnings", v.warnings, {"why these thresholds may not hold for this session"});
}

template <class Io, detail::either<listed_serial> Serial>
void members(Io& io, Serial& v)
{
    io("baud", v.baud, {"baud rate", detail::above_0});
}

template <class Io, detail::either<listed_codes> Codes>
void members(Io& io, Codes& v)
{
    constexpr detail::about channel{"only with a channel for codes: which, and the duration of a bit",
                                    detail::from_0};
    io("channel", v.channel, channel);
    io("bit_ms", v.bit_ms, channel);
    io("lines", v.lines, {"only with GPIO lines for codes: their offsets"});
    io("serial", v.serial, {"only with a serial port for codes"});
    io("lsl", v.lsl, {"only with markers over LSL: true"});
    io("numbers", v.numbers, {"what each number means"});
}

template <class Io, detail::either<listed_definition> Definition>
void members(Io& io, Definition& v)
{
    constexpr detail::about name{"name, and SHA-256 of the definition's text"};
    io("name", v.name, name);
    io("sha256", v.sha256, name);
    io("text", v.text, {"the whole definition, TOML"});
}

template <class Io, detail::either<listed_versions> Versions>
void members(Io& io, Versions& v)
{
    io("tactor", v.tactor, {"version, and compiler and libraries"});
    io("build", v.build, {"version, and compiler and libraries"});
}

template <class Io, detail::either<listed_pulses> Pulses>
void members(Io& io, Pulses& v)
{
    constexpr detail::about counts{"how many were sent, and how many failed or would have been too late"};
    constexpr detail::about late{"how late they were relative to the clock of the DAC, s"};
    io("sent", v.sent, counts);
    io("missed", v.missed, counts);
    io("mean_late_s", v.mean_late_s, late);
    io("worst_late_s", v.worst_late_s, late);
}

template <class Io, detail::either<listed_stream> Stream>
void members(Io& io, Stream& v)
{
    io("stream", v.stream, {"its number in the tables, from 1", detail::above_0});
    io("opened", v.opened, {"when, UTC"});
    io("device", v.device, {"the PCM"});
    io.describe_or_null("masker", v.masker, {"the PCM of the masking noise, and the noise; null without"});
    io.describe_or_null("masking", v.masking, {"the PCM of the masking noise, and the noise; null without"});
    io.one_of("display", v.display, {"page", "terminal with animation", "terminal without animation"},
              {"what showed the participant the questions: page, terminal with animation or terminal without "
               "animation"});
    io("format", v.format, {"the sample format"});
    constexpr detail::about sizes{"frames of a period and of the buffer", detail::above_0};
    io("period_frames", v.period_frames, sizes);
    io("buffer_frames", v.buffer_frames, sizes);
    constexpr detail::about rights{
        "whether the audio thread had real-time priority, and the memory was locked"};
    io("realtime", v.realtime, rights);
    io("locked_memory", v.locked_memory, rights);
    io("pulses", v.pulses,
       {"only with codes on lines or at a serial port: pulses with the numbers of stimuli"});
}

template <class Io, detail::either<listed_step> Step>
void members(Io& io, Step& v)
{
    io("tactor", v.tactor, {"which, and when it was felt, UTC"});
    io("asked", v.asked, {"which, and when it was felt, UTC"});
}

template <class Io, detail::either<session_record> Record>
void members(Io& io, Record& v)
{
    constexpr detail::about server{
        "the sound server between the program and the card, and that of the masking "
        "noise; null without"};
    io.constant("schema", own_schema);
    io("participant", v.participant, {"code"});
    io("simulated", v.simulated, {"whether a model answered"});
    io.describe_or_null("simulation", v.simulation, {"the model, in the form of --simulate, or null"});
    io("seed", v.seed, {"seed of the trials"});
    io("group", v.group, {"only in a definition with groups"});
    io("session", v.session,
       {"number of the session; only for a definition with several sessions", detail::above_0});
    io("order_row", v.order_row,
       {"only if the row of the orders does not follow from the code, or a run has blocks", detail::above_0});
    io("order", v.order, {"names of the runs, in this session's order"});
    io("level", v.level, {"level of the walk, and of stimuli without their own"});
    io("hand", v.hand, {"only with --hand: left or right"});
    io("rests_s", v.rests_s, {"only if rests are drawn: the rest before each trial, by run"});
    io.object("array", {"the array"}, [&v](auto& inner) {
        inner("name", v.tactors.name, {"its name"});
        inner.list("tactors", v.tactors.tactors, {"all of them, in order"},
                   [](auto& one, auto& t, std::size_t number) {
                       files::describe_tactor_members(one, t, number);
                       one("actuator", t.actuator, {"kind of actuator"});
                   });
    });
    io.describe_derived("thresholds_dbfs",
                        [&v] {
                            std::vector<files::thresholds> all;
                            for (const tactor_spec& t : v.tactors.tactors)
                                all.push_back(files::find_thresholds(t));
                            return all;
                        },
                        {"threshold of each tactor"});
    io("thresholds_assumed", v.thresholds_assumed, {"whether a threshold was assumed, not measured"});
    io.describe_or_null("calibration", v.calibration, {"how the thresholds were measured, or null"});
    io("codes", v.codes, {"only with [sync] code: how codes are sent"});
    io("rate", v.rate, {"sample rate, Hz, and number of channels", detail::above_0});
    io("channels", v.channels, {"sample rate, Hz, and number of channels", detail::above_0});
    io.describe_or_null("masking", v.masking, {"noise that hides the sound of the array, or null"});
    io.describe_or_null("masker", v.masker, {"the PCM of the masking noise, or null"});
    io("stimuli", v.stimuli, {"all stimuli"});
    io("predictions", v.predictions,
       {"only with runs in which participants draw: what observers would feel"});
    io("experiment", v.experiment, {"the experiment"});
    io("versions", v.versions, {"the program"});
    io.describe_or_null("device", v.device, {"the PCM; null if a model answered"});
    io.describe_or_null("sound_server", v.sound_server, server);
    io.describe_or_null("masker_sound_server", v.masker_sound_server, server);
    io("streams", v.streams, {"each opening of the device"});
    io.describe_or_null("date", v.date, {"when the session began, UTC; null if a model answered"});
    io("consent", v.consent, {"only after a consent: when the participant agreed, UTC"});
    io("walk", v.walk, {"only with a person: the tactors that the participant felt"});
    io("answers", v.answers, {"only while a questionnaire is being answered: its answers so far"});
}

} // namespace tactor::study
