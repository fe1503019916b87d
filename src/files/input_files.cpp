// SPDX-License-Identifier: MIT
#include "files/input_files.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include <tactor/error.hpp>

namespace tactor::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_inputs = 65536;

struct input {
    dev_t device = 0;
    ino_t inode = 0;
    owner_kind owner = owner_kind::user;

    bool is(const struct stat& s) const noexcept { return device == s.st_dev && inode == s.st_ino; }
};

struct inputs {
    std::mutex guard;
    std::map<fs::path, input> all; ///< by absolute name
};

inputs& known()
{
    static inputs i;
    return i;
}

} // namespace

void note_input(const fs::path& file, owner_kind owner)
{
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode))
        return;
    std::error_code ignored;
    fs::path whole = fs::absolute(file, ignored);
    inputs& i = known();
    const std::lock_guard locked(i.guard);
    const auto old = i.all.find(whole);
    if (old != i.all.end())
        owner = std::min(owner, old->second.owner); // once the user's, always the user's
    else if (i.all.size() == most_inputs)
        i.all.erase(i.all.begin());
    i.all[std::move(whole)] = {s.st_dev, s.st_ino, owner};
}

fs::path find_input(const struct stat& file, owner_kind writer)
{
    if (!S_ISREG(file.st_mode))
        return {};
    inputs& i = known();
    const std::lock_guard locked(i.guard);
    for (const auto& [name, read] : i.all) {
        if (!read.is(file) || (read.owner == owner_kind::program && writer == owner_kind::program))
            continue;
        // A file system gives the number of a deleted file to the next one.
        struct stat now {};
        if (::stat(name.c_str(), &now) == 0 && read.is(now))
            return name;
    }
    return {};
}

void refuse_input(const struct stat& file, const fs::path& output, owner_kind writer)
{
    const fs::path read = find_input(file, writer);
    if (read.empty())
        return;
    std::error_code ignored;
    const bool named_so = fs::absolute(output, ignored) == read || read.string().starts_with("/dev/fd/");
    throw error(error_kind::bad_input, source_place{output.string()},
                named_so ? "it is read as input"
                         : fmt::format("it is the same file as {}, which is read as input", read.string()),
                "name another file for the output");
}

} // namespace tactor::detail
