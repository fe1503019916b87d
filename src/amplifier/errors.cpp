// SPDX-License-Identifier: MIT
#include "amplifier/errors.hpp"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace tactor::amplifier {
namespace {

std::string words(int code)
{
    return std::generic_category().message(code);
}

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
        return fmt::format("{} cannot be opened: tactor was built without GPIO", path);
    default:
        return fmt::format("{} cannot be opened: {}", path, words(c.code));
    }
}

std::string open_hint(const chip& c)
{
    if (c.code == ENOSYS)
        return "build it anew with -Dgpio=enabled, where libgpiod is";
    if (c.code != EACCES && c.code != EPERM)
        return "{command:devices} lists the chips";
    if (c.group == "root")
        return "the device is root's alone: sudo groupadd --system --force gpio, install the udev rules, "
               "which give it "
               "to that group, then sudo usermod -aG gpio $USER, and log in again";
    return fmt::format("sudo usermod -aG {} $USER, then log in again", c.group.empty() ? "gpio" : c.group);
}

} // namespace

std::string thing(const gpio_line_name& l)
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

error open_error(const gpio_line_name& l, const chip& c)
{
    return {error_kind::not_available, thing(l), open_reason(c), open_hint(c)};
}

error request_error(const gpio_line_name& l, int code, const std::string& holder)
{
    switch (code) {
    case EBUSY:
        if (holder == consumer)
            return {error_kind::not_available, thing(l), "busy: another tactor holds it",
                    "stop that one first"};
        if (holder.empty() || holder == nameless_consumer)
            return {error_kind::not_available, thing(l), "busy: the kernel holds it",
                    "a driver or overlay uses the pin; choose another line"};
        return {error_kind::not_available, thing(l), fmt::format("busy: \"{}\" holds it", holder),
                "stop that program, or choose another line"};
    case EACCES:
    case EPERM:
        return {error_kind::not_available, thing(l), "the kernel does not permit this use of the line",
                "choose another line"};
    case EINVAL:
    case ENOTSUP:
    case ENXIO:
        return {error_kind::not_available, thing(l),
                fmt::format("the chip cannot do this with the line: {}", words(code)),
                "not every chip has pull resistors, edges or outputs; choose another line"};
    default:
        return {error_kind::not_available, thing(l), fmt::format("the line cannot be had: {}", words(code))};
    }
}

} // namespace tactor::amplifier
