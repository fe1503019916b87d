// SPDX-License-Identifier: MIT
#include "cli/session/kept_drive.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/say.hpp"
#include "cli/session/runtime_folder.hpp"
#include "files/output_file.hpp"
#include "files/text_file.hpp"
#include "rt/clock.hpp"

namespace tactor::cli {
namespace {

constexpr double ahead_s = 2.0;
constexpr std::int64_t renewed_ns = rt::ns_per_s / 2;
constexpr std::size_t longest_name = 200; // longer ones share what begins alike
constexpr std::size_t longest_text = std::size_t{64} << 20;

std::string name_of(std::string_view device)
{
    std::string name = "driven-";
    for (const char c : device) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           c == '-' || c == '_' || c == '.';
        name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return name.substr(0, longest_name);
}

/// A folder that nobody else can put anything into; empty where there is none.
std::string own_folder()
{
    const std::string runtime = runtime_folder();
    if (runtime.empty())
        return {};
    std::string folder = runtime + "/tactor";
    struct stat is = {};
    if ((::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) || ::lstat(folder.c_str(), &is) != 0)
        return {};
    const bool own = S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() && (is.st_mode & 022) == 0;
    return own ? folder : std::string{};
}

/// Keeps others from writing meanwhile. Whoever holds it for long is at fault and is not waited for.
class folder_lock {
public:
    explicit folder_lock(const std::string& folder)
        : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
    {
        if (fd_ >= 0)
            static_cast<void>(::flock(fd_, LOCK_EX | LOCK_NB));
    }
    ~folder_lock()
    {
        if (fd_ >= 0)
            ::close(fd_);
    }
    folder_lock(const folder_lock&) = delete;
    folder_lock& operator=(const folder_lock&) = delete;

private:
    int fd_;
};

std::string read(const std::string& file)
{
    try {
        return std::string(std::string_view(detail::read_text_file(file, longest_text)));
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

} // namespace

kept_drive::kept_drive(std::string_view device, const drive_limits& l) : counted_(l.max_drive_s < l.window_s)
{
    const std::string folder = own_folder();
    if (folder.empty())
        return;
    file_ = folder + "/" + name_of(device);
    text_ = read(file_);
    now_ = history_in(text_);
}

void kept_drive::going(unsigned channels)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    if (file_.empty() || now_ns < next_ns_)
        return;
    next_ns_ = now_ns + renewed_ns;
    now_ = now_.with_ahead(channels, ahead_s);
    write(now_);
}

void kept_drive::settled(const drive_history& h)
{
    if (file_.empty() || !counted_)
        return;
    now_ = h;
    next_ns_ = 0;
    write(h);
}

void kept_drive::write(drive_history h)
{
    try {
        const folder_lock lock(std::filesystem::path(file_).parent_path());
        if (const std::string there = read(file_); there != text_)
            h = h.with(history_in(there)); // another run's, on the same device
        if (h.empty()) {
            std::filesystem::remove(file_);
            text_.clear();
            return;
        }
        text_ = h.save();
        detail::output_file out(file_);
        out.write(text_.data(), static_cast<std::int64_t>(text_.size()));
        out.commit();
    } catch (const std::exception& e) {
        say(stderr,
            "tactor: warning: {}: the next run will not know for how long the array was driven by this one\n",
            e.what());
        file_.clear();
    }
}

} // namespace tactor::cli
