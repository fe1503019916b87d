// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/system_files.hpp"

#include "core/split.hpp"
#include "rt/system_files.hpp"

namespace tactor::pcm {

namespace fs = std::filesystem;

std::string trimmed(std::string_view s)
{
    const auto from = s.find_first_not_of(" \t");
    return from == s.npos ? "" : std::string(s.substr(from, s.find_last_not_of(" \t\n") + 1 - from));
}

std::vector<std::string> lines_of(const fs::path& file)
{
    const std::string text = rt::text_of(file.string());
    std::vector<std::string> lines;
    for (const std::string_view line : tactor::detail::split(text, '\n'))
        lines.emplace_back(line);
    if (lines.back().empty()) // text after the last line end
        lines.pop_back();
    return lines;
}

std::string field(const fs::path& file, std::string_view key)
{
    for (const std::string& line : lines_of(file)) {
        const auto colon = line.find(':');
        if (colon != line.npos && trimmed(line.substr(0, colon)) == key)
            return trimmed(line.substr(colon + 1));
    }
    return {};
}

std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    for (const std::string& name : rt::names_in(folder.string()))
        all.push_back(folder / name);
    return all;
}

} // namespace tactor::pcm
