// SPDX-License-Identifier: MIT
#include "cli/serve/server_words.hpp"

#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "cli/option_words.hpp"

namespace tactor::cli {
namespace {

/// "3:5: no number" as 3, 5 and "no number"; line 0 where it does not begin so.
std::pair<source_place, std::string> placed(const std::string& file, const std::string& why)
{
    source_place at{.file = file};
    const char* const end = why.data() + why.size();
    const auto line = std::from_chars(why.data(), end, at.line);
    if (line.ec != std::errc() || line.ptr == end || *line.ptr != ':')
        return {{}, why};
    const auto column = std::from_chars(line.ptr + 1, end, at.column);
    const char* const rest = column.ec == std::errc() ? column.ptr : line.ptr;
    if (end - rest < 2 || rest[0] != ':' || rest[1] != ' ')
        return {{}, why};
    return {at, std::string(rest + 2, end)};
}

// "options.level_dbfs" as "--level-dbfs".
std::string in_options(std::string_view text)
{
    constexpr std::string_view prefix = "options.";
    std::string out;
    for (std::size_t at = 0; (at = text.find(prefix)) != text.npos;) {
        out.append(text.substr(0, at));
        text.remove_prefix(at + prefix.size());
        const std::string_view name = text.substr(0, text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"));
        const options::option* o = options::find(name);
        out += o == nullptr ? fmt::format("{}{}", prefix, name) : option_name(*o);
        text.remove_prefix(name.size());
    }
    return out.append(text);
}

} // namespace

error in_words_of_the_tool(const error& e, const std::string& argument)
{
    std::string what(e.subject());
    if (what == "stroke" || what == "path" || what == "toml" || what == "csv" || what == "svg") {
        const auto [at, why] = placed(argument, std::string(e.why()));
        if (at.line != 0)
            return e.reworded(at.text(), why, e.hint()).with_place(at);
        what = argument;
    } else {
        what = in_options(what);
    }
    return e.reworded(what, in_options(e.why()), in_options(e.hint()));
}

} // namespace tactor::cli
