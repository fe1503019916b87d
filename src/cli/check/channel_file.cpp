// SPDX-License-Identifier: MIT
#include "cli/check/walk_session.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "files/setup_text.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

error already_there(const std::string& name)
{
    return {error_kind::bad_input, name, "there is such a file already",
            "choose another name: it is not overwritten"};
}

// Returns the name of a file as another file must write it; the name used here if that cannot be found.
std::string name_in(const std::string& name, const std::string& file)
{
    std::error_code failed;
    const fs::path whole = fs::absolute(file, failed);
    if (failed)
        return file;
    const fs::path folder = fs::absolute(name, failed).parent_path();
    const fs::path near = failed ? whole : fs::proximate(whole, folder, failed);
    return failed ? whole.string() : near.string();
}

// Returns the text of an array file that takes the array from its file or preset and changes channels only.
std::string overlay(const std::string& name, const environment& e, const std::vector<unsigned>& channels)
{
    std::string base = fmt::format("preset = {}", detail::toml_string(e.tactors.name));
    if (!e.array_file.empty())
        base = fmt::format("file = {}", detail::toml_string(name_in(name, e.array_file)));
    std::string s =
        fmt::format("# Channels as felt on a walk (tactor check --walk).\n[array]\nname = {}\n{}\n",
                    detail::toml_string(e.tactors.name), base);
    for (std::size_t i = 0; i < channels.size(); ++i)
        if (channels[i] != e.tactors.tactors[i].channel)
            s += fmt::format("\n[[tactor]]\ntactor = {}\nchannel = {}\n", i, channels[i]);
    return s;
}

// Writes a new file. output_file would replace an existing one.
void write_new(const std::string& name, const std::string& text)
{
    const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == EEXIST)
        throw already_there(name);
    if (fd < 0)
        throw error(error_kind::runtime, name, std::strerror(errno));
    std::size_t done = 0;
    int code = 0;
    while (done < text.size() && code == 0) {
        const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
        if (n > 0)
            done += static_cast<std::size_t>(n);
        else if (errno != EINTR)
            code = errno;
    }
    if (::close(fd) != 0 && code == 0)
        code = errno;
    if (code == 0)
        return;
    ::unlink(name.c_str());
    throw error(error_kind::runtime, name, std::strerror(code));
}

bool has_channels(const std::string& name, const std::vector<unsigned>& channels)
{
    const setup s = load_setup(name);
    if (!s.array || s.array->tactors.size() != channels.size())
        return false;
    for (std::size_t i = 0; i < channels.size(); ++i)
        if (s.array->tactors[i].channel != channels[i])
            return false;
    return true;
}

// Writes a file and reads it back. Returns false, and removes it, if its channels are not these, e.g. because
// it names other files.
bool try_text(const std::string& name, const std::string& text, const std::vector<unsigned>& channels)
{
    write_new(name, text);
    bool good = false;
    try {
        good = has_channels(name, channels);
    } catch (const error&) {
        good = false;
    }
    if (!good)
        ::unlink(name.c_str());
    return good;
}

} // namespace

void check_new_file(const std::string& name)
{
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(name, ignored)))
        throw already_there(name);
    const fs::path folder = fs::path(name).parent_path();
    if (!folder.empty() && !fs::is_directory(folder, ignored))
        throw error(error_kind::bad_input, name, fmt::format("there is no folder {}", folder.string()),
                    "make it first");
}

void write_channel_file(const std::string& name, const environment& e, const std::vector<unsigned>& channels)
{
    if (!e.array_file.empty()) {
        std::string text;
        try {
            text = detail::with_channels(e.array_file, channels);
        } catch (const error&) {
            text.clear(); // the overlay has them
        }
        if (!text.empty() && try_text(name, text, channels))
            return;
    }
    if (!try_text(name, overlay(name, e, channels), channels))
        throw error(error_kind::runtime, name, "the channel map cannot be written", "change it by hand");
}

} // namespace tactor::cli
