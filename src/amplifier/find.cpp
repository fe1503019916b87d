// SPDX-License-Identifier: MIT
#include "amplifier/chips.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "amplifier/errors.hpp"
#include "core/refused.hpp"
#include "core/suggest.hpp"

namespace tactor::amplifier {
namespace {

constexpr std::size_t most_listed = 12;

[[noreturn]] void fail(const gpio_line_name& wanted, const std::string& why, const std::string& hint)
{
    throw error(error_kind::not_available, thing(wanted), why, hint);
}

std::string list(const std::vector<std::string>& items)
{
    const std::size_t n = std::min(items.size(), most_listed);
    std::string out =
        fmt::format("there are: {}", fmt::join(items.begin(), items.begin() + std::ptrdiff_t(n), ", "));
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
void fail_if_shut(std::span<const chip> chips, const gpio_line_name& wanted)
{
    for (const chip& c : chips)
        if (c.code != 0)
            detail::throw_caused(open_error(wanted, c), c.code);
}

std::size_t only_one(std::span<const chip> chips, const std::vector<std::size_t>& found,
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
        return only_one(chips, labelled, wanted);
    if (wanted.chip.starts_with('/'))
        fail(wanted, fmt::format("there is no {}", wanted.chip), list_chips(chips));
    for (const chip& c : chips)
        if (c.info.name == wanted.chip)
            fail(wanted,
                 fmt::format("\"{}\" is a number that the kernel gives anew at each start", wanted.chip),
                 c.code == 0
                     ? fmt::format("use the label, chip = \"{}\", or the path {}", c.info.label, c.info.path)
                     : fmt::format("use the chip's label, or the path {}", c.info.path));
    fail_if_shut(chips, wanted);
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
         "an offset counts the chip's own lines from 0");
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

[[noreturn]] void fail_unnamed(std::span<const chip> chips, const gpio_line_name& wanted)
{
    fail_if_shut(chips, wanted);
    const std::vector<std::string> names = all_names(chips);
    const std::string why = wanted.chip.empty() ? "no line has this name"
                                                : fmt::format("no line of {} has this name", wanted.chip);
    if (names.empty())
        fail(wanted, why, "no line here has a name: give chip and offset");
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view near = detail::nearest_name(wanted.name, known);
    fail(wanted, why, near.empty() ? list(names) : fmt::format("did you mean \"{}\"?", near));
}

line_place find_named(std::span<const chip> chips, const gpio_line_name& wanted, std::size_t first)
{
    std::vector<line_place> found;
    for (std::size_t i = 0; i < chips.size(); ++i)
        for (const gpio_line_info& l : chips[i].info.lines)
            if (l.name == wanted.name)
                found.push_back({first + i, l.offset});
    if (found.empty())
        fail_unnamed(chips, wanted);
    if (found.size() == 1)
        return found.front();
    std::vector<std::string> places;
    for (const line_place& p : found)
        places.push_back(fmt::format("line {} of {}", p.offset, chips[p.chip - first].info.path));
    fail(wanted, fmt::format("{} lines have this name: {}", found.size(), fmt::join(places, ", ")),
         "say which by chip and offset");
}

} // namespace

line_place find_line(std::span<const chip> chips, const gpio_line_name& wanted)
{
    if (wanted.name.empty() && (wanted.chip.empty() || !wanted.offset))
        throw error(error_kind::bad_input, thing(wanted), "a line needs chip and offset, or a name",
                    "line = { chip = \"pinctrl-rp1\", offset = 17 } or { name = \"GPIO17\" }");
    if (chips.empty())
        fail(wanted, "there is no GPIO chip on this machine",
             "GPIO chips are /dev/gpiochip*; a container has to be given them");
    if (wanted.chip.empty())
        return find_named(chips, wanted, 0);
    const std::size_t i = find_chip(chips, wanted);
    if (chips[i].code != 0)
        detail::throw_caused(open_error(wanted, chips[i]), chips[i].code);
    if (wanted.name.empty())
        return {i, check_offset(chips[i], wanted)};
    return find_named(chips.subspan(i, 1), wanted, i);
}

} // namespace tactor::amplifier
