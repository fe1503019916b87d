// SPDX-License-Identifier: MIT
// People who share the array: who is there, the touches of others, and stops.
#include <algorithm>
#include <chrono>
#include <utility>

#include "server/service_impl.hpp"

namespace tactor::server {
namespace {

using net::reply_json;

constexpr std::chrono::nanoseconds touch_step{1'000'000'000 / 30}; // for each stroke
constexpr double most_touches_per_s = 10'000.0;                    // to all clients together

} // namespace

// Lists the clients that are there.
reply_json service::people() const
{
    reply_json who = reply_json::array();
    for (const auto& [number, c] : clients_)
        who.push_back({{"client", number}, {"name", c->name}, {"from", c->from}});
    return who;
}

// Notifies the subscribers of an event, except for one client. Those that are behind get nothing.
void service::tell_subscribers(const std::string& event, reply_json params, client_number except)
{
    const std::string line = net::json_line(net::notification(event, std::move(params)));
    for (const auto& [number, c] : clients_)
        if (number != except && c->events.contains(event) && c->link->waiting() < enough_waiting)
            c->link->send(line);
}

void service::count_touch_listeners()
{
    touch_listeners_ =
        static_cast<std::size_t>(std::count_if(clients_.begin(), clients_.end(), [](const auto& c) {
            return c.second->events.contains("touches");
        }));
}

// Shows the last point of a live stroke to others, as often as touch_step allows: now or later.
void service::touch(stroke_record& r)
{
    if (touch_listeners_ == 0)
        return;
    const std::int64_t now = options_.now_ns();
    const bool soon = r.touch_told_ns && now - *r.touch_told_ns < touch_step.count();
    if (soon || !touches_.take(static_cast<double>(touch_listeners_), most_touches_per_s, now))
        return touch_later(r.number);
    touches_due_.erase(r.number);
    r.touch_told_ns = now;
    tell_touch(r, true);
}

void service::touch_later(std::uint32_t stroke)
{
    if (!touches_due_.insert(stroke).second || touches_due_.size() > 1)
        return;
    touch_timer_.expires_after(touch_step);
    touch_timer_.async_wait([this](const boost::system::error_code& e) {
        if (e)
            return;
        for (const std::uint32_t n : std::exchange(touches_due_, {}))
            if (const auto found = strokes_.find(n); found != strokes_.end())
                touch(*found->second);
    });
}

// Tells where a live stroke was last, at its end.
void service::end_touch(stroke_record& r)
{
    touches_due_.erase(r.number);
    if (r.touched && touch_listeners_ != 0)
        tell_touch(r, false);
}

void service::tell_touch(const stroke_record& r, bool down)
{
    tell_subscribers("touches",
                     {{"client", r.owner},
                      {"stroke", r.number},
                      {"x_mm", r.touched->x_mm},
                      {"y_mm", r.touched->y_mm},
                      {"down", down}},
                     r.owner);
}

// Tells who stopped everything; 0: the owner.
void service::tell_stop(client_number by)
{
    const client* c = find(by);
    tell_subscribers("stops", {{"client", by}, {"name", c == nullptr ? "" : c->name}});
}

} // namespace tactor::server
