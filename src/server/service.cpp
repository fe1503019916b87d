// SPDX-License-Identifier: MIT
#include "server/service.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <set>
#include <utility>

#include <malloc.h>

#include <fmt/format.h>

#include "core/suggest.hpp"
#include "server/faults.hpp"
#include "server/params.hpp"

namespace tactor::server {

using net::json;
using net::reply_json;

namespace {

// Returns the result of `parse`, or a refusal if there is not enough memory.
template <typename Parse>
net::rpc_message catch_bad_alloc(Parse parse)
{
    try {
        return parse();
    } catch (const std::bad_alloc&) {
        net::rpc_message m;
        m.parts.emplace_back(
            net::rpc_refusal{{net::code_limit, "limit", "message", "there is not enough memory for it",
                              "send smaller messages"}});
        return m;
    }
}

// A large message that another thread parses.
struct message_aside {
    std::string text;
    std::size_t bytes = 0;
    net::rpc_message message = {};
};

net::rpc_fault missing_hello_fault()
{
    return {net::code_no_token, "token", "token", "a hello with the token must come first", ""};
}

} // namespace

void service::pending::give(std::size_t at, std::string reply, const std::vector<std::uint32_t>& strokes)
{
    place& p = places[at];
    if (p.filled)
        return;
    p.filled = true;
    p.reply = std::move(reply);
    numbers.insert(numbers.end(), strokes.begin(), strokes.end());
    if (--open != 0)
        return;
    client* c = owner.clients_.find(to);
    if (c != nullptr) {
        --c->unanswered;
        std::string all;
        bool file = false;
        for (place& one : places) {
            if (!one.wanted)
                continue;
            file = file || one.file;
            if (batch)
                all += (all.empty() ? "[" : ",") + one.reply;
            else
                all = std::move(one.reply);
        }
        if (batch && !all.empty())
            all += ']';
        if (file)
            c->link->send_file(std::move(all));
        else if (!all.empty())
            c->link->send(std::move(all));
    }
    owner.release(numbers);
    owner.clients_.check_all_sent(to);
}

void service::pending::give(std::size_t at, const reply_json& result, const net::rpc_fault* why,
                            const std::vector<std::uint32_t>& strokes)
{
    std::string reply;
    if (!answered)
        reply = net::json_line(why == nullptr ? net::result_reply(places[at].id, result)
                                              : net::error_reply(places[at].id, *why));
    else if (owner.clients_.find(to) != nullptr)
        answered(result, why);
    give(at, std::move(reply), strokes);
}

void service::answer::send_result(const reply_json& r, const std::vector<std::uint32_t>& strokes) const
{
    all->give(at, r, nullptr, strokes);
}

std::string service::answer::format_reply(std::string_view result) const
{
    std::string reply =
        fmt::format(R"({{"jsonrpc":"2.0","id":{},"result":)", net::json_line(reply_json(all->places[at].id)));
    reply.reserve(reply.size() + result.size() + 2); // with the line end; results may be large
    return reply.append(result).append("}");
}

void service::answer::send_reply(std::string reply, bool file) const
{
    all->places[at].file = file;
    all->give(at, std::move(reply), {});
}

void service::answer::send_fault(const net::rpc_fault& f) const
{
    all->give(at, {}, &f, {});
}

service::service(boost::asio::io_context& io, service_options o, stream_options s)
    : io_(io),
      quiet_(io),
      options_(std::move(o)),
      faces_(options_.plans.tactors),
      stream_(io, add_handlers(std::move(s))),
      touch_timer_(io)
{
}

stream_options service::add_handlers(stream_options s)
{
    s.begun = [this](std::uint64_t p, stroke_id id, std::optional<std::int64_t> at) {
        handle_begin(p, id, at);
    };
    s.ended = [this](std::uint64_t p, const stroke_report& r) { handle_end(p, r); };
    s.changed = [this, owner = std::move(s.changed)](stream_state state, const std::string& why) {
        if (owner)
            owner(state, why);
        clients_.send_stream_event(state, why);
    };
    return s;
}

service::~service()
{
    ending_ = true;
}

// Returns false for a network connection whose first message is not hello, such as a POST request of a
// browser.
bool service::admitted(client& c, const net::rpc_message& m)
{
    if (c.greeted)
        return true;
    const auto* first = m.batch ? nullptr : std::get_if<net::rpc_request>(&m.parts.front());
    c.greeted = first != nullptr && first->method == "hello";
    if (!c.greeted)
        clients_.log_refusal(c.from, "a connection that does not begin with hello");
    return c.greeted;
}

bool service::receive(client_number number, std::string_view text)
{
    const client* c = clients_.find(number);
    if (c == nullptr)
        return false;
    net::rpc_message m = catch_bad_alloc([&] { return net::parse_rpc(text, options_.limits.max_nesting); });
    return receive(number, m, text.size(), mark(*c));
}

void service::receive(client_number number, net::rpc_request r, std::size_t bytes, answer_handler answered)
{
    net::rpc_message m;
    m.parts.emplace_back(std::move(r));
    if (const client* c = clients_.find(number))
        receive(number, m, bytes, mark(*c), std::move(answered));
}

// Parses the message on a planner thread. Stops that arrive before it is parsed apply to the message, too.
void service::receive_large_message(client_number number, std::string text, std::function<void(bool)> done)
{
    client* c = clients_.find(number);
    if (c != nullptr && !c->greeted)
        clients_.log_refusal(c->from, "a connection that does not begin with hello");
    if (c == nullptr || !c->greeted)
        return done(false);
    if (!c->admitted) {
        c->link->send(net::json_line(net::error_reply(nullptr, missing_hello_fault())));
        return done(true);
    }
    const auto l = std::make_shared<message_aside>(message_aside{std::move(text)});
    const auto parse = [this, l] {
        const std::string whole = std::exchange(l->text, {});
        l->bytes = whole.size();
        net::rpc_message m = net::parse_rpc(whole, options_.limits.max_nesting);
        for (auto& part : m.parts)
            if (auto* r = std::get_if<net::rpc_request>(&part))
                pack_points(r->params);
        return m;
    };
    ++c->unanswered;
    run_on_planner(
        number, [l, parse] { l->message = catch_bad_alloc(parse); },
        [this, number, l, done = std::move(done), since = mark(*c)] {
            if (client* then = clients_.find(number))
                --then->unanswered;
            const bool go_on = receive(number, l->message, l->bytes, since);
            planners_.run_in_thread([l] {}); // a planner thread destroys the message
            schedule_memory_trim();
            done(go_on);
        });
}

void service::run_on_planner(client_number number, const std::function<void()>& work,
                             std::function<void()> done)
{
    planners_.add({.client = number,
                   .work =
                       [work] {
                           try {
                               work();
                           } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): see above
                           }
                       },
                   .done = std::move(done),
                   .drop = [](bool) {},
                   .quick = true});
}

// Returns the small blocks of large messages to the system. Waits until no large message has arrived for some
// time, because trimming the heap blocks it for all threads.
void service::schedule_memory_trim()
{
    constexpr std::chrono::milliseconds quiet_for{500};
    quiet_.expires_after(quiet_for);
    quiet_.async_wait([this](const boost::system::error_code& e) {
#ifdef __GLIBC__
        if (!e)
            planners_.run_in_thread([] { ::malloc_trim(0); });
#endif
    });
}

bool service::receive(client_number number, net::rpc_message& m, std::size_t bytes, const stop_mark& since,
                      answer_handler answered)
{
    client* c = clients_.find(number);
    if (c == nullptr || !admitted(*c, m))
        return false;
    const auto all =
        std::make_shared<pending>(pending{*this, number, m.batch, std::move(answered), {}, m.parts.size()});
    for (const auto& part : m.parts) {
        const auto* r = std::get_if<net::rpc_request>(&part);
        all->places.push_back(
            {r != nullptr ? r->id : std::get<net::rpc_refusal>(part).id, r == nullptr || r->wants_reply});
    }
    ++c->unanswered;
    if (m.has_stop && c->admitted)
        stop_all(number);
    bytes /= m.parts.size();
    const std::uint64_t stops = stops_;
    const std::uint64_t cancels = *c->cancels;
    for (std::size_t i = 0; i < m.parts.size(); ++i) {
        c = clients_.find(number);
        if (c == nullptr)
            return false;
        // A stop in this message does not affect the requests after it in the message.
        const answer to{
            all, i, {since.stops + stops_ - stops, since.cancels, since.own + *c->cancels - cancels}};
        if (auto* r = std::get_if<net::rpc_request>(&m.parts[i]); r == nullptr)
            to.send_fault(std::get<net::rpc_refusal>(m.parts[i]).why);
        else
            try {
                handle(*c, *r, to, bytes);
            } catch (...) {
                to.send_fault(current_fault(r->method));
            }
    }
    return true;
}

void service::handle(client& c, net::rpc_request& r, const answer& to, std::size_t bytes)
{
    if (!c.admitted && r.method != "hello")
        throw fault_error(missing_hello_fault());
    for (const method& m : methods())
        if (m.name == r.method) {
            check_param(m.params, r.params);
            return m.call == nullptr ? add_job(c, r, to, bytes) : (this->*m.call)(c, r.params, to);
        }
    std::vector<std::string_view> known;
    for (const method& m : methods())
        known.emplace_back(m.name);
    throw fault_error({net::code_no_method, "bad-input", "method",
                       fmt::format("there is no \"{}\"", r.method), detail::choice_hint(r.method, known)});
}

bool service::input_ended(client_number number)
{
    client* c = clients_.find(number);
    if (c == nullptr)
        return true;
    c->input_over = true;
    // End live and repeated strokes, which would not end by themselves, and held strokes.
    for (const std::uint32_t n : std::set(c->strokes)) {
        const auto found = strokes_.find(n); // ending a held stroke may also end other strokes of its request
        if (found == strokes_.end())
            continue;
        stroke_record& r = found->second;
        if (r.ends_with_client) {
            cancel(r, connection_ended);
            continue;
        }
        if (r.live)
            r.live->end();
        end_rounds(r);
    }
    // A TCP client that has closed its sending side may still read. It still gets its answers, but does not
    // count as a client. If there are too many such clients, the first one is disconnected, but its strokes
    // continue.
    clients_.limit_silent_clients();
    return c->unanswered == 0 && c->strokes.empty();
}

void service::disconnect(client_number number)
{
    if (clients_.find(number) == nullptr)
        return;
    input_ended(number);
    const auto kept = clients_.remove(number); // removed first: its answers must not find it
    planners_.forget(number);
}

void service::close(std::function<void()> done)
{
    ending_ = true;
    planners_.drop_all();
    stream_.close(std::move(done));
    clients_.send_stop_event(0);
}

} // namespace tactor::server
