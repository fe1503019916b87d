// SPDX-License-Identifier: MIT
#include "cli/check/proc_files.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>
#include <system_error>

namespace tactor::cli {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    std::sort(all.begin(), all.end());
    return all;
}

// A process may end meanwhile: what reads stream buffers itself would throw then.
std::string text_of(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    std::string s = text.str();
    while (!s.empty() && (s.back() == '\n' || s.back() == '\0'))
        s.pop_back();
    return s;
}

std::vector<process_folder> processes(const fs::path& root)
{
    std::vector<process_folder> all;
    for (const fs::path& process : entries(root / "proc")) {
        const std::string name = process.filename().string();
        int pid = 0;
        const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), pid);
        if (wrong == std::errc() && end == name.data() + name.size())
            all.push_back({pid, process});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
    return all;
}

} // namespace tactor::cli
