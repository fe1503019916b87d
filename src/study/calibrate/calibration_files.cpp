// SPDX-License-Identifier: MIT
#include "study/calibrate/calibration_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/output_file.hpp"
#include "files/setup_text.hpp"
#include "study/bids/disk.hpp"
#include "study/data/text_table.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json; // messages list differences in the order of the options

// Reads the settings. Throws error (bad_input) for a file of another program, so that it is not replaced.
ordered_json parse_settings(const fs::path& file, const calibration_settings& s)
{
    ordered_json j = ordered_json::parse(read_file(file), nullptr, false);
    const ordered_json all = ordered_json::parse(settings_text(s));
    bool ours = j.is_object();
    for (const auto& [key, value] : all.items())
        ours = ours && j.contains(key);
    if (!ours || !j["date"].is_string())
        throw error(error_kind::bad_input, file.string(), "it lacks the settings of the calibration",
                    "start a new calibration with another log");
    return j;
}

// Copies the date of the session's start from `file`. Throws error (bad_input) if any setting differs, except
// the noise device.
void copy_start_date(const fs::path& file, calibration_settings& s)
{
    const ordered_json began = parse_settings(file, s);
    s.date = began["date"].get<std::string>();
    const ordered_json now = ordered_json::parse(settings_text(s));
    for (const auto& [key, value] : now.items())
        if (key != "masker_pcm" && began[key] != value)
            throw error(error_kind::bad_input, file.string(),
                        key == "array_sha256" ? "the array has changed since the session began"
                                              : fmt::format("the session began with {} {}, but now it is {}",
                                                            key, began[key].dump(), value.dump()),
                        "continue with the same array and options");
}

// Returns the name of the settings file: the name of the log with the extension .json.
fs::path settings_file(const fs::path& log)
{
    return fs::path(log).replace_extension(".json");
}

const std::string not_there = "n/a";

// Returns the cells of a line, in the order of a new log's columns.
named_cells log_cells(const calibration_record& r)
{
    const calibration_trial& t = r.trial;
    return {{"trial", fmt::format("{}", t.number)},
            {"tactor", fmt::format("{}", t.tactor)},
            {"level_dbfs", fmt::format("{}", t.level_dbfs)},
            {"interval", t.interval != 0 ? fmt::format("{}", t.interval) : not_there},
            {"response", r.response},
            {"correct", r.correct ? fmt::format("{}", *r.correct) : not_there},
            {"reversal", fmt::format("{}", r.reversal)},
            {"practice", fmt::format("{}", t.practice)},
            {"response_time_s", r.response_time_s ? fmt::format("{:.3f}", *r.response_time_s) : not_there},
            {"onset_frame", r.onset_frame ? fmt::format("{}", *r.onset_frame) : not_there}};
}

bool lacks_header(const std::string& log)
{
    const std::string header = header_line(log_cells({}));
    return log.size() + 1 < header.size() && header.starts_with(log);
}

constexpr double most_frame = 9e15; // a double is exact up to here

// Reads the answer in a line without checks: replay() compares the line with the expected line afterwards.
calibration_answer read_logged_answer(const text_table& log, std::size_t row)
{
    const auto number = [&](std::string_view column) {
        const auto cell = log.cell(row, column);
        return cell ? detail::parse_number_text<double>(*cell) : std::nullopt;
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

// Compares a cell with the expected text. Other programs may write numbers with more or fewer digits, and
// true and false in capitals.
bool is_same(const std::string& expected, std::optional<std::string_view> cell)
{
    if (!cell)
        return expected == not_there;
    if (expected == *cell || expected == to_lower_case(std::string(*cell)))
        return true;
    const auto number = detail::parse_number_text<double>(expected);
    return number && number == detail::parse_number_text<double>(*cell);
}

bool is_same(const named_cells& expected, const text_table& log, std::size_t row)
{
    return std::ranges::all_of(expected,
                               [&](const auto& c) { return is_same(c.second, log.cell(row, c.first)); });
}

template <typename T>
void add(std::string& to, std::string_view key, const std::optional<T>& v)
{
    if (v)
        to += fmt::format("{} = {}\n", key, *v);
}

std::string threshold_text(const tactor_threshold& t, calibration_method m)
{
    const bool stairs = m == calibration_method::staircase;
    std::string s = fmt::format("\n[[calibration.tactor]]\ntactor = {}\n", t.tactor);
    add(s, "threshold_dbfs", t.threshold_dbfs);
    add(s, "sd_db", t.sd_db);
    add(s, "posterior_sd_db", t.posterior_sd_db);
    s += fmt::format("trials = {}\n", t.trials);
    if (asks(m))
        s += fmt::format("reversals_dbfs = [{}]\n", fmt::join(t.reversals_dbfs, ", "));
    add(s, "check_right", t.check_right);
    add(s, "check_below_right", t.check_below_right);
    if (stairs)
        s += fmt::format("staircases = {}\n", t.staircases);
    return s;
}

constexpr double most_above_median_db = 12.0;

} // namespace

void check_log_settings(const fs::path& log, calibration_settings& s)
{
    const fs::path beginning = settings_file(log);
    if (!is_on_disk(beginning))
        throw error(error_kind::bad_input, beginning.string(),
                    "it is missing, so the session's settings are unknown",
                    "restore the file, or start a new calibration with another file name");
    copy_start_date(beginning, s);
}

calibration_log::calibration_log(fs::path file, bool resume, calibration_settings& s)
    : file_(std::move(file)), synced_(s.simulate.empty()), lines_(file_, header_line(log_cells({})))
{
    const fs::path beginning = settings_file(file_);
    const bool begun = is_on_disk(beginning);
    if (begun && resume)
        copy_start_date(beginning, s);
    else if (begun)
        parse_settings(beginning, s);
    made_ = !begun && !is_on_disk(file_);
    if (resume && made_)
        throw error(error_kind::bad_input, "--resume", fmt::format("there is no log {}", file_.string()),
                    "correct -o or --log, or leave out --resume to begin a new session");
    open();
    try {
        lines_ = read_lines();
        // A log without answers may be reused: for example, the device was missing in an earlier attempt.
        if (!resume && lines_.rows() > 0)
            throw error(error_kind::bad_input, file_.string(), "it exists",
                        "use --resume to continue its session, or other file names to begin a new session");
        if (!begun && lines_.rows() > 0)
            throw error(error_kind::bad_input, beginning.string(),
                        "it is missing, so the log's settings are unknown",
                        "start a new calibration with another log");
        if (!begun || !resume)
            detail::write_file(beginning, settings_text(s), detail::owner_kind::program);
        if (synced_)
            detail::sync_folder(file_.parent_path()); // so that the log's name also survives a crash
    } catch (...) {
        remove_empty_log();
        throw;
    }
}

calibration_log::~calibration_log()
{
    remove_empty_log();
}

// Removes log and settings if there is no answer. Other processes cannot write them, because the log is
// locked.
void calibration_log::remove_empty_log() const noexcept
{
    if (!made_ || lines_.rows() > 0)
        return;
    std::error_code ignored;
    fs::remove(settings_file(file_), ignored);
    fs::remove(file_, ignored);
}

// Opens and locks the log. O_NONBLOCK: does not wait for the other end of a pipe.
void calibration_log::open()
{
    fd_ =
        detail::owned_fd(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666));
    struct stat is {};
    const int code = errno;
    const bool bad_name =
        code == ENOENT || code == ENOTDIR || code == EISDIR || code == ELOOP || code == ENAMETOOLONG;
    if (!fd_)
        throw error(bad_name ? error_kind::bad_input : error_kind::runtime, file_.string(),
                    code == ELOOP ? "it is a link" : std::strerror(code),
                    code == ENAMETOOLONG ? "use a shorter name" : "name a log that can be written");
    if (::fstat(fd_.get(), &is) != 0 || !S_ISREG(is.st_mode))
        throw error(error_kind::bad_input, file_.string(), "it is not a regular file", "name another log");
    if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0)
        throw error(error_kind::bad_input, file_.string(), "another session is writing it",
                    "end that session first, or name another log");
}

// Reads the lines. Returns a table without rows if the log is empty or the header is cut off.
text_table calibration_log::read_lines() const
{
    const std::string text = read_file(file_);
    if (lacks_header(text))
        return {file_, header_line(log_cells({}))};
    text_table t(file_, text, last_line::may_be_cut);
    for (const auto& [column, cell] : log_cells({}))
        if (!t.has(column))
            throw error(error_kind::bad_input, file_.string(), "it is not the log of a calibration",
                        "name another log");
    if (t.is_open() && t.columns().back() == "onset_frame")
        if (const auto frame = t.cell(t.rows() - 1, "onset_frame"); frame && frame->starts_with('n'))
            t.drop_last_row(); // an n/a that is cut off
    return t;
}

std::optional<fs::path> calibration_log::begin()
{
    std::optional<fs::path> kept;
    const std::string text = read_file(file_);
    const bool anew = lacks_header(text);
    if (lines_.cut_position() || (anew && !text.empty()))
        kept = split_file(file_, lines_.cut_position().value_or(0));
    else if (const std::string end = lines_.missing_end(); !end.empty())
        append_text(file_, end, synced_);
    if (anew)
        append_text(file_, header_line(log_cells({})), synced_);
    return kept;
}

void calibration_log::append(const calibration_record& r)
{
    append_text(file_, lines_.line(log_cells(r)), synced_);
    made_ = false;
}

std::string settings_text(const calibration_settings& s)
{
    const bool stairs = s.method == calibration_method::staircase;
    const auto if_stairs = [&](nlohmann::ordered_json v) { return stairs ? std::move(v) : nullptr; };
    const auto if_asked = [&](nlohmann::ordered_json v) { return asks(s.method) ? std::move(v) : nullptr; };
    nlohmann::ordered_json j{{"participant", s.participant},
                             {"method", std::string(to_string(s.method))},
                             {"rule", if_stairs(rule_name(s))},
                             {"tactors", s.tactors},
                             {"max_dbfs", s.ceilings_dbfs},
                             {"carrier_hz", s.carrier_hz},
                             {"interval_s", s.interval_s},
                             {"start_dbfs", s.start_dbfs()},
                             {"steps_db", if_stairs(s.staircase.steps_db)},
                             {"reversals", if_stairs(s.staircase.reversals)},
                             {"discard", if_stairs(s.staircase.discard)},
                             {"feedback", if_asked(s.feedback)},
                             {"practice", if_asked(s.practice)},
                             {"masker", s.masker.empty() ? "none" : s.masker},
                             {"masker_pcm", s.masker.empty() ? "none" : s.masker_pcm},
                             {"seed", s.seed},
                             {"simulate", files::or_null(s.simulate)},
                             {"array_sha256", s.array},
                             {"date", s.date}};
    if (s.method == calibration_method::quest) { // only for quest, so that older sessions can resume
        j["trials"] = s.trials;
        j["stop_sd_db"] = files::or_null(s.stop_sd_db);
    }
    return json_text(j);
}

void replay(calibration& c, const calibration_log& log, observer* simulated)
{
    const text_table& lines = log.lines();
    for (std::size_t row = 0; row < lines.rows(); ++row) {
        if (c.done())
            lines.refuse(row, "the session of these settings ends before this line",
                         "start a new calibration with another log");
        const calibration_trial trial = c.next();
        const calibration_answer own =
            simulated != nullptr ? simulated->answer(trial) : read_logged_answer(lines, row);
        const bool possible = trial.interval == 0 || own.interval == 1 || own.interval == 2;
        if (!possible || !is_same(log_cells(c.answer(own)), lines, row))
            lines.refuse(row, "the line does not match the session's settings",
                         "start a new calibration with another log");
    }
}

std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds)
{
    std::string t = fmt::format("\n[calibration]\nparticipant = {}\nmethod = \"{}\"\n",
                                detail::toml_string(s.participant), to_string(s.method));
    if (s.method == calibration_method::staircase)
        t += fmt::format("rule = \"{}\"\n", rule_name(s));
    t += fmt::format("carrier_hz = {}\ninterval_s = {}\n", s.carrier_hz, s.interval_s);
    if (asks(s.method))
        t += fmt::format("feedback = {}\n", s.feedback);
    t += fmt::format(
        "masker = {}\ndate = {}\nseed = {}\nsimulated = {}\n",
        detail::toml_string(s.masker.empty() ? "none" : fmt::format("{}, {}", s.masker, s.masker_pcm)),
        detail::toml_string(s.date), s.seed, !s.simulate.empty());
    for (const tactor_threshold& one : thresholds)
        t += threshold_text(one, s.method);
    return t;
}

void check_new_output(const std::filesystem::path& file)
{
    if (is_on_disk(file))
        throw error(error_kind::bad_input, file.string(), "it exists",
                    "choose another name: tactor does not overwrite this file");
    check_file_creation(file);
}

void write_new_output(const std::filesystem::path& file, const std::string& text)
{
    check_new_output(file);
    write_whole_file(file, text);
}

void check_calibration_result(const std::filesystem::path& file, const calibration_settings& s)
{
    read_file(file); // throws if it is not a regular file
    const auto written = load_setup(file).calibration;
    std::vector<unsigned> tactors;
    if (written)
        for (const calibrated_tactor& t : written->tactors)
            tactors.push_back(t.tactor);
    if (!written || is_foreign(*written, s) || written->method != to_string(s.method) ||
        written->carrier_hz != s.carrier_hz || written->interval_s != s.interval_s ||
        written->seed != s.seed || written->date != s.date || tactors != s.tactors)
        throw error(error_kind::bad_input, file.string(), "it does not match the result of this session",
                    "choose another name: tactor does not overwrite this file");
}

bool is_foreign(const calibration_origin& earlier, const calibration_settings& s)
{
    return earlier.participant != s.participant || earlier.simulated == s.simulate.empty();
}

array merge_thresholds(array a, const std::optional<calibration_origin>& earlier,
                       const calibration_settings& s, const std::vector<tactor_threshold>& thresholds)
{
    const bool foreign = earlier && is_foreign(*earlier, s);
    const bool goes_on = earlier && !foreign;
    const bool elsewhere = goes_on && earlier->carrier_hz != s.carrier_hz;
    // [calibration] will describe this session. A threshold_dbfs without a frequency must then be from this
    // participant and at this carrier.
    for (tactor_spec& t : a.tactors) {
        if (foreign) {
            t.threshold_dbfs.reset();
            t.thresholds.clear();
        } else if (elsewhere && t.threshold_dbfs) {
            t.thresholds = {{earlier->carrier_hz, *std::exchange(t.threshold_dbfs, {})}};
        }
    }
    for (const tactor_threshold& measured : thresholds) {
        tactor_spec& t = a.tactors[measured.tactor];
        t.threshold_dbfs.reset();
        if (!goes_on)
            t.thresholds.clear();
        std::erase_if(t.thresholds, [&](const threshold_point& p) { return p.hz == s.carrier_hz; });
        if (t.thresholds.empty()) {
            t.threshold_dbfs = measured.threshold_dbfs;
            continue;
        }
        if (!measured.threshold_dbfs)
            continue;
        const threshold_point here{s.carrier_hz, *measured.threshold_dbfs};
        t.thresholds.insert(std::ranges::upper_bound(t.thresholds, here.hz, {}, &threshold_point::hz), here);
    }
    return a;
}

std::vector<doubtful_threshold> find_doubtful_thresholds(const array& a, const calibration_settings& s,
                                                         const std::vector<tactor_threshold>& measured)
{
    std::vector<std::optional<double>> all;
    std::vector<double> felt;
    for (const tactor_spec& t : a.tactors)
        if (all.push_back(threshold_at(t, s.carrier_hz)); all.back())
            felt.push_back(*all.back());
    const double usual_dbfs = median(std::move(felt)).value_or(0.0);
    std::vector<doubtful_threshold> doubtful;
    for (unsigned i = 0; i < all.size(); ++i) {
        if (!all[i])
            continue;
        const auto own = std::ranges::find(measured, i, &tactor_threshold::tactor);
        if (const double above = *all[i] - usual_dbfs; above > most_above_median_db)
            doubtful.push_back({i, fmt::format("it is {:.1f} dB above the array's median of {:.1f} dBFS",
                                               above, usual_dbfs)});
        else if (own != measured.end() && own->check_below_right.value_or(0) >= too_many_below)
            doubtful.push_back(
                {i, fmt::format("{} of {} answers 6 dB below it were right, even after a second staircase",
                                *own->check_below_right, check_count)});
    }
    return doubtful;
}

} // namespace tactor::study
