// SPDX-License-Identifier: MIT
#include "rt/system_files.hpp"

#include <array>
#include <cerrno>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include "core/owned.hpp"
#include "core/refused.hpp"

namespace tactor::rt {
namespace {

/// Throws if this process lacks memory or descriptors. Returns if the file itself cannot be read.
void check_resources(const std::string& what, int code)
{
    if (code == ENOMEM)
        throw std::bad_alloc();
    if (code == EMFILE || code == ENFILE)
        detail::throw_resource_error(what, code, std::generic_category().message(code));
}

} // namespace

std::vector<std::string> read_folder_names(const std::string& folder)
{
    std::vector<std::string> names;
    const std::unique_ptr<DIR, detail::deleter<::closedir>> all(::opendir(folder.c_str()));
    if (all == nullptr)
        check_resources(folder, errno);
    else
        while (const dirent* entry = ::readdir(all.get()))
            if (const std::string_view name = entry->d_name; name != "." && name != "..")
                names.emplace_back(name);
    return names;
}

std::string read_file(const std::string& file)
{
    const detail::owned_fd in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!in)
        check_resources(file, errno);
    std::string text;
    std::array<char, 4096> part{};
    for (ssize_t got = 1; in && got != 0;) {
        got = ::read(in.get(), part.data(), part.size());
        if (got > 0)
            text.append(part.data(), static_cast<std::size_t>(got));
        else if (got < 0 && errno != EINTR) // for example for a file of a process that has ended
            break;
    }
    return text;
}

} // namespace tactor::rt
