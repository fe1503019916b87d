// SPDX-License-Identifier: MIT
// What the owner of the array allows, as [serve] says it.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "server/server.hpp"

namespace tactor::server {

network_options settle_network(const options::serve_settings& s)
{
    network_options n{.allow_hosts = s.allow_hosts};
    for (const std::string& p : s.osc_peers)
        n.osc_peers.push_back(net::parse_prefix(p, "osc_peers under [serve]"));
    return n;
}

service_limits settle_limits(const options::serve_settings& s)
{
    service_limits l;
    l.max_clients = s.max_clients.value_or(l.max_clients);
    l.kept_clients = s.kept_clients.value_or(std::min(l.kept_clients, l.max_clients / 2));
    l.max_strokes = s.max_strokes.value_or(l.max_strokes);
    l.max_live_strokes = s.max_live_strokes.value_or(l.max_live_strokes);
    if (s.max_points_per_s)
        l.max_points_per_s = *s.max_points_per_s;
    l.max_stroke_s = s.max_stroke_s.value_or(l.max_stroke_s);
    l.max_message_bytes = s.max_message_bytes.value_or(l.max_message_bytes);
    l.max_nesting = s.max_nesting.value_or(l.max_nesting);
    l.max_message_s = s.max_message_s.value_or(l.max_message_s);
    l.max_unread_bytes = s.max_unread_bytes.value_or(l.max_unread_bytes);
    l.max_all_unread_bytes = s.max_all_unread_bytes.value_or(l.max_all_unread_bytes);
    l.max_all_unfinished_bytes = s.max_all_unfinished_bytes.value_or(l.max_all_unfinished_bytes);
    return l;
}

std::string read_token(const options::serve_settings& s)
{
    if (!s.token_file)
        return {};
    const std::string& file = *s.token_file;
    const net::owned_fd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat is {};
    if (!fd || ::fstat(fd.get(), &is) != 0)
        throw error(error_kind::bad_input, "token_file " + file, std::strerror(errno),
                    "a file with the token on its first line");
    if (!S_ISREG(is.st_mode) || (is.st_mode & S_IRWXO) != 0)
        throw error(error_kind::bad_input, "token_file " + file,
                    S_ISREG(is.st_mode) ? "others may read it" : "it is no regular file",
                    "chmod 600 it, and choose another token");
    char bytes[4097];
    const ssize_t n = ::read(fd.get(), bytes, sizeof bytes);
    const std::string all(bytes, n > 0 ? static_cast<std::size_t>(n) : 0);
    std::string token = all.substr(0, all.find_first_of("\r\n"));
    if (token.empty() || token.size() == sizeof bytes)
        throw error(error_kind::bad_input, "token_file " + file, "its first line is no token",
                    "1 to 4096 bytes, e.g. of: openssl rand -hex 32");
    return token;
}

} // namespace tactor::server
