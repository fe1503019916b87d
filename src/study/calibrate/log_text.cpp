// SPDX-License-Identifier: MIT
// What stands in the log, and beside it.
#include <algorithm>
#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "study/calibrate/log.hpp"

namespace tactor::study {
namespace {

const std::string missing = "n/a";
constexpr double most_frame = 9e15; // a double counts them up to there

std::string truth(bool b)
{
    return b ? "true" : "false";
}

// Whatever the line says: what it should say is compared afterwards.
calibration_answer answer_in(const text_table& log, std::size_t row)
{
    const auto number = [&](std::string_view column) {
        const auto cell = log.cell(row, column);
        return cell ? detail::number_in<double>(*cell) : std::nullopt;
    };
    calibration_answer a;
    const double interval = number("response").value_or(0.0);
    a.interval = interval == 1.0 ? 1 : interval == 2.0 ? 2 : 0;
    if (log.cell(row, "response") == "set")
        a.set_dbfs = number("level_dbfs");
    a.response_time_s = number("response_time_s");
    const double frame = number("onset_frame").value_or(-1.0);
    if (frame >= 0.0 && frame < most_frame)
        a.onset_frame = static_cast<std::uint64_t>(frame);
    return a;
}

// Other programs write numbers with more or fewer digits and truths in capitals.
bool is_same(const std::string& expected, std::optional<std::string_view> cell)
{
    if (!cell)
        return expected == missing;
    if (expected == *cell || expected == in_small_letters(std::string(*cell)))
        return true;
    const auto number = detail::number_in<double>(expected);
    return number && number == detail::number_in<double>(*cell);
}

bool is_same(const named_cells& expected, const text_table& log, std::size_t row)
{
    return std::all_of(expected.begin(), expected.end(),
                       [&](const auto& c) { return is_same(c.second, log.cell(row, c.first)); });
}

} // namespace

named_cells log_cells(const calibration_record& r)
{
    const calibration_trial& t = r.trial;
    return {{"trial", fmt::format("{}", t.number)},
            {"tactor", fmt::format("{}", t.tactor)},
            {"level_dbfs", fmt::format("{}", t.level_dbfs)},
            {"interval", t.interval != 0 ? fmt::format("{}", t.interval) : missing},
            {"response", r.response},
            {"correct", r.correct ? truth(*r.correct) : missing},
            {"reversal", truth(r.reversal)},
            {"practice", truth(t.practice)},
            {"response_time_s", r.response_time_s ? fmt::format("{:.3f}", *r.response_time_s) : missing},
            {"onset_frame", r.onset_frame ? fmt::format("{}", *r.onset_frame) : missing}};
}

std::string settings_text(const calibration_settings& s)
{
    const bool stairs = s.method == calibration_method::staircase;
    const auto of_stairs = [&](nlohmann::ordered_json v) { return stairs ? std::move(v) : nullptr; };
    const nlohmann::ordered_json observer = s.simulate.empty() ? nullptr : nlohmann::ordered_json(s.simulate);
    const nlohmann::ordered_json j{{"participant", s.participant},
                                   {"method", stairs ? "staircase" : "adjustment"},
                                   {"rule", of_stairs(rule_name(s))},
                                   {"tactors", s.tactors},
                                   {"max_dbfs", s.ceilings_dbfs},
                                   {"carrier_hz", s.carrier_hz},
                                   {"interval_s", s.interval_s},
                                   {"start_dbfs", s.start_dbfs()},
                                   {"steps_db", of_stairs(s.staircase.steps_db)},
                                   {"reversals", of_stairs(s.staircase.reversals)},
                                   {"discard", of_stairs(s.staircase.discard)},
                                   {"feedback", of_stairs(s.feedback)},
                                   {"practice", of_stairs(s.practice)},
                                   {"masker", s.masker.empty() ? "none" : s.masker},
                                   {"masker_pcm", s.masker.empty() ? "none" : s.masker_pcm},
                                   {"seed", s.seed},
                                   {"simulate", observer},
                                   {"array_sha256", s.array},
                                   {"date", s.date}};
    return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void replay(calibration& c, const calibration_log& log, observer* simulated)
{
    const text_table& lines = log.lines();
    for (std::size_t row = 0; row < lines.rows(); ++row) {
        if (c.done())
            lines.refuse(row, "the session ends before this line",
                         "the log is not of this session; begin another, with another log");
        const calibration_trial trial = c.next();
        const calibration_answer own =
            simulated != nullptr ? simulated->answer(trial) : answer_in(lines, row);
        const bool possible = trial.interval == 0 || own.interval == 1 || own.interval == 2;
        if (!possible || !is_same(log_cells(c.answer(own)), lines, row))
            lines.refuse(row, "this is not how the session went",
                         "the log was changed, or is not of this session; begin another, with another log");
    }
}

} // namespace tactor::study
