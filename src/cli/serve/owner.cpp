// SPDX-License-Identifier: MIT
#include "cli/serve/owner.hpp"

#include <algorithm>
#include <new>
#include <string_view>

#include <grp.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "cli/say.hpp"
#include "files/plan/plan_json.hpp"
#include "session/variable.hpp"

namespace tactor::cli {
namespace {

constexpr const char* socket_name = "/tactor.sock";

// Of the system, where a service manager gives a folder that is not below the user's own.
bool is_systems()
{
    const std::string given = session::service_folder();
    const std::string users = session::variable("XDG_RUNTIME_DIR");
    return !given.empty() && (users.empty() || !given.starts_with(users + "/"));
}

// Returns where the Unix socket is by default; empty where nothing says so and there are other doors.
std::string default_socket(bool others)
{
    if (const std::string folder = session::runtime_folder(); !folder.empty())
        return folder + socket_name;
    if (others)
        return {};
    throw error(error_kind::bad_input, "socket",
                "neither RUNTIME_DIRECTORY nor XDG_RUNTIME_DIR says in which folder",
                "name one with --socket PATH, or under [serve] in the configuration");
}

} // namespace

options::serve_settings settle_serve(const serve_options& o, options::serve_settings s)
{
    const auto prefer = [](auto& ours, const auto& given) {
        if (given)
            ours = given;
    };
    prefer(s.socket, o.socket);
    prefer(s.tcp, o.tcp);
    prefer(s.osc, o.osc);
    prefer(s.http, o.http);
    prefer(s.idle_stop_s, o.idle_stop_s);
    return s;
}

server::endpoint_options settle_endpoints(const options::serve_settings& s)
{
    if (s.socket && s.socket->empty())
        throw error(error_kind::bad_input, "--socket", "the name is empty", "name a path");
    server::endpoint_options e;
    e.socket = [given = s.socket, others = s.tcp || s.osc || s.http] {
        return given ? *given : default_socket(others);
    };
    if (is_systems()) {
        e.mode = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;
        if (const group* g = ::getgrnam("tactor"))
            e.group = g->gr_gid;
        else
            say(stderr, "tactor: warning: there is no group tactor: only this user's group may draw\n");
    }
    if (s.tcp)
        e.tcp = net::parse_host(*s.tcp, "--tcp");
    if (s.http)
        e.http = net::parse_host(*s.http, "--http");
    if (s.osc)
        e.osc = net::parse_host(*s.osc, "--osc");
    return e;
}

void provide_descriptors(const server::service_limits& l)
{
    // Senders of OSC share one; browsers that only load the page come beside clients.
    constexpr rlim_t others = 96;
    const rlim_t wanted = l.max_clients + others;
    rlimit now{};
    if (::getrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur >= wanted)
        return;
    now.rlim_cur = std::min(wanted, now.rlim_max);
    if (::setrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur < wanted)
        say(stderr,
            "tactor: warning: too few descriptors: {} may be open, and {} clients need {}: later ones are "
            "refused (raise ulimit -n, or LimitNOFILE= of the unit)\n",
            now.rlim_cur, l.max_clients, wanted);
}

std::string plan_text(const server::planned& p, const environment& e, std::size_t most_bytes)
{
    const piece one{p.name, p.strokes, p.plans, {}, p.moved};
    std::string text;
    files::write_plans(record_plans(one, e, make_score(one, e, p.render), p.render),
                       [&](std::string_view part) {
                           if (text.size() + part.size() > most_bytes)
                               throw std::bad_alloc();
                           text += part;
                       });
    return text;
}

} // namespace tactor::cli
