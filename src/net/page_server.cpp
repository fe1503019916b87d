// SPDX-License-Identifier: MIT
#include "net/page_server.hpp"

#include <map>
#include <set>
#include <thread>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "net/listener.hpp"
#include "net/web_connection.hpp"

namespace tactor::net {
namespace {

namespace asio = boost::asio;

// WebSockets: a page, its reloads and a few visitors by mistake.
constexpr std::size_t most_visitors = 16;
constexpr std::size_t most_connections = 32;
constexpr message_limits page_limits{.message_bytes = 4096, .message_s = 10.0, .waiting_bytes = 1U << 20};

} // namespace

struct page_server::state {
    state(owned_fd listening, const page_document& page, handlers h)
        : fd(std::move(listening)),
          document(page),
          calls(std::move(h)),
          work(asio::make_work_guard(io)),
          door(io, fd.get(), no_descriptors_for_browsers(),
               [this](listener::socket_type s) { take(std::move(s)); })
    {
    }

    void take(listener::socket_type s);

    asio::io_context io{1};
    owned_fd fd;
    page_document document;
    handlers calls;
    asio::executor_work_guard<asio::io_context::executor_type> work;
    listener door;
    std::set<std::shared_ptr<connection>> all;
    std::map<visitor, std::shared_ptr<connection>> visitors;
    visitor last = 0;
    std::thread thread;
};

void page_server::state::take(listener::socket_type s)
{
    if (all.size() >= most_connections)
        return turn_away(s.native_handle()); // then the socket closes
    const auto c = connect_browser(io, std::move(s), page_limits, {});
    if (!c)
        return;
    all.insert(c);
    const visitor n = ++last;
    c->start({.message = [this, n](std::string_view text) { return calls.said(n, text); },
              .closed =
                  [this, n, weak = std::weak_ptr(c)] {
                      all.erase(weak.lock());
                      if (visitors.erase(n) != 0)
                          calls.left(n);
                  },
              .get =
                  [this](std::string_view path, std::string_view host, std::string_view) {
                      return path == "/" ? make_page(document, host)
                                         : web_reply{404, "text/plain", "there are / and /rpc\n", ""};
                  },
              .upgrade =
                  [this, n, weak = std::weak_ptr(c)] {
                      return visitors.size() < most_visitors && visitors.emplace(n, weak.lock()).second;
                  }});
}

page_server::page_server(owned_fd listening, const page_document& document, handlers h)
    : state_(std::make_unique<state>(std::move(listening), document, std::move(h)))
{
    state_->door.start();
    state_->thread = std::thread([s = state_.get()] { s->io.run(); });
}

page_server::~page_server()
{
    asio::post(state_->io, [s = state_.get()] {
        s->door.stop();
        for (const auto& c : std::set(s->all))
            c->finish();
        s->work.reset();
    });
    state_->thread.join();
}

void page_server::send(visitor to, std::string text)
{
    asio::post(state_->io, [s = state_.get(), to, text = std::move(text)]() mutable {
        if (const auto found = s->visitors.find(to); found != s->visitors.end())
            found->second->send(std::move(text));
    });
}

void page_server::finish(visitor v)
{
    asio::post(state_->io, [s = state_.get(), v] {
        if (const auto found = s->visitors.find(v); found != s->visitors.end())
            found->second->finish();
    });
}

} // namespace tactor::net
