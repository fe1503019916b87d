// SPDX-License-Identifier: MIT
#include "study/calibrate/log.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "files/output_file.hpp"
#include "files/text_file.hpp"
#include "study/bids/disk.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json; // differences are told in the order of the options

// What somebody else wrote is no beginning: it is neither taken nor replaced.
ordered_json parse_settings(const fs::path& file, const calibration_settings& s)
{
    ordered_json j = ordered_json::parse(read_file(file), nullptr, false);
    const ordered_json all = ordered_json::parse(settings_text(s));
    bool ours = j.is_object();
    for (const auto& [key, value] : all.items())
        ours = ours && j.contains(key);
    if (!ours || !j["date"].is_string())
        throw error(error_kind::bad_input, file.string(), "it does not say how a calibration was begun",
                    "begin another, with another log");
    return j;
}

// The date is that of the beginning, and a device may be another; all else must be alike.
void take_beginning(const fs::path& file, calibration_settings& s)
{
    const ordered_json began = parse_settings(file, s);
    s.date = began["date"].get<std::string>();
    const ordered_json now = ordered_json::parse(settings_text(s));
    for (const auto& [key, value] : now.items())
        if (key != "masker_pcm" && began[key] != value)
            throw error(error_kind::bad_input, file.string(),
                        fmt::format("the session was begun with {} {}, and {} is asked for", key,
                                    began[key].dump(), value.dump()),
                        "a session goes on as it was begun");
}

std::string new_log()
{
    std::string header;
    for (const auto& [column, cell] : log_cells({}))
        header += fmt::format("{}{}", header.empty() ? "" : "\t", column);
    return header + '\n';
}

bool lacks_header(const std::string& log)
{
    const std::string header = new_log();
    return log.size() + 1 < header.size() && header.starts_with(log);
}

// What a user can name wrongly; all else the system refuses.
bool bad_name(int code)
{
    return code == ENOENT || code == ENOTDIR || code == EISDIR || code == ELOOP || code == ENAMETOOLONG;
}

} // namespace

fs::path settings_file(const fs::path& log)
{
    return fs::path(log).replace_extension(".json");
}

void check_beginning(const fs::path& log, calibration_settings& s)
{
    const fs::path beginning = settings_file(log);
    if (!there(beginning))
        throw error(error_kind::bad_input, beginning.string(),
                    "it is missing, which says how the session was begun", "begin another, with other names");
    take_beginning(beginning, s);
}

calibration_log::calibration_log(fs::path file, bool resume, calibration_settings& s)
    : file_(std::move(file)), synced_(s.simulate.empty()), lines_(file_, new_log())
{
    if (const fs::path beginning = settings_file(file_); there(beginning)) { // before anything is written
        calibration_settings tried = s;
        if (resume)
            take_beginning(beginning, tried);
        else
            parse_settings(beginning, tried);
    }
    made_ = !there(file_) && !there(settings_file(file_));
    open();
    try {
        settle(resume, s);
    } catch (...) {
        remove_empty();
        throw;
    }
}

calibration_log::~calibration_log()
{
    remove_empty();
}

// Locked: nobody else writes them.
void calibration_log::remove_empty() const noexcept
{
    if (!made_ || lines_.rows() > 0)
        return;
    std::error_code ignored;
    fs::remove(settings_file(file_), ignored);
    fs::remove(file_, ignored);
}

// O_NONBLOCK: somebody's pipe is not waited for.
void calibration_log::open()
{
    fd_ =
        detail::owned_fd(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666));
    struct stat is {};
    if (!fd_)
        throw error(bad_name(errno) ? error_kind::bad_input : error_kind::runtime, file_.string(),
                    errno == ELOOP ? "it is a link" : std::strerror(errno), "name a log that can be written");
    if (::fstat(fd_.get(), &is) != 0 || !S_ISREG(is.st_mode))
        throw error(error_kind::bad_input, file_.string(), "it is no regular file", "name another log");
    if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0)
        throw error(error_kind::bad_input, file_.string(), "another session is writing it",
                    "end that one first, or name another log");
}

void calibration_log::settle(bool resume, calibration_settings& s)
{
    const fs::path beginning = settings_file(file_);
    const bool begun = there(beginning);
    lines_ = read_lines();
    // One in which nothing was answered, as where the device was not there, is begun anew.
    if (!resume && lines_.rows() > 0)
        throw error(error_kind::bad_input, file_.string(), "there is such a file already",
                    "--resume goes on with the session that it is of; another needs other names");
    if (begun && resume) {
        take_beginning(beginning, s);
    } else if (lines_.rows() > 0) {
        throw error(error_kind::bad_input, beginning.string(),
                    "it is missing, which says how the log was begun", "begin another, with another log");
    } else {
        const std::string said = settings_text(s);
        detail::output_file out(beginning, {}, detail::owner_kind::program);
        out.write(said.data(), static_cast<std::int64_t>(said.size()));
        out.commit();
    }
    if (synced_)
        detail::sync_folder(file_.parent_path()); // the log has a name that must last, too
}

// A log whose header is cut off has no line; nor has an empty one.
text_table calibration_log::read_lines() const
{
    const std::string text = read_file(file_);
    if (lacks_header(text))
        return {file_, new_log()};
    detail::refuse_no_text(text, file_.string(), "name the log, with tabs between the columns");
    for (const auto& [column, cell] : log_cells({}))
        if (text.find(column) == text.npos)
            throw error(error_kind::bad_input, file_.string(), "it is no log of a calibration",
                        "name another log");
    text_table t(file_, text, last_line::may_be_cut);
    if (t.is_open() && t.columns().back() == "onset_frame")
        if (const auto frame = t.cell(t.rows() - 1, "onset_frame"); frame && frame->starts_with('n'))
            t.leave_out_last(); // n/a, cut off
    return t;
}

std::optional<fs::path> calibration_log::begin()
{
    std::optional<fs::path> kept;
    const std::string text = read_file(file_);
    const bool anew = lacks_header(text);
    if (lines_.cut_at() || (anew && !text.empty()))
        kept = cut_file(file_, lines_.cut_at().value_or(0));
    else if (const std::string end = lines_.missing_end(); !end.empty())
        append_text(file_, end, synced_);
    if (anew)
        append_text(file_, new_log(), synced_);
    return kept;
}

void calibration_log::append(const calibration_record& r)
{
    append_text(file_, lines_.line(log_cells(r)), synced_);
    made_ = false;
}

} // namespace tactor::study
