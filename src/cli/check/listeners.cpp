// SPDX-License-Identifier: MIT
// Files under /proc: processes, and the endpoints of running services of this tool.
#include "cli/check/system_facts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>

#include <arpa/inet.h>
#include <netinet/in.h>

#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::cli {

namespace {

namespace fs = std::filesystem;

// Endpoints of all listening sockets, by inode.
using by_inode = std::map<std::string, endpoint>;

// Returns the first ten words of each line.
std::vector<std::array<std::string, 10>> read_rows(const fs::path& file)
{
    std::vector<std::array<std::string, 10>> rows;
    std::istringstream lines(read_trimmed(file));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        for (std::string& word : rows.emplace_back())
            words >> word;
    }
    return rows;
}

// Adds sockets of lines "sl local_address rem_address st ... inode"; the inode is the tenth word.
void read_internet(const fs::path& file, std::string_view waiting, const char* before, by_inode& all)
{
    for (const auto& row : read_rows(file))
        if (endpoint e = parse_endpoint(row[1]); row[3] == waiting && !e.at.empty()) {
            e.at.insert(0, before);
            all[row[9]] = std::move(e);
        }
}

// Adds listening sockets of lines "Num RefCount Protocol Flags Type St Inode Path".
void read_unix(const fs::path& file, by_inode& all)
{
    constexpr unsigned accepts = 0x10000;
    for (const auto& row : read_rows(file))
        if ((detail::number_in<unsigned>(row[3], 16).value_or(0) & accepts) != 0 && !row[7].empty())
            all[row[6]] = {row[7], false};
}

bool serves(const fs::path& process)
{
    // Each argument ends with a zero.
    const std::string arguments = read_trimmed(process / "cmdline");
    const std::string first = arguments.substr(arguments.find('\0') + 1);
    return read_trimmed(process / "comm") == "tactor" && first.substr(0, first.find('\0')) == "serve";
}

} // namespace

endpoint parse_endpoint(std::string_view hexadecimal)
{
    const std::size_t colon = hexadecimal.find(':');
    const std::string_view address = hexadecimal.substr(0, colon);
    if (colon == std::string_view::npos || (address.size() != 8 && address.size() != 32))
        return {};
    const auto port = detail::number_in<std::uint16_t>(hexadecimal.substr(colon + 1), 16);
    // Words of 32 bits in the byte order of this machine.
    std::array<std::uint32_t, 4> words{};
    for (std::size_t i = 0; i < address.size() / 8; ++i) {
        const auto word = detail::number_in<std::uint32_t>(address.substr(8 * i, 8), 16);
        if (!word)
            return {};
        words[i] = *word;
    }
    const bool old = address.size() == 8;
    const auto bytes = std::bit_cast<std::array<unsigned char, 16>>(words);
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (!port || ::inet_ntop(old ? AF_INET : AF_INET6, bytes.data(), text.data(), text.size()) == nullptr)
        return {};
    const std::string name = text.data();
    const bool loopback = name.starts_with("127.") || name == "::1" || name.starts_with("::ffff:127.");
    return {old ? fmt::format("{}:{}", name, *port) : fmt::format("[{}]:{}", name, *port), !loopback};
}

std::vector<listening_service> find_services(const fs::path& root)
{
    by_inode all;
    for (const char* file : {"proc/net/tcp", "proc/net/tcp6"})
        read_internet(root / file, "0A", "", all); // TCP_LISTEN
    for (const char* file : {"proc/net/udp", "proc/net/udp6"})
        read_internet(root / file, "07", "osc ", all); // bound, without a peer
    read_unix(root / "proc/net/unix", all);
    std::vector<listening_service> found;
    for (const process_folder& process : processes(root)) {
        if (!serves(process.path))
            continue;
        listening_service s;
        s.who = {process.pid, "tactor"};
        std::error_code refused;
        static_cast<void>(fs::directory_iterator(process.path / "fd", refused));
        s.may_look = !refused;
        for (const fs::path& descriptor : entries(process.path / "fd")) {
            std::error_code gone;
            const std::string to = fs::read_symlink(descriptor, gone).string();
            if (!to.starts_with("socket:["))
                continue;
            const auto at = all.find(to.substr(8, to.size() - 9));
            if (at != all.end())
                s.endpoints.push_back(at->second);
        }
        found.push_back(std::move(s));
    }
    return found;
}

std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    std::sort(all.begin(), all.end());
    return all;
}

// Reads by operator<<, which does not throw if the process ends meanwhile.
std::string read_trimmed(const fs::path& file)
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
    for (const fs::path& process : entries(root / "proc"))
        if (const auto pid = detail::number_in<int>(process.filename().string()))
            all.push_back({*pid, process});
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
    return all;
}

} // namespace tactor::cli
