// SPDX-License-Identifier: MIT
// Requests to the service, its answers, and the senders.
#include <cstdint>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "core/words.hpp"
#include "net/access.hpp"
#include "server/faults.hpp"
#include "server/osc/clients.hpp"

namespace tactor::server {
namespace {

constexpr double silent_dbfs = -200.0;
constexpr std::size_t most_words = 1000; // of an error, in bytes

} // namespace

/// The way from the service to a sender.
class osc_clients::sender_link final : public client_link {
public:
    sender_link(osc_clients& all, endpoint to) : all_(&all), to_(std::move(to)), alive_(all.alive_) {}
    void send(std::string message) override
    {
        if (!alive_.expired())
            all_->deliver(to_, message);
    }
    // A datagram is sent, or lost.
    std::size_t waiting() const override { return 0; }
    void finish() override {}

private:
    osc_clients* all_;
    endpoint to_;
    std::weak_ptr<const int> alive_;
};

// Calls `f` later, because the service may be in the middle of something.
template <typename F>
void osc_clients::later(F f)
{
    boost::asio::post(io_, [alive = std::weak_ptr(alive_), f = std::move(f)] {
        if (!alive.expired())
            f();
    });
}

osc_clients::sender* osc_clients::find(const endpoint& from)
{
    const auto found = senders_.find(from);
    return found == senders_.end() ? nullptr : found->second.get();
}

osc_clients::sender& osc_clients::admit(const endpoint& from)
{
    if (sender* s = find(from))
        return *s;
    if (!service_.has_place(client_kind::datagram))
        limit_reached("max_clients", "there is no place for one more");
    auto s = std::make_unique<sender>();
    s->link = std::make_shared<sender_link>(*this, from);
    s->client = service_.connect(s->link, client_kind::datagram, net::plain(from.address()).to_string());
    return *senders_.emplace(from, std::move(s)).first->second;
}

void osc_clients::ask(sender& s, const osc_request& r)
{
    const std::uint64_t id = ++s.last_id;
    s.asked[id] = {r.address, r.method, r.number};
    service_.receive(
        s.client,
        net::json_line(
            {{"jsonrpc", "2.0"}, {"id", id}, {"method", r.method}, {"params", net::reply_json(r.params)}}));
}

// Asks about a stroke that the sender has; waits for its number if that is not known yet.
void osc_clients::ask_about(sender& s, drawn& d, osc_request r)
{
    if (d.stroke && d.waiting.empty()) {
        r.params["stroke"] = *d.stroke;
        return ask(s, r);
    }
    if (d.waiting.size() >= most_waiting)
        limit_reached("messages", "too many wait for a stroke that has not begun");
    d.waiting.push_back(std::move(r));
}

void osc_clients::flush(const endpoint& from, std::int32_t number)
{
    while (sender* s = find(from)) {
        const auto found = s->drawn_as.find(number);
        if (found == s->drawn_as.end() || found->second.waiting.empty())
            break;
        drawn& d = found->second;
        osc_request r = std::move(d.waiting.front());
        d.waiting.pop_front();
        r.params["stroke"] = *d.stroke;
        ask(*s, r);
    }
    check_later(from);
}

void osc_clients::deliver(const endpoint& to, const std::string& text)
{
    sender* s = find(to);
    if (s == nullptr)
        return;
    const net::json m = net::json::parse(text);
    if (m.contains("method"))
        deliver_news(*s, to, m);
    else
        deliver_answer(*s, to, m);
    check_later(to);
}

void osc_clients::deliver_answer(sender& s, const endpoint& to, const net::json& m)
{
    const auto node = s.asked.extract(m["id"].get<std::uint64_t>());
    if (node.empty())
        return;
    const asked_for& a = node.mapped();
    const bool draws = a.method == "play" || a.method == "begin" || a.method == "drive";
    if (m.contains("error")) {
        const auto& why = m["error"]["message"].get_ref<const std::string&>();
        refuse(to, a.address, a.number == 0 ? why : fmt::format("stroke {}: {}", a.number, why));
        if (draws)
            s.drawn_as.erase(a.number);
    } else if (draws) {
        const auto n = m["result"]["stroke"].get<std::uint32_t>();
        s.numbers[n] = a.number;
        if (const auto d = s.drawn_as.find(a.number); d != s.drawn_as.end()) {
            d->second.stroke = n;
            if (!d->second.waiting.empty())
                later([this, to, number = a.number] { flush(to, number); });
        }
    }
}

void osc_clients::deliver_news(sender& s, const endpoint& to, const net::json& m)
{
    const net::json& p = m["params"];
    const auto& name = m["method"].get_ref<const std::string&>();
    endpoint listener = to;
    if (s.port != 0)
        listener.port(s.port);
    if (name == "stroke") {
        const auto found = s.numbers.find(p["stroke"].get<std::uint32_t>());
        if (found == s.numbers.end())
            return;
        const std::int32_t number = found->second;
        const std::string state = p["state"];
        if (const auto n = p.value("outside_points", std::uint64_t{0}); n != 0 && state != "started")
            refuse(to, "/tactor/to",
                   fmt::format("stroke {}: {} outside the array moved to its edge", number,
                               counted(n, "point")));
        if (state != "started") {
            s.numbers.erase(found);
            s.drawn_as.erase(number);
        }
        send_stroke(to, number, state);
    } else if (name == "levels") {
        std::vector<net::osc_value> dbfs;
        for (const net::json& v : p["dbfs"])
            dbfs.emplace_back(v.is_number() ? v.get<double>() : silent_dbfs);
        outside_.send(listener, net::osc_packet("/tactor/levels", dbfs));
    } else if (name == "stream") {
        outside_.send(listener, net::osc_packet("/tactor/stream", {p["state"].get<std::string>()}));
    }
}

void osc_clients::send_stroke(const endpoint& to, std::int32_t number, const std::string& state)
{
    outside_.send(to, net::osc_packet("/tactor/stroke", {std::int64_t{number}, state}));
}

void osc_clients::refuse(const endpoint& to, const std::string& address, const std::string& why)
{
    if (errors_.take(to.address(), outside_.now_ns()))
        outside_.send(to, net::osc_packet("/tactor/error", {address, why.substr(0, most_words)}));
}

void osc_clients::refuse(const endpoint& to, const std::string& address, const net::rpc_fault& f)
{
    refuse(to, address, net::fault_text(f));
}

void osc_clients::check_later(const endpoint& e)
{
    if (to_check_.insert(e).second && to_check_.size() == 1)
        later([this] { forget_idle(); });
}

void osc_clients::forget_idle()
{
    for (const endpoint& e : std::exchange(to_check_, {})) {
        const auto found = senders_.find(e);
        if (found == senders_.end() || !found->second->idle())
            continue;
        service_.disconnect(found->second->client);
        senders_.erase(found);
    }
}

} // namespace tactor::server
