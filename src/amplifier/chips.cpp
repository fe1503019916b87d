// SPDX-License-Identifier: MIT
#include "amplifier/chips.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <grp.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <fmt/format.h>

#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "rt/system_files.hpp"

namespace tactor::amplifier {
namespace {

std::optional<unsigned> chip_number(const std::string& name)
{
    constexpr std::string_view prefix = "gpiochip";
    if (!name.starts_with(prefix))
        return std::nullopt;
    return detail::parse_number_text<unsigned>(std::string_view(name).substr(prefix.size()));
}

chip unread(const std::string& path, int code)
{
    chip c;
    c.info.path = path;
    c.info.name = std::filesystem::path(path).filename().string();
    c.code = code;
    return c;
}

chip read_chip_and_group(const std::string& path)
{
    const int other = find_chip_fault(path);
    chip c = other == 0 ? read_chip(path) : unread(path, other);
    if (c.code != 0)
        c.group = find_group(path);
    return c;
}

/// Opens every chip. Does not open other files with such names.
std::vector<chip> read_chips()
{
    std::vector<chip> chips;
    for (const std::string& path : chip_paths())
        chips.push_back(read_chip_and_group(path));
    return chips;
}

/// Returns the path without links, so that a name made by udev is as good as the kernel's.
std::string real_path(const std::string& path)
{
    std::error_code ec;
    const std::filesystem::path real = std::filesystem::canonical(path, ec);
    return ec ? path : real.string();
}

std::string words(int code)
{
    return std::generic_category().message(code);
}

constexpr const char* without_gpio = "tactor was built without GPIO";
constexpr const char* build_with_gpio = "build it again with -Dgpio=enabled and libgpiod";

std::string open_reason(const chip& c)
{
    const std::string& path = c.info.path;
    switch (c.code) {
    case EACCES:
    case EPERM:
        return fmt::format("no permission to open {}", path);
    case ENOTTY:
    case ENODEV:
        return fmt::format("{} is not a GPIO chip", path);
    case ENOENT: // the node exists, but libgpiod also reads sysfs
        return fmt::format("{} is not a GPIO chip, or /sys is not mounted", path);
    case ENOSYS:
        return fmt::format("{} cannot be opened: {}", path, without_gpio);
    default:
        return fmt::format("{} cannot be opened: {}", path, words(c.code));
    }
}

std::string open_hint(const chip& c)
{
    if (c.code == ENOSYS)
        return build_with_gpio;
    if (c.code != EACCES && c.code != EPERM)
        return "{command:devices} lists the chips";
    if (c.group == "root")
        return "only root may open the device: sudo groupadd --system --force gpio, install the udev rules, "
               "which give the device to that group, then sudo usermod -aG gpio $USER, and log in again";
    return fmt::format("sudo usermod -aG {} $USER, then log in again", c.group.empty() ? "gpio" : c.group);
}

/// Returns the error of an existing chip that cannot be opened.
error open_error(const gpio_line_name& l, const chip& c)
{
    return {error_kind::not_available, describe_line(l), open_reason(c), open_hint(c)};
}

constexpr std::size_t most_listed = 12;

[[noreturn]] void fail(const gpio_line_name& wanted, const std::string& why, const std::string& hint)
{
    throw error(error_kind::not_available, describe_line(wanted), why, hint);
}

std::string list(const std::vector<std::string>& items)
{
    const std::size_t n = std::min(items.size(), most_listed);
    std::string out =
        fmt::format("use one of: {}", fmt::join(items.begin(), items.begin() + std::ptrdiff_t(n), ", "));
    if (items.size() > n)
        out += fmt::format(" and {} more", items.size() - n);
    return out;
}

std::string chip_text(const chip& c)
{
    return c.code == 0 ? fmt::format("\"{}\" at {}", c.info.label, c.info.path)
                       : fmt::format("{}, which cannot be opened", c.info.path);
}

std::string list_chips(std::span<const chip> chips)
{
    std::vector<std::string> items;
    for (const chip& c : chips)
        items.push_back(chip_text(c));
    return list(items);
}

/// Throws if a chip could not be opened, because it may have the wanted line.
void refuse_unopened_chips(std::span<const chip> chips, const gpio_line_name& wanted)
{
    for (const chip& c : chips)
        if (c.code != 0)
            detail::throw_with_cause(open_error(wanted, c), c.code);
}

std::size_t require_single_chip(std::span<const chip> chips, const std::vector<std::size_t>& found,
                                const gpio_line_name& wanted)
{
    if (found.size() == 1)
        return found.front();
    std::vector<std::string> paths;
    for (const std::size_t i : found)
        paths.push_back(chips[i].info.path);
    fail(wanted,
         fmt::format("{} chips are labelled \"{}\": {}", found.size(), wanted.chip, fmt::join(paths, ", ")),
         "name the chip by its path");
}

std::size_t find_chip(std::span<const chip> chips, const gpio_line_name& wanted)
{
    std::vector<std::size_t> labelled;
    for (std::size_t i = 0; i < chips.size(); ++i) {
        if (chips[i].info.path == wanted.chip)
            return i;
        if (chips[i].code == 0 && chips[i].info.label == wanted.chip)
            labelled.push_back(i);
    }
    if (!labelled.empty())
        return require_single_chip(chips, labelled, wanted);
    if (wanted.chip.starts_with('/'))
        fail(wanted, fmt::format("there is no {}", wanted.chip), list_chips(chips));
    for (const chip& c : chips)
        if (c.info.name == wanted.chip)
            fail(wanted, fmt::format("the kernel may change the number \"{}\" at each start", wanted.chip),
                 c.code == 0
                     ? fmt::format("use the label, chip = \"{}\", or the path {}", c.info.label, c.info.path)
                     : fmt::format("use the chip's label, or the path {}", c.info.path));
    refuse_unopened_chips(chips, wanted);
    fail(wanted, fmt::format("no chip labelled \"{}\"", wanted.chip), list_chips(chips));
}

unsigned check_offset(const chip& c, const gpio_line_name& wanted)
{
    const std::size_t n = c.info.lines.size();
    if (*wanted.offset < n)
        return *wanted.offset;
    fail(wanted,
         n == 0 ? fmt::format("chip {} has no lines", chip_text(c))
                : fmt::format("chip {} has lines 0 to {}, no line {}", chip_text(c), n - 1, *wanted.offset),
         "count the lines of the chip from 0");
}

std::vector<std::string> all_names(std::span<const chip> chips)
{
    std::vector<std::string> names;
    for (const chip& c : chips)
        for (const gpio_line_info& l : c.info.lines)
            if (!l.name.empty())
                names.push_back(l.name);
    return names;
}

[[noreturn]] void refuse_unknown_line(std::span<const chip> chips, const gpio_line_name& wanted)
{
    refuse_unopened_chips(chips, wanted);
    const std::vector<std::string> names = all_names(chips);
    const std::string why = wanted.chip.empty() ? "no line has this name"
                                                : fmt::format("no line of {} has this name", wanted.chip);
    if (names.empty())
        fail(wanted, why, "give chip and offset: no line of this machine has a name");
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view near = detail::nearest_name(wanted.name, known);
    fail(wanted, why, near.empty() ? list(names) : fmt::format("did you mean \"{}\"?", near));
}

line_place find_named_line(std::span<const chip> chips, const gpio_line_name& wanted, std::size_t first)
{
    std::vector<line_place> found;
    for (std::size_t i = 0; i < chips.size(); ++i)
        for (const gpio_line_info& l : chips[i].info.lines)
            if (l.name == wanted.name)
                found.push_back({first + i, l.offset});
    if (found.empty())
        refuse_unknown_line(chips, wanted);
    if (found.size() == 1)
        return found.front();
    std::vector<std::string> places;
    for (const line_place& p : found)
        places.push_back(fmt::format("line {} of {}", p.offset, chips[p.chip - first].info.path));
    fail(wanted, fmt::format("{} lines have this name: {}", found.size(), fmt::join(places, ", ")),
         "select one by chip and offset");
}

} // namespace

std::vector<std::string> chip_paths(const std::filesystem::path& folder)
{
    std::vector<std::pair<unsigned, std::string>> found;
    std::error_code ec;
    for (const std::string& name : rt::read_folder_names(folder.string())) {
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

int find_chip_fault(const std::string& path)
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

gpio_line_place look_up(const gpio_line_name& wanted)
{
    if (!built_in())
        throw error(error_kind::not_available, describe_line(wanted), without_gpio, build_with_gpio);
    std::vector<chip> chips = read_chips();
    gpio_line_name by = wanted;
    if (wanted.chip.starts_with('/')) {
        by.chip = real_path(wanted.chip);
        const auto same = [&](const chip& c) { return c.info.path == by.chip; };
        std::error_code ec;
        if (std::none_of(chips.begin(), chips.end(), same) && std::filesystem::exists(by.chip, ec))
            chips.push_back(read_chip_and_group(by.chip));
    }
    const line_place p = find_line(chips, by);
    const gpio_chip_info& c = chips[p.chip].info;
    return {c.path, c.label, c.lines[p.offset]};
}

std::string find_holder(const gpio_line_place& l)
{
    const chip c = read_chip(l.path);
    return l.line.offset < c.info.lines.size() ? c.info.lines[l.line.offset].consumer : std::string();
}

line_place find_line(std::span<const chip> chips, const gpio_line_name& wanted)
{
    if (wanted.name.empty() && (wanted.chip.empty() || !wanted.offset))
        throw error(error_kind::bad_input, describe_line(wanted), "a line needs chip and offset, or a name",
                    "line = { chip = \"pinctrl-rp1\", offset = 17 } or { name = \"GPIO17\" }");
    if (chips.empty())
        fail(wanted, "there is no GPIO chip on this machine",
             "load the driver of a GPIO chip, or give /dev/gpiochip* to the container");
    if (wanted.chip.empty())
        return find_named_line(chips, wanted, 0);
    const std::size_t i = find_chip(chips, wanted);
    if (chips[i].code != 0)
        detail::throw_with_cause(open_error(wanted, chips[i]), chips[i].code);
    if (wanted.name.empty())
        return {i, check_offset(chips[i], wanted)};
    return find_named_line(chips.subspan(i, 1), wanted, i);
}

std::string describe_line(const gpio_line_name& l)
{
    const std::string place = l.where.text();
    const std::string line = !l.name.empty() ? fmt::format("GPIO line \"{}\"", l.name)
                             : l.offset      ? fmt::format("GPIO line {} of {}", *l.offset, l.chip)
                                             : std::string("GPIO line");
    return place.empty() ? line : fmt::format("{}: {}", place, line);
}

std::string advice(const chip& c)
{
    return fmt::format("{} ({})", open_reason(c), open_hint(c));
}

error request_error(const gpio_line_name& l, int code, const std::string& holder)
{
    switch (code) {
    case EBUSY:
        if (holder == consumer)
            return {error_kind::not_available, describe_line(l), "busy: another tactor holds it",
                    "stop that tactor first"};
        if (holder.empty() || holder == nameless_consumer)
            return {error_kind::not_available, describe_line(l),
                    "busy: a driver or overlay of the kernel holds it", "choose another line"};
        return {error_kind::not_available, describe_line(l), fmt::format("busy: \"{}\" holds it", holder),
                "stop that program, or choose another line"};
    case EACCES:
    case EPERM:
        return {error_kind::not_available, describe_line(l),
                "the kernel does not permit this use of the line", "choose another line"};
    case EINVAL:
    case ENOTSUP:
    case ENXIO:
        return {error_kind::not_available, describe_line(l),
                fmt::format("the chip cannot do this with the line: {}", words(code)),
                "choose another line: not every chip has pull resistors, edges or outputs"};
    default:
        return {error_kind::not_available, describe_line(l),
                fmt::format("the line cannot be opened: {}", words(code))};
    }
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
