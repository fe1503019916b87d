// SPDX-License-Identifier: MIT
#include "engine/control/records.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
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

constexpr std::string_view first_line = "tactor-drive-time 1";
constexpr std::string_view last_line = "end";
constexpr double ahead_s = 0.5;
constexpr std::int64_t renewed_ns = rt::ns_per_s / 4;
constexpr std::size_t longest_name = 200; // longer ones share what begins alike

double seconds(std::int64_t ns)
{
    return static_cast<double>(ns) * 1e-9;
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
    std::string folder = {}; ///< empty: there is none
    std::string why = {};    ///< then
};

/// Finds a folder that nobody else can put anything into: that of a service, else the user's.
place find_folder()
{
    const std::string runtime = rt::runtime_folder();
    if (runtime.empty())
        return {.why = "there is no runtime folder (XDG_RUNTIME_DIR)"};
    if (!is_own(runtime, 0))
        return {.why = fmt::format("{} is not a folder of this user", runtime)};
    const std::string folder = runtime + "/tactor";
    if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
        return {.why = fmt::format("{}: {}", folder, std::generic_category().message(errno))};
    if (!is_own(folder, S_IWGRP | S_IWOTH))
        return {.why = fmt::format("{} is not a folder of this user alone", folder)};
    return {.folder = folder};
}

std::string find_path(const place& p, std::string_view device)
{
    return p.folder.empty() ? std::string() : p.folder + "/" + file_name(device);
}

/// A file that is open and locked against other processes.
class locked_file {
public:
    /// Opens and locks it, `flags` as for open(2). It is not open() if that fails.
    locked_file(const std::string& path, int flags) noexcept
        : fd_(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600))
    {
        struct stat is = {};
        if (!fd_ || ::fstat(fd_.get(), &is) != 0 || !S_ISREG(is.st_mode) || !detail::lock_file(fd_, tries))
            fd_ = {};
    }
    /// Unlocks it, also where a process that was forked meanwhile has it open.
    ~locked_file()
    {
        if (fd_)
            ::flock(fd_.get(), LOCK_UN);
    }
    locked_file(const locked_file&) = delete;
    locked_file& operator=(const locked_file&) = delete;

    bool open() const noexcept { return static_cast<bool>(fd_); }
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
    /// Returns false if it could not be written as a whole. Then it counts as empty.
    bool write(const std::string& text) const noexcept
    {
        const auto size = static_cast<ssize_t>(text.size());
        return ::pwrite(fd_.get(), text.data(), text.size(), 0) == size && ::ftruncate(fd_.get(), size) == 0;
    }

private:
    static constexpr std::size_t most_bytes = std::size_t{1} << 20;
    // Others hold it for microseconds. One that was stopped meanwhile must not stop this player.
    static constexpr int tries = 8;

    detail::owned_fd fd_;
};

/// Levels of devices whose files cannot be written.
struct memory {
    std::mutex mutex;
    std::map<std::string, drive_levels> by_device;
};

memory& here()
{
    static memory m;
    return m;
}

/// Calls `change` with the levels of a device, and keeps them if it returns true. `path`: empty: in memory.
template <class Change>
void look_up(const std::string& device, const std::string& path, int flags, Change change)
{
    memory& m = here();
    const std::lock_guard lock(m.mutex);
    drive_levels& own = m.by_device[device];
    const locked_file file(path, flags);
    drive_levels l = file.open() ? drive_levels::read(file.read()) : drive_levels();
    if (l.levels_s.empty())
        l = own;
    if (change(l) && !(file.open() && file.write(l.text())))
        own = std::move(l);
}

} // namespace

bool drive_levels::is_foreign(std::int64_t now_ns) const noexcept
{
    return at_ns > now_ns + rt::ns_per_s;
}

std::vector<double> drive_levels::after_rest(std::int64_t now_ns, double limit_s, double leak) const
{
    if (is_foreign(now_ns))
        return {};
    const double rest_s = seconds(std::max<std::int64_t>(now_ns - at_ns, 0));
    std::vector<double> now = levels_s;
    for (double& l : now)
        l = std::max(std::min(l, limit_s) - leak * rest_s, 0.0);
    return now;
}

std::string drive_levels::text() const
{
    // Has the same length for any levels: a kill between the two calls that write it leaves no end of the one
    // before.
    std::string t = fmt::format("{}\n{:019}\n", first_line, at_ns);
    for (const double l : levels_s)
        fmt::format_to(std::back_inserter(t), "{:016.6f}\n", l);
    return t.append(last_line).append("\n");
}

drive_levels drive_levels::read(std::string_view text)
{
    const std::vector<std::string_view> lines = detail::split(text, '\n');
    if (lines.size() < 4 || lines.size() > detail::max_channels + 4 || lines.front() != first_line ||
        !lines.back().empty() || lines[lines.size() - 2] != last_line)
        return {};
    const auto at_ns = detail::number_in<std::int64_t>(lines[1]);
    if (!at_ns)
        return {};
    drive_levels l{.at_ns = *at_ns};
    for (std::size_t i = 2; i + 2 < lines.size(); ++i) {
        const auto level = detail::number_in<double>(lines[i]);
        if (!level || !(*level >= 0.0) || !std::isfinite(*level))
            return {};
        l.levels_s.push_back(*level);
    }
    return l;
}

void drive_share::enter(drive_levels& l, std::span<const std::uint64_t> all, double rate, double leak,
                        double next_s, std::int64_t now_ns)
{
    if (l.is_foreign(now_ns))
        l = {};
    const bool alone = l.at_ns == left_ns;
    const double passed_s = seconds(now_ns - (alone ? entered_ns : l.at_ns));
    driven.resize(all.size());
    l.levels_s.resize(std::max(l.levels_s.size(), all.size()));
    for (std::size_t i = 0; i < l.levels_s.size(); ++i) {
        const bool ours = i < all.size();
        const double drive_s = ours ? static_cast<double>(all[i] - driven[i]) / rate : 0.0;
        const double before_s = std::max(l.levels_s[i] - (ours ? ahead_s : 0.0), 0.0);
        const double rest_s = std::max(passed_s - drive_s, 0.0);
        l.levels_s[i] = std::max(before_s - leak * rest_s, 0.0) + drive_s + (ours ? next_s : 0.0);
    }
    driven.assign(all.begin(), all.end());
    ahead_s = next_s;
    entered_ns = now_ns;
    const std::int64_t until_ns = now_ns + std::llround(next_s * 1e9);
    l.at_ns = left_ns = alone ? until_ns : std::max(until_ns, l.at_ns);
}

drive_book::drive_book(std::string device, const synth::guard_settings& g)
    : device_(std::move(device)),
      path_(device_.empty() ? std::string() : find_path(find_folder(), device_)),
      limit_s_(g.drive_frames > 0.0 ? g.drive_frames / g.rate : std::numeric_limits<double>::infinity()),
      leak_(g.leak),
      rate_(g.rate)
{
}

std::vector<double> drive_book::read() const
{
    std::vector<double> now;
    if (has_device())
        look_up(device_, path_, O_RDWR, [&](drive_levels& l) {
            now = l.after_rest(rt::boottime_ns(), limit_s_, leak_);
            return false;
        });
    return now;
}

void drive_book::enter(std::span<const std::atomic<std::uint64_t>> driven, bool sounds) noexcept
{
    const std::int64_t now_ns = rt::boottime_ns();
    const bool ahead = share_.ahead_s > 0.0;
    if (!has_device() || (sounds && ahead && now_ns - share_.entered_ns < renewed_ns))
        return;
    try {
        std::vector<std::uint64_t> now(driven.size());
        std::transform(driven.begin(), driven.end(), now.begin(),
                       [](const auto& n) { return n.load(std::memory_order_relaxed); });
        drive_share next = share_;
        next.driven.resize(now.size());
        if (!sounds && !ahead && now == next.driven)
            return;
        look_up(device_, path_, O_RDWR | O_CREAT, [&](drive_levels& l) {
            next.enter(l, now, rate_, leak_, sounds ? ahead_s : 0.0, now_ns);
            return true;
        });
        share_ = std::move(next);
    } catch (const std::exception&) { // NOLINT(bugprone-empty-catch): no memory; the next call enters it
    }
}

namespace {

// Returns the growth of a counter since the last look.
std::uint64_t grown(const std::atomic<std::uint64_t>& counter, std::uint64_t& seen) noexcept
{
    const std::uint64_t now = counter.load(std::memory_order_relaxed);
    return now - std::exchange(seen, now);
}

// Returns true if a condition has become true since the last look.
bool rose(bool now, bool& seen) noexcept
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
        look_at_stream(s);
        // Limits act in each period: one line a second is enough.
        if (now_ns - limits_logged_ns_ < rt::ns_per_s && limits_logged_ns_ != 0)
            return;
        const std::size_t before = lines_.size();
        look_at_limits();
        if (lines_.size() != before)
            limits_logged_ns_ = now_ns;
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::look_at_stream(const stream_status& s)
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
    if (rose(link_.count.realtime_given_up.load(std::memory_order_relaxed), given_up_))
        add(log_kind::warning, "the audio thread gave up its real-time priority: it had worked for some 0.1 "
                               "s without a pause (longer periods, or fewer strokes at once, need less)");
    if (rose(s.stage == stream_stage::suspended, asleep_))
        add(log_kind::warning, "the system sleeps: the stream stands still");
    if (s.running && s.epoch > epoch_) {
        epoch_ = s.epoch;
        add(log_kind::info, fmt::format("the stream runs again, started {} times by now", s.epoch));
    }
    const amplifier_link& a = link_.amplifier;
    if (grown(link_.count.stalls, stalls_) != 0)
        add(log_kind::warning, "the audio thread, or the whole process, stood still: the amplifier goes off");
    if (const std::uint32_t mutes = a.mutes.load(std::memory_order_acquire);
        std::exchange(mutes_, mutes) != mutes)
        add(log_kind::warning, "the amplifier was muted: what sounded is not felt");
    if (grown(link_.count.off_failures, off_failures_) != 0)
        add(log_kind::error, "the amplifier's line refuses to be switched off: it is tried again");
    if (rose(a.stuck.load(std::memory_order_seq_cst), stuck_))
        add(log_kind::error, "the amplifier may be on: its line was given up");
    if (rose(a.ready.load(std::memory_order_acquire) && s.running, ready_))
        add(log_kind::info, "strokes may sound");
}

void stream_log::look_at_limits()
{
    if (const std::uint64_t n = grown(link_.count.drives_cut, cut_); n != 0)
        add(log_kind::warning,
            fmt::format("{} cut short or silent: a tactor was driven for too long ({} in {} at most)",
                        counted(n, "drive"), seconds_text(limits_.max_drive_s),
                        seconds_text(limits_.window_s)));
    if (const std::uint64_t n = grown(link_.count.power_limited, power_limited_); n != 0)
        add(log_kind::warning, fmt::format("the power of all tactors was held at {} dBFS in {}",
                                           plain_number(limits_.power_dbfs), counted(n, "frame")));
    if (const std::uint64_t n = grown(link_.count.limited, limited_); n != 0)
        add(log_kind::warning, fmt::format("{} held at a channel's own limit", counted(n, "sample")));
}

void stream_log::look_at_end(const stroke_report& r) noexcept
{
    if (!on())
        return;
    try {
        if (r.held_points != 0)
            add(log_kind::warning,
                fmt::format(
                    "live stroke {}: {} above intensity 1 sounded as 1: the level asked for is the ceiling",
                    r.id.number, counted(r.held_points, "point")));
        if (r.outside_points != 0)
            add(log_kind::warning, fmt::format("live stroke {}: {} outside the array moved to its edge",
                                               r.id.number, counted(r.outside_points, "point")));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::end(const std::string& why) noexcept
{
    if (!on() || std::exchange(over_, true))
        return;
    try {
        look_at_limits();
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
    const engine::place p = engine::find_folder();
    if (p.folder.empty())
        return p.why;
    const std::string path = engine::find_path(p, device);
    const bool good = ::access(path.c_str(), F_OK) != 0 || engine::locked_file(path, O_RDWR).open();
    return good ? std::string() : fmt::format("{} cannot be written", path);
}

} // namespace v0
} // namespace tactor
