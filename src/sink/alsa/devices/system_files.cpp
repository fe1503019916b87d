// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/system_files.hpp"

#include <fstream>

namespace tactor::pcm {

namespace fs = std::filesystem;

std::string trimmed(std::string_view s)
{
    const auto from = s.find_first_not_of(" \t");
    return from == s.npos ? "" : std::string(s.substr(from, s.find_last_not_of(" \t\n") + 1 - from));
}

std::vector<std::string> lines_of(const fs::path& file)
{
    std::vector<std::string> lines;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
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
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    return all;
}

} // namespace tactor::pcm
