// SPDX-License-Identifier: MIT
#include "net/listen.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <system_error>

#include <boost/asio/ip/address.hpp>
#include <boost/system/error_code.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/split.hpp"
#include "net/access.hpp"

namespace tactor::net {
namespace {

namespace fs = std::filesystem;

std::string_view socket_error_hint(int code)
{
    switch (code) {
    case EADDRINUSE:
        return "end the other server, or choose another address";
    case EADDRNOTAVAIL:
        return "give an address of this machine, see ip addr";
    case EACCES:
    case EPERM:
    case EROFS:
        return "name a folder in which you can create files";
    case ENOSPC:
    case EDQUOT:
        return "free some space";
    default:
        return detail::errno_hint(code);
    }
}

[[noreturn]] void refused(const std::string& what, int code, std::string_view hint = {})
{
    constexpr std::array unavailable{EADDRINUSE, EACCES, EADDRNOTAVAIL, EPERM, EROFS};
    const auto kind =
        std::ranges::count(unavailable, code) != 0 ? error_kind::not_available : error_kind::runtime;
    detail::throw_with_cause(
        error(kind, what, std::strerror(code), hint.empty() ? socket_error_hint(code) : hint), code);
}

sockaddr_un unix_address(const std::string& path)
{
    sockaddr_un a{};
    a.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof a.sun_path)
        throw error(error_kind::bad_input, "socket " + path,
                    fmt::format("its name has {} bytes", path.size()),
                    fmt::format("use 1 to {} bytes", sizeof a.sun_path - 1));
    std::memcpy(static_cast<char*>(a.sun_path), path.c_str(), path.size() + 1);
    return a;
}

const sockaddr* generic(const sockaddr_un& a)
{
    return reinterpret_cast<const sockaddr*>(&a); // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
}

// Returns a description such as "tactor, process 1234", or only the number if the process has no name.
std::string process_name(pid_t pid)
{
    std::string name;
    std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), name);
    return name.empty() ? fmt::format("process {}", pid) : fmt::format("{}, process {}", name, pid);
}

// Removes a socket on which no process listens, so that its name can be used again. Throws if a process
// listens on it, or if the file is not a socket.
void remove_stale_socket(const std::string& path)
{
    struct stat s {};
    if (::lstat(path.c_str(), &s) != 0) {
        if (errno == ENOENT)
            return;
        refused("socket " + path, errno);
    }
    if (!S_ISSOCK(s.st_mode))
        throw error(error_kind::bad_input, "socket " + path, "a file that is not a socket has this name",
                    "choose another name, or remove the file");
    const owned_fd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const sockaddr_un a = unix_address(path);
    // EAGAIN means that the queue is full, so a process is listening.
    if (::connect(probe.get(), generic(a), sizeof a) == 0 || errno == EAGAIN) {
        ucred peer{};
        socklen_t n = sizeof peer;
        const bool known = ::getsockopt(probe.get(), SOL_SOCKET, SO_PEERCRED, &peer, &n) == 0 && peer.pid > 0;
        throw error(error_kind::not_available, "socket " + path,
                    fmt::format("{} listens there already", known ? process_name(peer.pid) : "somebody"),
                    "use that server, or name another socket");
    }
    if (errno != ECONNREFUSED)
        refused("socket " + path, errno);
    if (::unlink(path.c_str()) != 0 && errno != ENOENT)
        refused("socket " + path, errno);
}

int option(int fd, int name)
{
    int v = 0;
    socklen_t n = sizeof v;
    return ::getsockopt(fd, SOL_SOCKET, name, &v, &n) == 0 ? v : -1;
}

bool listens(int fd)
{
    return option(fd, SO_TYPE) == SOCK_STREAM && option(fd, SO_ACCEPTCONN) == 1;
}

/// The address of one end of a socket.
struct socket_end {
    sockaddr_storage at{};
    socklen_t size = sizeof(sockaddr_storage);

    explicit socket_end(int fd, decltype(&::getsockname) get = ::getsockname)
    {
        if (get(fd, generic(), &size) != 0)
            at.ss_family = AF_UNSPEC;
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket API requires it
    sockaddr* generic() { return reinterpret_cast<sockaddr*>(&at); }
    /// Returns the IP address. Returns nothing for a Unix socket, or if the peer has disconnected.
    std::optional<boost::asio::ip::address> address()
    {
        char host[NI_MAXHOST];
        if (::getnameinfo(generic(), size, host, sizeof host, nullptr, 0, NI_NUMERICHOST) != 0)
            return {};
        boost::system::error_code other;
        const auto found = boost::asio::ip::make_address(&host[0], other);
        return other ? std::nullopt : std::optional(found);
    }
};

// Adds the names of the sockets with this port, in the form of links in /proc/PID/fd.
void add_sockets(const std::string& table, const std::string& port, bool stream, std::set<std::string>& to)
{
    constexpr const char* listens = "0A";
    std::ifstream file("/proc/net/" + table);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream in(line);
        std::string number, local, remote, state, queues, timer, retries, user, timeout, inode;
        in >> number >> local >> remote >> state >> queues >> timer >> retries >> user >> timeout >> inode;
        if (local.ends_with(port) && (!stream || state == listens))
            to.insert("socket:[" + inode + "]");
    }
}

bool holds(const fs::path& process, const std::set<std::string>& sockets)
{
    std::error_code failed;
    for (fs::directory_iterator at(process / "fd", failed), end; !failed && at != end; at.increment(failed)) {
        std::error_code gone;
        if (sockets.contains(fs::read_symlink(at->path(), gone).string()))
            return true;
    }
    return false;
}

[[noreturn]] void refuse_port(const std::string& what, std::uint16_t port, bool stream, int code)
{
    const std::string holder = code == EADDRINUSE ? find_port_holder(port, stream) : "";
    if (holder.empty())
        refused(what, code,
                code == EACCES && port < 1024
                    ? "use another port, such as 4003: ports below 1024 need special rights"
                    : "");
    detail::throw_with_cause(error(error_kind::not_available, what,
                                   fmt::format("{} by {}", std::strerror(code), holder),
                                   "choose another port, or end that program"),
                             code);
}

// Binds a socket. Also listens if it is a stream.
owned_fd bind_internet(const host_and_port& at, const std::string& what, int type)
{
    addrinfo hints{};
    hints.ai_socktype = type;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const int failed = ::getaddrinfo(at.host.c_str(), std::to_string(at.port).c_str(), &hints, &found);
    const std::string where = fmt::format("{} {}:{}", what, at.host, at.port);
    if (failed != 0)
        throw error(error_kind::bad_input, where, ::gai_strerror(failed), "give an address of this machine");
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> freed(found, ::freeaddrinfo);
    owned_fd fd(::socket(found->ai_family, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int yes = 1;
    const bool stream = type == SOCK_STREAM;
    // Datagram sockets must not set SO_REUSEADDR: with it, a second socket on the port could take packets
    // from the first.
    if (!fd || (stream && ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0) ||
        ::bind(fd.get(), found->ai_addr, found->ai_addrlen) != 0 ||
        (stream && ::listen(fd.get(), SOMAXCONN) != 0))
        refuse_port(where, at.port, stream, errno);
    return fd;
}

} // namespace

host_and_port parse_host(std::string_view text, const std::string& what)
{
    host_and_port at;
    const std::string all(text);
    std::string_view port = text;
    if (const auto colon = text.rfind(':'); colon != std::string_view::npos) {
        std::string_view host = text.substr(0, colon);
        if (host.size() >= 2 && host.front() == '[' && host.back() == ']')
            host = host.substr(1, host.size() - 2);
        else if (host.find(':') != std::string_view::npos)
            host = {}; // an IPv6 address needs brackets
        at.host = host;
        port = text.substr(colon + 1);
    }
    const auto number = detail::parse_number_text<decltype(at.port)>(port);
    const bool is_digits = !port.empty() && port.find_first_not_of("0123456789") == std::string_view::npos;
    if (!at.host.empty() && !number && is_digits)
        throw error(error_kind::bad_input, what, fmt::format("{} is not a port", port),
                    "give 0 to 65535; 0 selects a free port");
    if (at.host.empty() || !number)
        throw error(error_kind::bad_input, what, fmt::format("\"{}\" is not an address", all),
                    "give [HOST:]PORT, such as 4001, 0.0.0.0:4001 or [::1]:4001; port 0 selects a free one");
    at.port = *number;
    return at;
}

owned_fd listen_unix(const std::string& path, mode_t mode, std::optional<gid_t> group)
{
    const std::string what = "socket " + path;
    const sockaddr_un a = unix_address(path);
    const auto slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    // Locks the folder, so that servers that start at the same time check and bind one after the other.
    const owned_fd lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!lock) {
        const int code = errno;
        detail::throw_with_cause(
            error(error_kind::bad_input, what, std::strerror(code),
                  code == EACCES ? "name a folder that belongs to you" : "create its folder first"),
            code);
    }
    constexpr int tries = 200;
    static_cast<void>(detail::lock_file(lock, tries)); // continues even without the lock
    remove_stale_socket(path);
    owned_fd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    // bind() gives the file the mode of the socket, reduced by the umask, so the file never has more
    // permissions.
    if (!fd || ::fchmod(fd.get(), S_IRUSR | S_IWUSR) != 0 || ::bind(fd.get(), generic(a), sizeof a) != 0)
        refused(what, errno);
    const bool has_group = !group || ::lchown(path.c_str(), static_cast<uid_t>(-1), *group) == 0;
    if (!has_group || ::chmod(path.c_str(), mode) != 0 || ::listen(fd.get(), SOMAXCONN) != 0) {
        const int code = errno;
        ::unlink(path.c_str());
        refused(what, code);
    }
    return fd;
}

owned_fd listen_tcp(const host_and_port& at, const std::string& what)
{
    return bind_internet(at, what, SOCK_STREAM);
}

owned_fd bind_udp(const host_and_port& at, const std::string& what)
{
    return bind_internet(at, what, SOCK_DGRAM);
}

std::string local_address(int fd)
{
    socket_end b(fd);
    char host[NI_MAXHOST];
    char port[NI_MAXSERV];
    if (::getnameinfo(b.generic(), b.size, host, sizeof host, port, sizeof port,
                      NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return {};
    return b.at.ss_family == AF_INET6 ? fmt::format("[{}]:{}", &host[0], &port[0])
                                      : fmt::format("{}:{}", &host[0], &port[0]);
}

std::string peer_address(int fd)
{
    const auto address = socket_end(fd, ::getpeername).address();
    return address ? simplify_address(*address).to_string() : std::string();
}

bool is_loopback(int fd)
{
    const auto address = socket_end(fd).address();
    return address && address->is_loopback();
}

bool is_unix_listener(int fd)
{
    return socket_end(fd).at.ss_family == AF_UNIX && listens(fd);
}

bool is_tcp_listener(int fd)
{
    const auto family = socket_end(fd).at.ss_family;
    return (family == AF_INET || family == AF_INET6) && listens(fd);
}

bool is_bound_udp(int fd)
{
    const socket_end b(fd);
    sockaddr_in four{}; // the port is at the same offset for IPv4 and IPv6
    std::memcpy(&four, &b.at, sizeof four);
    const bool internet = b.at.ss_family == AF_INET || b.at.ss_family == AF_INET6;
    return internet && option(fd, SO_TYPE) == SOCK_DGRAM && four.sin_port != 0;
}

std::string bound_path(int fd)
{
    const socket_end b(fd);
    sockaddr_un a{};
    if (b.at.ss_family != AF_UNIX)
        return {};
    std::memcpy(&a, &b.at, sizeof a);
    return static_cast<const char*>(a.sun_path);
}

std::vector<std::pair<std::string, owned_fd>> take_inherited_sockets()
{
    constexpr int first = 3;
    constexpr int most = 64;
    std::vector<std::pair<std::string, owned_fd>> found;
    const char* pid = std::getenv("LISTEN_PID");
    const char* count = std::getenv("LISTEN_FDS");
    const char* names = std::getenv("LISTEN_FDNAMES");
    if (pid == nullptr || count == nullptr || std::to_string(::getpid()) != pid)
        return found;
    std::vector<std::string_view> all_names = detail::split(names == nullptr ? "" : names, ':');
    all_names.resize(std::clamp(detail::parse_number_text<int>(count).value_or(0), 0, most));
    for (const std::string_view name : all_names) {
        owned_fd fd(first + static_cast<int>(found.size()));
        ::fcntl(fd.get(), F_SETFD, FD_CLOEXEC);
        ::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) | O_NONBLOCK);
        found.emplace_back(name, std::move(fd));
    }
    for (const char* v : {"LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES"})
        ::unsetenv(v);
    return found;
}

void notify_manager(std::string_view text) noexcept
{
    const char* to = std::getenv("NOTIFY_SOCKET");
    sockaddr_un a{};
    a.sun_family = AF_UNIX;
    if (to == nullptr || std::strlen(to) < 2 || std::strlen(to) >= sizeof a.sun_path)
        return;
    std::memcpy(static_cast<char*>(a.sun_path), to, std::strlen(to));
    if (a.sun_path[0] == '@')
        a.sun_path[0] = '\0';
    const owned_fd fd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(to));
    [[maybe_unused]] const ssize_t sent =
        ::sendto(fd.get(), text.data(), text.size(), MSG_NOSIGNAL, generic(a), size);
}

std::string find_port_holder(std::uint16_t port, bool stream)
{
    std::set<std::string> sockets;
    for (const char* version : {"", "6"})
        add_sockets(fmt::format("{}{}", stream ? "tcp" : "udp", version), fmt::format(":{:04X}", port),
                    stream, sockets);
    if (sockets.empty())
        return {};
    std::error_code failed;
    for (fs::directory_iterator at("/proc", failed), end; !failed && at != end; at.increment(failed)) {
        const std::string name = at->path().filename().string();
        if (const auto pid = detail::parse_number_text<pid_t>(name); pid && holds(at->path(), sockets))
            return process_name(*pid);
    }
    return "another user's process";
}

} // namespace tactor::net
