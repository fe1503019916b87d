// SPDX-License-Identifier: MIT
#include "server/clients.hpp"

#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "server/service.hpp"

namespace tactor::server {
namespace {

using net::reply_json;

constexpr unsigned most_wrong_tokens = 3;
constexpr double first_wrong_token_s = 0.2; // delay of the first answer; each further wrong token doubles it
constexpr double longest_wrong_token_s = 10.0;
constexpr std::size_t most_addresses = 1024;

std::chrono::nanoseconds to_ns(double seconds)
{
    return std::chrono::nanoseconds(std::llround(1e9 * seconds));
}

} // namespace

std::size_t client_list::places(client_kind k) const noexcept
{
    const service_limits& l = options_.limits;
    return k == client_kind::local ? l.max_clients : l.max_clients - l.kept_clients;
}

bool client_list::has_free_place(client_kind k) const
{
    constexpr std::size_t osc_part = 4; // plus a quarter for OSC clients
    const bool datagram = k == client_kind::datagram;
    const auto taken = static_cast<std::size_t>(std::count_if(all_.begin(), all_.end(), [&](const auto& c) {
        return !c.second->input_over && (c.second->kind == client_kind::datagram) == datagram;
    }));
    return taken < (datagram ? std::max<std::size_t>(1, options_.limits.max_clients / osc_part) : places(k));
}

bool client_list::is_admitted(client_number number) const
{
    const client* c = find(number);
    return c != nullptr && c->admitted;
}

void client_list::log_refusal(const std::string& from, std::string_view why)
{
    constexpr double most_a_second = 10.0;
    if (options_.log && refusals_.take(1.0, most_a_second, options_.now_ns()))
        options_.log(log_kind::warning,
                     fmt::format("refused: {} from {}", why, from.empty() ? "this computer" : from));
}

double client_list::count_wrong_token(const std::string& from)
{
    if (wrong_token_wait_s_.size() > most_addresses)
        wrong_token_wait_s_.clear();
    double& wait_s = wrong_token_wait_s_[from];
    wait_s = wait_s == 0.0 ? first_wrong_token_s : std::min(2.0 * wait_s, longest_wrong_token_s);
    log_refusal(from, "a wrong token");
    return wait_s;
}

void client_list::gather_levels()
{
    const bool any = std::any_of(all_.begin(), all_.end(),
                                 [](const auto& c) { return c.second->events.contains("levels"); });
    peaks_.listen(any);
    for (std::size_t ch = 0; any && ch < peaks_.size(); ++ch) {
        const float peak = peaks_.take(ch);
        for (const auto& [number, c] : all_)
            if (ch < c->levels.size())
                c->levels[ch] = std::max(c->levels[ch], peak);
    }
}

void client_list::send_levels(client_number number)
{
    client* waiting = find(number);
    waiting->levels_timer.async_wait([this, number](const boost::system::error_code& e) {
        client* c = find(number);
        if (e || c == nullptr || !c->events.contains("levels"))
            return;
        gather_levels();
        if (c->hears("levels")) {
            reply_json dbfs = reply_json::array();
            for (const tactor_spec& t : options_.plans.tactors.tactors) {
                const float v = t.channel < c->levels.size() ? c->levels[t.channel] : 0.0F;
                dbfs.push_back(v > 0.0F ? reply_json(20.0 * std::log10(static_cast<double>(v)))
                                        : reply_json(nullptr));
            }
            std::fill(c->levels.begin(), c->levels.end(), 0.0F);
            c->link->notify("levels", {{"t_s", seconds(options_.now_ns())}, {"dbfs", dbfs}});
        }
        const auto step = to_ns(1.0 / c->levels_hz);
        const auto next = c->levels_timer.expiry() + step;
        // Skips the notifications that fell due while the process was suspended.
        c->levels_timer.expires_at(std::max(next, std::chrono::steady_clock::now()));
        send_levels(number);
    });
}

client& client_list::add(std::shared_ptr<client_link> link, client_kind k, std::string from)
{
    const bool is_local = k == client_kind::local;
    const bool has_token = k == client_kind::network || k == client_kind::web;
    // WebSockets and datagrams need no check here: the origin of a WebSocket has been checked, and the
    // OSC socket takes datagrams only from allowed machines.
    client c{.number = ++last_,
             .link = std::move(link),
             .kind = k,
             .from = is_local ? "this computer" : std::move(from),
             .greeted = k != client_kind::network,
             .admitted = !has_token || options_.token.empty(),
             .levels_timer = boost::asio::steady_timer(io_)};
    return *all_.emplace(last_, std::make_unique<client>(std::move(c))).first->second;
}

client* client_list::find(client_number number) const
{
    const auto found = all_.find(number);
    return found == all_.end() ? nullptr : found->second.get();
}

std::unique_ptr<client> client_list::remove(client_number number)
{
    auto node = all_.extract(number);
    if (node.empty())
        return nullptr;
    node.mapped()->levels_timer.cancel();
    gather_levels();
    return std::move(node.mapped());
}

bool client_list::check_all_sent(client_number number)
{
    const client* c = find(number);
    if (c == nullptr)
        return true;
    const bool sent = c->input_over && c->unanswered == 0 && c->strokes.empty();
    if (sent && all_sent_)
        all_sent_(number);
    return sent;
}

void client_list::limit_silent_clients()
{
    const auto is_silent = [](const auto& one) { return one.second->input_over; };
    const auto silent = std::count_if(all_.begin(), all_.end(), is_silent);
    if (all_sent_ && static_cast<std::size_t>(silent) > options_.limits.max_clients)
        all_sent_(std::find_if(all_.begin(), all_.end(), is_silent)->first);
}

// Compares in constant time, so that the time does not reveal how many characters are right.
bool client_list::accepts_token(std::string_view token) const
{
    const std::string& right = options_.token;
    unsigned char differs = token.size() == right.size() ? 0 : 1;
    for (std::size_t i = 0; i < right.size(); ++i)
        differs |= static_cast<unsigned char>(right[i] ^ (i < token.size() ? token[i] : 0));
    return differs == 0 || right.empty();
}

bool client_list::admit(client& c, const std::string* token, std::function<void()> refuse)
{
    // While the answer to a wrong token is delayed, every token counts as wrong. This makes guessing slow.
    const bool compares = c.refusals_waiting == 0 && c.wrong_tokens < most_wrong_tokens;
    if (!c.admitted && compares && token != nullptr && accepts_token(*token)) {
        c.admitted = true;
        wrong_token_wait_s_.erase(c.from);
    }
    if (c.admitted || ++c.wrong_tokens > most_wrong_tokens) // the last answer closes the connection
        return c.admitted;
    const auto answer = [=, this, number = c.number, last = c.wrong_tokens == most_wrong_tokens] {
        refuse();
        client* const guest = find(number);
        if (guest != nullptr && last)
            guest->link->dismiss("three wrong tokens");
        return guest;
    };
    if (token == nullptr) {
        log_refusal(c.from, "no token");
        answer();
        return false;
    }
    ++c.refusals_waiting;
    const auto timer = std::make_shared<boost::asio::steady_timer>(io_, to_ns(count_wrong_token(c.from)));
    timer->async_wait([answer, timer](const boost::system::error_code& /*none*/) {
        if (client* const guest = answer())
            --guest->refusals_waiting;
    });
    return false;
}

void client_list::subscribe(client& c, std::set<std::string> events, double levels_hz)
{
    c.levels_hz = levels_hz;
    c.events = std::move(events);
    c.levels.assign(peaks_.size(), 0.0F);
    c.levels_timer.cancel();
    gather_levels();
    if (!c.events.contains("levels"))
        return;
    c.levels_timer.expires_after(to_ns(1.0 / levels_hz));
    send_levels(c.number);
}

void client_list::send_event(const std::string& event, const reply_json& params, client_number except)
{
    for (const auto& [number, c] : all_)
        if (number != except && c->hears(event))
            c->link->notify(event, params);
}

void client_list::send_stroke_event(client_number owner, const reply_json& params)
{
    for (const auto& [number, c] : all_)
        if (number == owner || (c->admitted && c->events.contains("strokes")))
            c->link->notify("stroke", params);
}

void client_list::send_stream_event(stream_state s, const std::string& reason)
{
    for (const auto& [number, c] : all_)
        if (c->admitted && c->greeted && (c->events.contains("stream") || s == stream_state::closing))
            c->link->notify("stream", {{"state", to_string(s)}, {"reason", reason}});
}

void client_list::send_stop_event(client_number by)
{
    const client* c = find(by);
    send_event("stops", {{"client", by}, {"name", c == nullptr ? "" : c->name}});
}

} // namespace tactor::server
