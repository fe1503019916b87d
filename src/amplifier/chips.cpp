// SPDX-License-Identifier: MIT
#include "amplifier/chips.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "amplifier/errors.hpp"
#include "core/split.hpp"
#include "rt/system_files.hpp"

namespace tactor::amplifier {
namespace {

std::optional<unsigned> chip_number(const std::string& name)
{
    constexpr std::string_view prefix = "gpiochip";
    if (!name.starts_with(prefix))
        return std::nullopt;
    return detail::number_in<unsigned>(std::string_view(name).substr(prefix.size()));
}

chip unread(const std::string& path, int code)
{
    chip c;
    c.info.path = path;
    c.info.name = std::filesystem::path(path).filename().string();
    c.code = code;
    return c;
}

chip read_with_group(const std::string& path)
{
    const int other = not_a_chip(path);
    chip c = other == 0 ? read_chip(path) : unread(path, other);
    if (c.code != 0)
        c.group = find_group(path);
    return c;
}

/// Returns the file behind a path's links: a name made by udev is as good as the kernel's.
std::string real_path(const std::string& path)
{
    std::error_code ec;
    const std::filesystem::path real = std::filesystem::canonical(path, ec);
    return ec ? path : real.string();
}

} // namespace

std::vector<std::string> chip_paths(const std::filesystem::path& folder)
{
    std::vector<std::pair<unsigned, std::string>> found;
    std::error_code ec;
    for (const std::string& name : rt::names_in(folder.string())) {
        const auto number = chip_number(name);
        const std::filesystem::path path = folder / name;
        if (number && !std::filesystem::is_symlink(path, ec))
            found.emplace_back(*number, path.string());
    }
    std::sort(found.begin(), found.end());
    std::vector<std::string> paths;
    for (auto& [number, path] : found)
        paths.push_back(std::move(path));
    return paths;
}

int not_a_chip(const std::string& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        return errno;
    if (!S_ISCHR(status.st_mode))
        return ENOTTY;
    std::error_code ec;
    const std::filesystem::path bus = std::filesystem::canonical(
        fmt::format("/sys/dev/char/{}:{}/subsystem", major(status.st_rdev), minor(status.st_rdev)), ec);
    if (ec)
        return ENOENT; // libgpiod reports the same without /sys
    return bus.filename() == "gpio" ? 0 : ENODEV;
}

std::string find_group(const std::string& path)
{
    struct stat status {};
    group entry{};
    group* found = nullptr;
    std::array<char, 4096> names{};
    if (::stat(path.c_str(), &status) == 0 &&
        ::getgrgid_r(status.st_gid, &entry, names.data(), names.size(), &found) == 0 && found)
        return found->gr_name;
    return "gpio";
}

std::vector<chip> read_chips()
{
    std::vector<chip> chips;
    for (const std::string& path : chip_paths())
        chips.push_back(read_with_group(path));
    return chips;
}

gpio_line_place look_up(const gpio_line_name& wanted)
{
    if (!built_in())
        throw error(error_kind::not_available, thing(wanted), "tactor was built without GPIO",
                    "build it anew with -Dgpio=enabled, where libgpiod is");
    std::vector<chip> chips = read_chips();
    gpio_line_name by = wanted;
    if (wanted.chip.starts_with('/')) {
        by.chip = real_path(wanted.chip);
        const auto same = [&](const chip& c) { return c.info.path == by.chip; };
        std::error_code ec;
        if (std::none_of(chips.begin(), chips.end(), same) && std::filesystem::exists(by.chip, ec))
            chips.push_back(read_with_group(by.chip));
    }
    const line_place p = find_line(chips, by);
    const gpio_chip_info& c = chips[p.chip].info;
    return {c.path, c.label, c.lines[p.offset]};
}

located_line locate(const gpio_line_name& wanted)
{
    const gpio_line_place p = look_up(wanted);
    return {p.path, p.line.offset};
}

std::string find_holder(const located_line& l)
{
    const chip c = read_chip(l.path);
    return l.offset < c.info.lines.size() ? c.info.lines[l.offset].consumer : std::string();
}

} // namespace tactor::amplifier

std::vector<tactor::gpio_chip_info> tactor::list_gpio()
{
    std::vector<gpio_chip_info> out;
    for (amplifier::chip& c : amplifier::read_chips()) {
        if (c.code != 0)
            c.info.error = amplifier::advice(c);
        out.push_back(std::move(c.info));
    }
    return out;
}

tactor::gpio_line_place tactor::find_gpio_line(const gpio_line_name& line)
{
    return amplifier::look_up(line);
}
