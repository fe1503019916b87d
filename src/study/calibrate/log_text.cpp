// SPDX-License-Identifier: MIT
// What stands in the log, and beside it.
#include <charconv>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "study/calibrate/log.hpp"

namespace tactor::study {
namespace {

constexpr std::string_view missing = "n/a";
constexpr std::size_t columns = 10;

std::string_view truth(bool b)
{
    return b ? "true" : "false";
}

template <typename T>
std::optional<T> number_in(std::string_view cell)
{
    T v{};
    const auto [stop, code] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
    if (code != std::errc() || stop != cell.data() + cell.size())
        return {};
    return v;
}

// Whatever the line says: what it should say is compared afterwards.
calibration_answer answer_in(std::string_view line)
{
    const auto cells = detail::split(line, '\t');
    if (cells.size() != columns)
        return {};
    calibration_answer a;
    a.interval = number_in<unsigned>(cells[4]).value_or(0);
    if (cells[4] == "set")
        a.set_dbfs = number_in<double>(cells[2]);
    a.response_time_s = number_in<double>(cells[8]);
    a.onset_frame = number_in<std::uint64_t>(cells[9]);
    return a;
}

} // namespace

std::string_view log_header()
{
    return "trial\ttactor\tlevel_dbfs\tinterval\tresponse\tcorrect\treversal\tpractice\tresponse_time_s\t"
           "onset_frame";
}

std::string log_line(const calibration_record& r)
{
    const calibration_trial& t = r.trial;
    return fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}", t.number, t.tactor, t.level_dbfs,
                       t.interval != 0 ? fmt::format("{}", t.interval) : missing, r.response,
                       r.correct ? truth(*r.correct) : missing, truth(r.reversal), truth(t.practice),
                       r.response_time_s ? fmt::format("{:.3f}", *r.response_time_s) : missing,
                       r.onset_frame ? fmt::format("{}", *r.onset_frame) : missing);
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
    std::size_t at = 1;
    for (const std::string& line : log.lines()) {
        const source_place place{log.file().string(), static_cast<unsigned>(++at), 0};
        if (c.done())
            throw error(error_kind::bad_input, place, "the session ends before this line",
                        "the log is not of this session; begin another, with another log");
        const calibration_trial trial = c.next();
        const calibration_answer own = simulated != nullptr ? simulated->answer(trial) : answer_in(line);
        const bool possible = trial.interval == 0 || own.interval == 1 || own.interval == 2;
        std::string expected = "another answer";
        if (possible)
            expected = log_line(c.answer(own));
        if (expected != line)
            throw error(error_kind::bad_input, place, "this is not how the session went",
                        "the log was changed, or is not of this session; begin another, with another log");
    }
}

} // namespace tactor::study
