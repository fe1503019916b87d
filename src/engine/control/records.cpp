// SPDX-License-Identifier: MIT
#include "engine/control/records.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/player.hpp>

#include "core/bounds.hpp"
#include "core/owned.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "rt/clock.hpp"
#include "rt/system_files.hpp"

namespace tactor::engine {
namespace {

constexpr std::string_view first_line = "tactor-drive-time 2";
constexpr std::string_view last_line = "\nend\n";
constexpr double ahead_s = 0.5;
constexpr std::int64_t renewed_ns = rt::ns_per_s / 10;
constexpr std::int64_t patience_ns = rt::ns_per_s / 5; // wait for a process that keeps the file locked
constexpr int patient_tries = 40;                      // attempts, 5 ms apart: as long as patience_ns
constexpr std::size_t longest_name = 200;              // longer names that begin alike share a file
constexpr double noticed_s = 1e-4;                     // levels in files are rounded
constexpr double longest_s = 3600.0;                   // no limit is above it

double seconds(std::int64_t ns)
{
    return static_cast<double>(ns) * 1e-9;
}

std::string describe(int code)
{
    return std::generic_category().message(code);
}

// Returns the identifier of this boot, the same in all containers.
std::string read_boot_id()
{
    const std::string id = rt::read_file("/proc/sys/kernel/random/boot_id");
    return id.substr(0, id.find('\n'));
}

bool is_own(const std::string& folder, mode_t closed_to)
{
    struct stat is = {};
    return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
           (is.st_mode & closed_to) == 0;
}

std::string file_name(std::string_view device)
{
    std::string name;
    for (const char c : device.substr(0, longest_name)) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           c == '-' || c == '_' || c == '.';
        name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return "drive-time-" + name.substr(0, longest_name);
}

struct place {
    std::string folder = {}; ///< empty if there is none
    std::string why = {};    ///< reason why there is none
};

/// Finds the folder for books, which is in the runtime folder. No other user can create files in it.
place prepare_book_folder()
{
    const std::string runtime = rt::runtime_folder();
    if (runtime.empty())
        return {.why = "there is no runtime folder (XDG_RUNTIME_DIR)"};
    if (!is_own(runtime, 0))
        return {.why = fmt::format("{} is not a folder of this user", runtime)};
    const std::string folder = runtime + "/tactor";
    if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
        return {.why = fmt::format("{}: {}", folder, describe(errno))};
    if (!is_own(folder, S_IWGRP | S_IWOTH))
        return {.why = fmt::format("{} must be a folder that only this user can write to", folder)};
    return {.folder = folder};
}

std::string make_book_path(const place& p, std::string_view device)
{
    return p.folder.empty() ? std::string() : p.folder + "/" + file_name(device);
}

/// A file that is open and locked against other processes.
class locked_file {
public:
    /// Opens and locks the file. Makes it with `text` if it does not exist.
    locked_file(const std::string& path, std::string_view text, int tries)
    {
        fd_ = open_book(path, O_RDWR);
        if (!fd_ && errno == ENOENT && make(path, text))
            fd_ = open_book(path, O_RDWR);
        code_ = fd_ ? 0 : errno;
        if (code_ == EROFS || code_ == EACCES)
            fd_ = open_book(path, O_RDONLY);
        struct stat is = {};
        if (!fd_) {
            busy_ = code_ == EMFILE || code_ == ENFILE || code_ == ENOMEM;
            exists_ = ::lstat(path.c_str(), &is) == 0;
        } else if (::fstat(fd_.get(), &is) != 0 || !S_ISREG(is.st_mode)) {
            code_ = EINVAL;
            exists_ = true;
            fd_ = {};
        } else if (!detail::lock_file(fd_, tries)) {
            busy_ = true;
            fd_ = {};
        }
    }
    /// Unlocks the file, even if a process that was forked meanwhile has it open.
    ~locked_file()
    {
        if (fd_)
            ::flock(fd_.get(), LOCK_UN);
    }
    locked_file(const locked_file&) = delete;
    locked_file& operator=(const locked_file&) = delete;

    bool open() const noexcept { return static_cast<bool>(fd_); }
    /// Returns true if a later attempt may open the file: another process keeps it locked, or this process
    /// has no descriptors or memory left.
    bool busy() const noexcept { return busy_; }
    /// Returns true if the file exists and cannot be opened.
    bool exists() const noexcept { return exists_; }
    /// Returns the error of the call that failed last.
    int code() const noexcept { return code_; }

    std::string read() const
    {
        std::string text;
        std::array<char, 4096> part{};
        for (ssize_t n = 1; n > 0 && text.size() < most_bytes;) {
            n = ::pread(fd_.get(), part.data(), part.size(), static_cast<off_t>(text.size()));
            text.append(part.data(), static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
        }
        return text;
    }
    /// Replaces the text of the file. Returns false on failure. If the process is killed between the two
    /// system calls, the end of the old text remains after the new one.
    bool write(const std::string& text) noexcept
    {
        if (code_ != 0) // the file can only be read
            return false;
        if (write_all(fd_, text) && ::ftruncate(fd_.get(), static_cast<off_t>(text.size())) == 0)
            return true;
        code_ = errno;
        return false;
    }

private:
    static constexpr std::size_t most_bytes = std::size_t{1} << 20;

    static detail::owned_fd open_book(const std::string& path, int flags) noexcept
    {
        return detail::owned_fd(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    }
    static bool write_all(const detail::owned_fd& file, std::string_view text) noexcept
    {
        const ssize_t n = ::pwrite(file.get(), text.data(), text.size(), 0);
        if (n >= 0 && n < static_cast<ssize_t>(text.size()))
            errno = ENOSPC;
        return n == static_cast<ssize_t>(text.size());
    }
    // Makes a complete file or none, because an incomplete file counts as if all channels were at the limit.
    static bool make(const std::string& path, std::string_view text)
    {
        const std::string unready = fmt::format("{}.{}", path, ::getpid());
        const detail::owned_fd file(
            ::open(unready.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600));
        if (!file)
            return false;
        const bool made =
            write_all(file, text) && (::link(unready.c_str(), path.c_str()) == 0 || errno == EEXIST);
        const int code = errno;
        ::unlink(unready.c_str());
        errno = code;
        return made;
    }

    detail::owned_fd fd_;
    bool busy_ = false;
    bool exists_ = false;
    int code_ = 0;
};

/// Levels of devices whose files cannot be written.
struct memory {
    std::mutex mutex;
    std::map<std::string, drive_levels> by_device;
};

memory& process_memory()
{
    static memory m;
    return m;
}

enum class fault_kind { none, not_kept, not_read, busy };

struct fault {
    fault_kind what = fault_kind::none;
    std::string why = {};
};

std::string text(const fault& f)
{
    return f.why + (f.what == fault_kind::not_kept
                        ? ": the next run will not know for how long the array was driven"
                        : ": each tactor counts as driven for as long as allowed");
}

fault read_fault(const std::string& path)
{
    return {fault_kind::not_read, path + " cannot be read completely"};
}

fault write_fault(const std::string& path, int code)
{
    return {fault_kind::not_kept, fmt::format("{} cannot be written: {}", path, describe(code))};
}

struct book_place {
    const std::string& device;
    const std::string& path; ///< empty if the book is in memory
    const std::string& boot;
    double limit_s;
};

drive_levels full_levels(double limit_s, std::int64_t now_ns)
{
    return {.levels_s = std::vector<double>(detail::max_channels, limit_s), .at_ns = now_ns};
}

/// Takes the levels of a device from its file or from memory, whichever are newer. Calls `change` with the
/// levels and the time, then stores the levels.
template <class Clock, class Change>
fault look_up(const book_place& at, const Clock& clock, int tries, Change change)
{
    memory& m = process_memory();
    const std::lock_guard lock(m.mutex);
    drive_levels& own = m.by_device[at.device];
    if (at.path.empty()) {
        change(own, clock());
        return {};
    }
    locked_file file(at.path, drive_levels().text(at.boot), tries);
    if (file.busy())
        return {fault_kind::busy, at.path + " is locked by another program"};
    const std::int64_t now_ns = clock();
    drive_levels l = own;
    fault f;
    if (file.open()) {
        const std::optional<drive_levels> kept = drive_levels::read(file.read(), at.boot, now_ns);
        if (!kept)
            f = read_fault(at.path);
        if (!kept || kept->at_ns >= own.at_ns)
            l = kept.value_or(full_levels(at.limit_s, now_ns));
    } else if (file.exists() && own.at_ns == 0) {
        f = read_fault(at.path);
        l = full_levels(at.limit_s, now_ns);
    }
    change(l, now_ns);
    if (file.open() && file.write(l.text(at.boot))) {
        m.by_device.erase(at.device);
        return f;
    }
    own = std::move(l);
    return f.what != fault_kind::none ? f : write_fault(at.path, file.code());
}

} // namespace

void drive_levels::add(std::span<const double> drive_s, std::int64_t now_ns, const drive_law& law)
{
    const double passed_s = seconds(std::max<std::int64_t>(now_ns - at_ns, 0));
    levels_s.resize(std::max(levels_s.size(), drive_s.size()));
    for (std::size_t i = 0; i < levels_s.size(); ++i) {
        const double drive = i < drive_s.size() ? drive_s[i] : 0.0;
        // Entries of other runs have counted a part of this time as rest, so the remaining rest may be
        // negative.
        const double rested = std::min(levels_s[i], law.limit_s) - law.leak * (passed_s - drive);
        levels_s[i] = std::min(std::max(rested, 0.0) + drive, law.limit_s);
    }
    at_ns = std::max(at_ns, now_ns);
}

void drive_levels::advance(std::int64_t now_ns, const drive_law& law)
{
    std::sort(runs.begin(), runs.end(), [](const run& a, const run& b) { return a.until_ns < b.until_ns; });
    while (!runs.empty() && runs.front().until_ns <= now_ns) {
        add(std::vector<double>(levels_s.size(), ahead_s), runs.front().until_ns, law);
        runs.erase(runs.begin());
    }
}

std::string drive_levels::text(std::string_view boot) const
{
    std::string t = fmt::format("{}\nboot {}\ntime {}", first_line, boot, at_ns);
    for (const double l : levels_s)
        fmt::format_to(std::back_inserter(t), "\nlevel {:.6f}", l);
    for (const run& r : runs)
        fmt::format_to(std::back_inserter(t), "\nrun {} {}", r.name, r.until_ns);
    return t.append(last_line);
}

std::optional<drive_levels> drive_levels::read(std::string_view text, std::string_view boot,
                                               std::int64_t now_ns)
{
    const std::vector<std::string_view> lines = detail::split(text.substr(0, text.find(last_line)), '\n');
    if (text.find(last_line) == text.npos || lines.size() < 3 || lines.front() != first_line)
        return {};
    drive_levels l;
    for (auto line = lines.begin() + 1; line != lines.end(); ++line) {
        const std::vector<std::string_view> words = detail::split(*line, ' ');
        const auto whole = [&](std::size_t i) {
            return i < words.size() ? detail::parse_number_text<std::int64_t>(words[i]) : std::nullopt;
        };
        const auto level = words.size() == 2 && words[0] == "level"
                               ? detail::parse_number_text<double>(words[1])
                               : std::nullopt;
        if (line == lines.begin() + 1 && words[0] == "boot") {
            if (*line != fmt::format("boot {}", boot))
                return drive_levels();
        } else if (line == lines.begin() + 2 && words[0] == "time" && whole(1) && *whole(1) <= now_ns)
            l.at_ns = *whole(1);
        else if (level && *level >= 0.0 && std::isfinite(*level) && l.levels_s.size() < detail::max_channels)
            l.levels_s.push_back(*level);
        else if (words.size() == 3 && words[0] == "run" && whole(1) && whole(2) &&
                 *whole(2) <= now_ns + rt::ns_per_s)
            l.runs.push_back({*whole(1), *whole(2)});
        else
            return {};
    }
    return l;
}

std::vector<double> drive_share::enter(drive_levels& l, std::span<const double> drive_s, const drive_law& law,
                                       bool goes_on, std::int64_t now_ns)
{
    std::erase_if(l.runs, [this](const drive_levels::run& r) { return r.name == name; });
    l.levels_s.resize(std::max(l.levels_s.size(), drive_s.size()));
    l.advance(now_ns, law);
    drive_levels without_this = l;
    without_this.add({}, now_ns, law);
    l.add(drive_s, now_ns, law);
    std::vector<double> theirs = l.levels_s;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const double remaining =
            i < last_levels_s.size() ? last_levels_s[i] - law.leak * seconds(now_ns - entered_ns) : 0.0;
        if (without_this.levels_s[i] <= std::max(remaining, 0.0) + noticed_s)
            theirs[i] = 0.0;
    }
    while (l.runs.empty() && l.levels_s.size() > drive_s.size() && l.levels_s.back() == 0.0)
        l.levels_s.pop_back(); // drops levels of unknown channels
    if (goes_on)
        l.runs.push_back({name, now_ns + std::llround(ahead_s * 1e9)});
    last_levels_s = l.levels_s;
    entered_ns = now_ns;
    sounds = goes_on;
    return theirs;
}

drive_book::drive_book(const stream_setup& s, const synth::guard_settings& g,
                       std::function<std::int64_t()> clock)
    : device_(s.device),
      outputs_(s.wiring.outputs),
      channels_(s.channels),
      law_{.limit_s = g.drive_frames > 0.0 ? g.drive_frames / g.rate : longest_s, .leak = g.leak},
      rate_(g.rate),
      clock_(std::move(clock))
{
    if (!has_device())
        return;
    for (const std::vector<unsigned>& reached : outputs_)
        if (!reached.empty() && reached.back() >= detail::max_channels) { // the stream has several devices
            outputs_.clear();
            break;
        }
    const place p = prepare_book_folder();
    path_ = make_book_path(p, device_);
    boot_ = read_boot_id();
    share_.name = rt::boottime_ns();
    const auto begin = [this](drive_levels& l, std::int64_t now_ns) {
        l.advance(now_ns, law_);
        l.add({}, now_ns, law_);
        share_.last_levels_s = l.levels_s;
        share_.entered_ns = now_ns;
    };
    fault f = look_up({device_, path_, boot_, law_.limit_s}, clock_, patient_tries, begin);
    if (f.what == fault_kind::busy) {
        drive_levels full = full_levels(law_.limit_s, clock_());
        begin(full, full.at_ns);
    }
    if (path_.empty())
        f = {fault_kind::not_kept, p.why};
    if (f.what != fault_kind::none)
        record_doubt(text(f));
}

std::string drive_book::doubt() const
{
    const std::lock_guard lock(mutex_);
    return doubt_;
}

bool drive_book::record_doubt(std::string why)
{
    const std::lock_guard lock(mutex_);
    if (!doubt_.empty())
        return false;
    doubt_ = std::move(why);
    return true;
}

std::vector<double> drive_book::levels_at_channels(const std::vector<double>& of_device) const
{
    std::vector<double> levels(channels_, 0.0);
    const auto level = [&](std::size_t output) {
        return output < of_device.size() ? of_device[output] : 0.0;
    };
    for (std::size_t c = 0; c < channels_; ++c)
        if (c >= outputs_.size())
            levels[c] = level(c);
        else
            for (const unsigned output : outputs_[c])
                levels[c] = std::max(levels[c], level(output));
    return levels;
}

// Returns the drive, s, of each channel of the device since the last entry.
std::vector<double> drive_book::drive_at_device(std::span<const std::uint64_t> now) const
{
    std::vector<double> drive_s(channels_, 0.0);
    for (std::size_t c = 0; c < now.size(); ++c) {
        const std::uint64_t before = c < share_.driven.size() ? share_.driven[c] : 0;
        const double s = static_cast<double>(now[c] - before) / rate_;
        const unsigned own[] = {static_cast<unsigned>(c)};
        for (const unsigned output : c < outputs_.size() ? std::span<const unsigned>(outputs_[c]) : own) {
            drive_s.resize(std::max<std::size_t>(drive_s.size(), output + 1));
            drive_s[output] += s;
        }
    }
    return drive_s;
}

bool drive_book::enter(std::span<const std::atomic<std::uint64_t>> driven, bool sounds,
                       level_requests& raised) noexcept
{
    if (!has_device() || (sounds && share_.sounds && clock_() - share_.entered_ns < renewed_ns))
        return false;
    try {
        std::vector<std::uint64_t> now(driven.size());
        std::transform(driven.begin(), driven.end(), now.begin(),
                       [](const auto& n) { return n.load(std::memory_order_relaxed); });
        share_.driven.resize(now.size());
        if (!sounds && !share_.sounds && now == share_.driven)
            return false;
        return enter(now, sounds, raised);
    } catch (const std::exception&) { // no memory: the next call enters the drive
        return false;
    }
}

bool drive_book::enter(const std::vector<std::uint64_t>& now, bool sounds, level_requests& raised)
{
    drive_share next = share_;
    next.driven = now;
    std::vector<double> theirs;
    const fault f = look_up({device_, path_, boot_, law_.limit_s}, clock_, sounds ? 0 : patient_tries,
                            [&](drive_levels& l, std::int64_t now_ns) {
                                theirs = next.enter(l, drive_at_device(now), law_, sounds, now_ns);
                            });
    if (f.what == fault_kind::busy) {
        // While something sounds this thread has other work: it looks again when it wakes next.
        const std::int64_t now_ns = clock_();
        locked_ns_ = locked_ns_.value_or(now_ns);
        if (sounds && now_ns - *locked_ns_ < patience_ns)
            return false;
        theirs.assign(detail::max_channels, law_.limit_s);
    } else {
        locked_ns_.reset();
        share_ = std::move(next);
    }
    const std::vector<double> levels = levels_at_channels(theirs);
    for (std::size_t c = 0; c < levels.size(); ++c)
        if (levels[c] > 0.0)
            raised.set(c, levels[c]);
    return f.what != fault_kind::none && record_doubt(text(f));
}

namespace {

// Returns the growth of a counter since the last look.
std::uint64_t take_growth(const std::atomic<std::uint64_t>& counter, std::uint64_t& seen) noexcept
{
    const std::uint64_t now = counter.load(std::memory_order_relaxed);
    return now - std::exchange(seen, now);
}

// Returns true if a condition has become true since the last look.
bool detect_rise(bool now, bool& seen) noexcept
{
    return !std::exchange(seen, now) && now;
}

} // namespace

void stream_log::add(log_kind k, std::string text)
{
    lines_.emplace_back(k, std::move(text));
}

void stream_log::look(const stream_status& s, std::int64_t now_ns) noexcept
{
    if (!on())
        return;
    try {
        log_stream_changes(s);
        // Limits act in each period: one line a second is enough.
        if (now_ns - limits_logged_ns_ < rt::ns_per_s && limits_logged_ns_ != 0)
            return;
        const std::size_t before = lines_.size();
        log_limit_counts();
        if (lines_.size() != before)
            limits_logged_ns_ = now_ns;
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::log_stream_changes(const stream_status& s)
{
    const std::uint64_t xruns = link_.count.xruns.load(std::memory_order_acquire);
    for (; xruns_ < xruns; ++xruns_) {
        const auto& lengths = link_.count.xrun_ns;
        const auto ns = xruns - xruns_ > lengths.size()
                            ? 0
                            : lengths[xruns_ % lengths.size()].load(std::memory_order_relaxed);
        add(log_kind::warning,
            fmt::format("xrun {}: the device ran dry{}", xruns_ + 1,
                        ns == 0 ? ""
                                : fmt::format(" for {}", seconds_text(static_cast<double>(ns) * 1e-9, 3))));
    }
    if (detect_rise(link_.count.realtime_given_up.load(std::memory_order_relaxed), given_up_))
        add(log_kind::warning, "the audio thread gave up its real-time priority: it had worked for some 0.1 "
                               "s without a pause (use longer periods, or fewer strokes at once)");
    if (detect_rise(s.stage == stream_stage::suspended, asleep_))
        add(log_kind::warning, "the system sleeps: the stream stands still");
    if (s.running && s.epoch > epoch_) {
        epoch_ = s.epoch;
        add(log_kind::info, fmt::format("the stream runs again, started {} times so far", s.epoch));
    }
    const amplifier_link& a = link_.amplifier;
    if (take_growth(link_.count.stalls, stalls_) != 0)
        add(log_kind::warning, "the audio thread, or the whole process, stood still: the amplifier goes off");
    if (const std::uint32_t mutes = a.mutes.load(std::memory_order_acquire);
        std::exchange(mutes_, mutes) != mutes)
        add(log_kind::warning, "the amplifier was muted: nobody felt what played");
    if (take_growth(link_.count.off_failures, off_failures_) != 0)
        add(log_kind::error, "the amplifier's line does not switch off: tactor tries again");
    if (detect_rise(a.stuck.load(std::memory_order_seq_cst), stuck_))
        add(log_kind::error,
            "the amplifier may be on: its line still does not switch off, and tactor has stopped trying");
    if (detect_rise(a.ready.load(std::memory_order_acquire) && s.running, ready_))
        add(log_kind::info, "strokes may sound");
}

void stream_log::log_limit_counts()
{
    if (const std::uint64_t n = take_growth(link_.count.drives_cut, cut_); n != 0)
        add(log_kind::warning,
            fmt::format("{} cut short or silent: a tactor was driven for too long ({} in {} at most)",
                        counted(n, "drive"), seconds_text(limits_.max_drive_s),
                        seconds_text(limits_.window_s)));
    if (const std::uint64_t n = take_growth(link_.count.power_limited, power_limited_); n != 0)
        add(log_kind::warning, fmt::format("the limit reduced the power of all tactors to {} dBFS in {}",
                                           plain_number(limits_.power_dbfs), counted(n, "frame")));
    if (const std::uint64_t n = take_growth(link_.count.limited, limited_); n != 0)
        add(log_kind::warning, fmt::format("{} reduced to a channel's own limit", counted(n, "sample")));
}

void stream_log::log_stroke_end(const stroke_report& r) noexcept
{
    if (!on())
        return;
    try {
        if (r.held_points != 0)
            add(log_kind::warning,
                fmt::format(
                    "live stroke {}: {} above intensity 1 played as 1: the requested level is the ceiling",
                    r.id.number, counted(r.held_points, "point")));
        if (r.outside_points != 0)
            add(log_kind::warning, fmt::format("live stroke {}: {} outside the array moved to its edge",
                                               r.id.number, counted(r.outside_points, "point")));
        if (!r.doubt.empty())
            add(log_kind::warning, fmt::format("live stroke {}: {}", r.id.number, r.doubt));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::warn(std::string_view stream, std::string_view what) noexcept
{
    if (!on())
        return;
    try {
        add(log_kind::warning, fmt::format("{}: {}", stream, what));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::end(const std::string& why) noexcept
{
    if (!on() || std::exchange(over_, true))
        return;
    try {
        log_limit_counts();
        add(why.empty() ? log_kind::info : log_kind::error,
            why.empty() ? "the stream has ended" : fmt::format("the stream has ended: {}", why));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

// Writes the lines. The function may destroy the player, which then looks and writes for the last time.
void stream_log::write() noexcept
{
    const auto lines = std::exchange(lines_, {});
    for (const auto& [kind, text] : lines) {
        try {
            to_(kind, text);
        } catch (...) { // NOLINT(bugprone-empty-catch): a log must not end the stream
        }
    }
}

} // namespace tactor::engine

namespace tactor {
inline namespace v0 {

std::string drive_time_fault(std::string_view device)
{
    const engine::place p = engine::prepare_book_folder();
    if (p.folder.empty())
        return p.why;
    const std::string path = engine::make_book_path(p, device);
    const std::string boot = engine::read_boot_id();
    engine::locked_file file(path, engine::drive_levels().text(boot), engine::patient_tries);
    if (file.busy())
        return path + " is locked by another program";
    if (!file.open())
        return fmt::format("{} cannot be {}: {}", path, file.exists() ? "opened" : "made",
                           engine::describe(file.code()));
    const std::string text = file.read();
    if (!engine::drive_levels::read(text, boot, rt::boottime_ns()))
        return engine::read_fault(path).why;
    return file.write(text) ? std::string() : engine::write_fault(path, file.code()).why;
}

} // namespace v0
} // namespace tactor
