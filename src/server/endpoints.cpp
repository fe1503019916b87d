// SPDX-License-Identifier: MIT
// Settings of [serve], and the sockets: bound here, or inherited from the process that started this one.
#include "server/server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "net/osc.hpp"

namespace tactor::server {
namespace {

// A name of an inherited socket, and the kind of socket that it must be.
struct inheritable {
    std::string_view name;
    net::owned_fd endpoints::*place;
    bool (*fits)(int fd);
    const char* otherwise;
};

constexpr std::array known{
    inheritable{"socket", &endpoints::socket, net::is_unix_listener, "it is no Unix socket that listens"},
    inheritable{"tcp", &endpoints::tcp, net::is_tcp_listener, "it is no TCP socket that listens"},
    inheritable{"http", &endpoints::http, net::is_tcp_listener, "it is no TCP socket that listens"},
    inheritable{"osc", &endpoints::osc, net::is_bound_udp, "it is no UDP socket with a port"},
};

// Refuses a socket that everybody may write to: a user who may write to it may draw.
void check_private(const std::string& path)
{
    struct stat is {};
    const bool named = !path.empty() && ::stat(path.c_str(), &is) == 0;
    if (!named || (is.st_mode & S_IWOTH) != 0)
        throw error(error_kind::bad_input, "inherited socket \"socket\"" + (named ? " " + path : ""),
                    named ? "every user of this machine may write to it"
                          : "it is no file, whose mode would say who may draw",
                    "SocketMode=0660 and SocketGroup= in the .socket unit");
}

[[noreturn]] void no_osc(const char* what)
{
    throw error(error_kind::bad_input, what, "this build has no OSC", "build it with liblo (-Dosc=enabled)");
}

std::optional<std::pair<dev_t, ino_t>> file_at(const std::string& path) noexcept
{
    struct stat is {};
    if (::lstat(path.c_str(), &is) != 0)
        return {};
    return std::pair(is.st_dev, is.st_ino);
}

} // namespace

network_options settle_network(const options::serve_settings& s)
{
    network_options n{.allow_hosts = s.allow_hosts};
    for (const std::string& p : s.osc_peers)
        n.osc_peers.push_back(net::parse_prefix(p, "osc_peers under [serve]"));
    return n;
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

endpoints open_endpoints(const endpoint_options& o)
{
    endpoints e;
    for (auto& [name, fd] : net::inherited_sockets()) {
        const auto k =
            std::find_if(known.begin(), known.end(), [&n = name](const auto& x) { return x.name == n; });
        if (k == known.end())
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"", "it is not known",
                        "FileDescriptorName=socket, tcp, http or osc");
        if (!k->fits(fd.get()))
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"", k->otherwise,
                        "see the .socket unit");
        if (name == "osc" && !net::osc_is_built())
            no_osc("inherited socket \"osc\"");
        if (e.*k->place)
            throw error(error_kind::bad_input, "inherited socket \"" + name + "\"",
                        "there are two of that name",
                        "one ListenStream= or ListenDatagram= for each FileDescriptorName=");
        e.*k->place = std::move(fd);
    }
    if (e.socket) {
        e.socket_path = net::bound_path(e.socket.get());
        check_private(e.socket_path);
    } else {
        e.socket_path = o.socket();
        if (!e.socket_path.empty()) {
            e.socket = net::listen_unix(e.socket_path, o.mode, o.group);
            e.own_socket = file_at(e.socket_path);
        }
    }
    try {
        if (!e.tcp && o.tcp)
            e.tcp = net::listen_tcp(*o.tcp, "tcp");
        if (!e.http && o.http)
            e.http = net::listen_tcp(*o.http, "http");
        if (!e.osc && o.osc) {
            if (!net::osc_is_built())
                no_osc("osc");
            e.osc = net::bind_udp(*o.osc, "osc");
        }
    } catch (...) {
        remove_socket(e);
        throw;
    }
    for (const auto& [fd, address] : {std::pair(&e.tcp, &e.tcp_address), std::pair(&e.http, &e.http_address),
                                      std::pair(&e.osc, &e.osc_address)})
        if (*fd)
            *address = net::local_address(fd->get());
    return e;
}

void remove_socket(const endpoints& at) noexcept
{
    if (at.own_socket && file_at(at.socket_path) == at.own_socket)
        ::unlink(at.socket_path.c_str());
}

} // namespace tactor::server
