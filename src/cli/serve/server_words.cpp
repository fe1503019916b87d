// SPDX-License-Identifier: MIT
#include "cli/serve/server_words.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

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

} // namespace

error in_words_of_the_tool(const error& e, const std::string& argument)
{
    std::string what(e.subject());
    if (what == "stroke" || what == "path" || what == "toml" || what == "csv" || what == "svg") {
        const auto [at, why] = placed(argument, std::string(e.why()));
        if (at.line != 0)
            return e.reworded(at.text(), why, e.hint()).with_place(at);
        what = argument;
    } else if (what.starts_with("options.")) {
        what = "--" + what.substr(std::string_view("options.").size());
        std::replace(what.begin(), what.end(), '_', '-');
    }
    std::string hint(e.hint());
    for (std::size_t at = hint.find("options."); at != std::string::npos; at = hint.find("options."))
        hint.replace(at, std::string_view("options.").size(), "--");
    return e.reworded(what, e.why(), hint);
}

} // namespace tactor::cli
