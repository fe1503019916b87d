// SPDX-License-Identifier: MIT
#include "session/kept_drive.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/owned.hpp"
#include "files/output_file.hpp"
#include "files/text_file.hpp"
#include "rt/clock.hpp"
#include "session/say.hpp"
#include "session/variable.hpp"

namespace tactor::session {
namespace {

constexpr double ahead_s = 2.0;
constexpr std::int64_t renewed_ns = rt::ns_per_s / 2;
constexpr std::size_t longest_name = 200; // longer ones share what begins alike
constexpr std::size_t longest_text = std::size_t{64} << 20;

std::string file_name(std::string_view device)
{
    std::string name;
    for (const char c : device) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           c == '-' || c == '_' || c == '.';
        name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return name.substr(0, longest_name);
}

constexpr const char* what_follows =
    "the next run will not know for how long the array was driven by this one";

bool is_own(const std::string& folder, mode_t closed_to)
{
    struct stat is = {};
    return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
           (is.st_mode & closed_to) == 0;
}

/// A folder that nobody else can put anything into; empty where there is none.
std::string own_folder()
{
    const std::string runtime = runtime_folder();
    if (runtime.empty() || !is_own(runtime, 0))
        return {};
    std::string folder = runtime + "/tactor";
    const bool made = ::mkdir(folder.c_str(), 0700) == 0 || errno == EEXIST;
    if (made && is_own(folder, S_IWGRP | S_IWOTH))
        return folder;
    say(stderr, "tactor: warning: {}: {}: {}\n", folder,
        made ? "is not a folder of this user alone" : std::generic_category().message(errno), what_follows);
    return {};
}

/// Keeps others from writing as long as it is held.
detail::owned_fd lock(const std::string& folder)
{
    constexpr int tries = 20;
    detail::owned_fd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (fd)
        detail::lock_folder(fd, tries);
    return fd;
}

std::string read(const std::string& file)
{
    try {
        return std::string(
            std::string_view(detail::read_text_file(file, longest_text, detail::owner_kind::program)));
    } catch (const error&) {
        return {};
    }
}

drive_history history_in(std::string_view text)
{
    try {
        return drive_history::restore(text);
    } catch (const error&) {
        return {};
    }
}

/// Returns true if a process is known to run.
bool runs(std::string_view pid)
{
    std::ifstream file(fmt::format("/proc/{}/stat", pid));
    const std::string stat{std::istreambuf_iterator<char>(file), {}};
    const std::size_t name_ends = stat.rfind(") ");
    return name_ends != std::string::npos && stat.size() > name_ends + 2 && stat[name_ends + 2] != 'Z' &&
           stat[name_ends + 2] != 'X';
}

} // namespace

kept_drive::kept_drive(std::string_view device, const drive_limits& l)
    : folder_(own_folder()),
      driven_("driven-" + file_name(device)),
      going_("going-" + file_name(device) + "-"),
      counted_(l.max_drive_s < l.window_s)
{
}

void kept_drive::look()
{
    const std::string there = read(folder_ + "/" + driven_);
    if (there != text_)
        others_ = others_.with(history_in(there));
    text_ = there;
}

void kept_drive::take_up_killed()
{
    std::vector<std::filesystem::path> left;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored)) {
        const std::string file = entry.path().filename().string();
        const std::string pid = file.starts_with(going_) ? file.substr(going_.size()) : "";
        // In a container each run is process 1, so the run before had this one's number.
        const bool own = pid == std::to_string(::getpid());
        if (pid.empty() || pid.find_first_not_of("0123456789") != std::string::npos ||
            (own ? !ahead_.empty() : runs(pid)))
            continue;
        others_ = others_.with(history_in(read(entry.path())));
        left.push_back(entry.path());
    }
    if (left.empty())
        return;
    keep();
    for (const std::filesystem::path& file : left)
        std::filesystem::remove(file, ignored);
}

drive_history kept_drive::until_now()
{
    if (!folder_.empty()) {
        look();
        take_up_killed();
    }
    return own_.with(others_).with(ahead_);
}

void kept_drive::going(unsigned channels)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    if (folder_.empty() || now_ns < next_ns_)
        return;
    next_ns_ = now_ns + renewed_ns;
    ahead_ = ahead_.with_ahead(channels, ahead_s);
    write(going_ + std::to_string(::getpid()), ahead_);
}

void kept_drive::settled(const drive_history& h)
{
    own_ = counted_ ? h : own_.with(ahead_);
    next_ns_ = 0;
    ahead_ = {};
    if (folder_.empty())
        return;
    keep();
    write(going_ + std::to_string(::getpid()), {});
}

void kept_drive::keep()
{
    const detail::owned_fd held = lock(folder_);
    look();
    text_ = write(driven_, own_.with(others_));
}

std::string kept_drive::write(const std::string& file, const drive_history& h)
{
    if (folder_.empty())
        return {};
    const std::string path = folder_ + "/" + file;
    std::string text;
    try {
        if (!h.empty())
            text = h.save();
        if (text.empty()) {
            std::filesystem::remove(path);
        } else {
            detail::output_file out(path, {}, detail::owner_kind::program);
            out.write(text.data(), static_cast<std::int64_t>(text.size()));
            out.publish();
        }
    } catch (const std::exception& e) {
        say(stderr, "tactor: warning: {}: {}\n", e.what(), what_follows);
        folder_.clear();
    }
    return text;
}

} // namespace tactor::session
