// SPDX-License-Identifier: MIT
#include "study/experiment/observer_text.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"

namespace tactor::study {

void read_observer(std::string_view text, std::span<const observer_key> keys, std::string_view example)
{
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, "--simulate", why,
                    fmt::format("give a value such as {}", example));
    };
    std::vector<const observer_key*> seen;
    for (std::string_view item : detail::split(text, ',')) {
        const std::size_t equals = item.find('=');
        if (equals == item.npos && (seen.empty() || !seen.back()->is_list))
            refuse(fmt::format("\"{}\" has no =", item));
        if (equals != item.npos) {
            const std::string_view name = item.substr(0, equals);
            const auto key = std::ranges::find(keys, name, &observer_key::name);
            if (key == keys.end())
                refuse(fmt::format("the key \"{}\" is unknown", name));
            if (std::ranges::count(seen, &*key) != 0)
                refuse(fmt::format("{} occurs twice", name));
            seen.push_back(&*key);
            item.remove_prefix(equals + 1);
        }
        const observer_key& key = *seen.back();
        const auto v = detail::parse_number_text<double>(item);
        const bool has_digits = !key.is_whole || detail::parse_number_text<std::uint64_t>(item);
        if (!v || !has_digits || !(*v >= key.low && *v <= key.high))
            refuse(fmt::format("{} is \"{}\", not a {}number from {} to {}", key.name, item,
                               key.is_whole ? "whole " : "", key.low, key.high));
        key.set(*v);
    }
}

} // namespace tactor::study
