// SPDX-License-Identifier: MIT
#include "files/input_files.hpp"

#include <algorithm>
#include <bit>
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

constexpr std::size_t least_forgotten = 64;

struct input {
    dev_t device = 0;
    ino_t inode = 0;
    owner_kind owner = owner_kind::user;

    bool is(const struct stat& s) const noexcept { return device == s.st_dev && inode == s.st_ino; }

    /// Returns false for a file that is gone: a file system gives its number to the next one.
    bool is_still(const fs::path& name) const noexcept
    {
        struct stat now {};
        return ::stat(name.c_str(), &now) == 0 && is(now);
    }
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

bool may_replace(owner_kind writer, owner_kind read) noexcept
{
    return writer == owner_kind::caller || (writer == owner_kind::program && read == owner_kind::program);
}

// Returns the name under which a file was read that this writer may not replace, or an empty one.
fs::path find_input(const struct stat& file, owner_kind writer)
{
    if (!S_ISREG(file.st_mode))
        return {};
    inputs& i = known();
    const std::lock_guard locked(i.guard);
    const auto kept = std::find_if(i.all.begin(), i.all.end(), [&](const auto& e) {
        return e.second.is(file) && !may_replace(writer, e.second.owner) && e.second.is_still(e.first);
    });
    return kept == i.all.end() ? fs::path() : kept->first;
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
    // A process may live long: forgets what is gone where the number of files reaches a power of two.
    else if (i.all.size() >= least_forgotten && std::has_single_bit(i.all.size()))
        std::erase_if(i.all, [](const auto& e) { return !e.second.is_still(e.first); });
    i.all[std::move(whole)] = {s.st_dev, s.st_ino, owner};
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
