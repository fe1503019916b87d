// SPDX-License-Identifier: MIT
#include "cli/option_words.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "options/option.hpp"

namespace tactor::cli {
namespace {

constexpr std::array own_words{options::own_word{"command:plan", "tactor plan STROKE --format json"},
                               options::own_word{"array=none", "say no --array"},
                               options::own_word{"force=true", "--force"},
                               options::own_word{"wider=true", "without a number of channels it"}};

std::string spell_option(const options::option& o, std::string_view value)
{
    if (value.empty() || o.what == options::kind::flag)
        return option_name(o);
    return fmt::format("{} {}", o.letter.empty() ? option_name(o) : fmt::format("-{}", o.letter), value);
}

constexpr options::spelling by_tool{.write = spell_option, .own = own_words};

} // namespace

std::string option_name(const options::option& o)
{
    return "--" + options::dashed(o);
}

std::string_view bare_name(std::string_view name) noexcept
{
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

std::string spelled(std::string_view marked)
{
    return options::spell(marked, by_tool);
}

error in_options(const error& e)
{
    return options::spell(e, by_tool);
}

} // namespace tactor::cli
