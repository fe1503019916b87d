// Readers of OSC messages. Each message becomes a request. Requests are handled immediately, except requests
// about a live stroke that begins later.
#include "server/osc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "net/access.hpp"
#include "server/bhaptics.hpp"
#include "server/faults.hpp"
#include "session/live_remarks.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::osc_message;
using net::osc_value;

// Reader that takes the values of a message one by one.
class value_list {
public:
    explicit value_list(const osc_message& m) : all_(m.values) {}

    bool has_more() const { return next_ != all_.size(); }
    bool next_is_number() const { return has_more() && as_number(all_[next_]); }
    /// Returns true if the next value is 0 or false, which means that a button was released.
    bool released() const
    {
        if (!has_more())
            return false;
        const auto* other = std::get_if<net::osc_other>(&all_[next_]);
        return as_number(all_[next_]) == 0.0 || (other != nullptr && other->tag == 'F');
    }

    double number(const char* what, const char* hint = "send a number")
    {
        const std::optional<double> x = as_number(take(what, hint));
        if (!x)
            refuse_param(what, "it is not a number", "send it as i, h, f or d, not as a text");
        if (!std::isfinite(*x))
            refuse_param(what, "it is not finite");
        return *x;
    }
    template <typename Whole>
    Whole whole(const char* what, Whole low, const char* hint = "")
    {
        const double x = number(what);
        constexpr Whole high = std::numeric_limits<Whole>::max();
        if (x != std::floor(x) || x < low || x > high)
            refuse_param(what, fmt::format("{} is not a whole number from {} to {}", x, low, high), hint);
        return static_cast<Whole>(x);
    }
    const std::string& text(const char* what)
    {
        const auto* s = std::get_if<std::string>(&take(what, "send a text"));
        if (s == nullptr)
            refuse_param(what, "it is not a text", "send it as s");
        return *s;
    }
    void ignore_rest() { next_ = all_.size(); }
    void end() const
    {
        if (has_more())
            refuse_param("values", fmt::format("there are {}, but only {} are allowed", all_.size(), next_));
    }

private:
    static std::optional<double> as_number(const osc_value& v)
    {
        if (const auto* n = std::get_if<std::int64_t>(&v))
            return static_cast<double>(*n);
        if (const auto* x = std::get_if<double>(&v))
            return *x;
        return {};
    }
    const osc_value& take(const char* what, const char* kind)
    {
        if (!has_more())
            refuse_param(what, "it is missing", kind);
        return all_[next_++];
    }

    const std::vector<osc_value>& all_;
    std::size_t next_ = 0;
};

constexpr auto lowest_number = std::numeric_limits<std::int32_t>::min();

// Adds an option such as "soa=0.07" to `into`. The value is in JSON.
void read_option(const std::string& word, json& into)
{
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
        refuse_param("options", fmt::format("\"{}\" is not an option", word), "write it as soa=0.07");
    const std::string name = word.substr(0, equals);
    const std::string value = word.substr(equals + 1);
    if (into.contains(name))
        refuse_param("options." + name, "it occurs twice");
    if (const auto x = detail::parse_number_text<double>(value); x && std::isfinite(*x))
        into[name] = *x;
    else if (value == "true" || value == "false")
        into[name] = value == "true";
    else
        into[name] = value;
}

json read_options(value_list& v)
{
    json options = json::object();
    while (v.has_more())
        read_option(v.text("options"), options);
    return options;
}

constexpr const char* number_first =
    "the stroke's number comes first: /tactor/begin 1, then /tactor/to 1 X Y in mm";

std::int32_t take_stroke_number(value_list& v)
{
    const auto n = v.whole<std::int32_t>("number", lowest_number, number_first);
    if (n == 0)
        refuse_param("number", "0 means no number", "use a number other than 0");
    return n;
}

void read_play(value_list& v, osc_request& r)
{
    if (v.next_is_number())
        r.number = v.whole<std::int32_t>("number", lowest_number);
    const std::string& what = v.text("stroke");
    const auto& presets = stroke_presets();
    const bool preset = std::find(presets.begin(), presets.end(), what) != presets.end();
    const auto first = what.find_first_not_of(" \t\r\n");
    const bool path = !preset && first != std::string::npos && (what[first] == 'M' || what[first] == 'm');
    r.params[path ? "path" : "stroke"] = what;
    r.params["options"] = read_options(v);
}

void read_begin(value_list& v, osc_request& r)
{
    r.number = take_stroke_number(v);
    json options = read_options(v);
    for (const char* own : {"timeout_s", "smooth_s"})
        if (const auto t = options.find(own); t != options.end()) {
            r.params[own] = *t;
            options.erase(t);
        }
    r.params["options"] = std::move(options);
}

void read_move_to(value_list& v, osc_request& r)
{
    r.number = take_stroke_number(v);
    r.params["x_mm"] = v.number("x_mm");
    r.params["y_mm"] = v.number("y_mm", number_first); // a touch pad may send only a place
    if (v.has_more())
        r.params["intensity"] = v.number("intensity");
}

void read_own_stroke(value_list& v, osc_request& r)
{
    r.number = take_stroke_number(v);
    v.ignore_rest();
}

// Reads a stop. If the first value is 0 or false, a button was released, and nothing is stopped. All other
// values are ignored, because controllers append the state of a button.
void read_stop(value_list& v, osc_request& r)
{
    if (v.released())
        r.method.clear();
    v.ignore_rest();
}

void read_drive(value_list& v, osc_request& r)
{
    r.params["tactor"] = v.number("tactor");
    r.params["intensity"] = v.number("intensity");
    if (v.has_more())
        r.params["duration_s"] = v.number("duration_s");
}

void read_subscribe(value_list& v, osc_request& r)
{
    if (v.next_is_number())
        r.port = v.whole<std::uint16_t>("port", 1);
    json events = json::array();
    while (v.has_more()) {
        const std::string& name = v.text("events");
        if (name != "levels" && name != "stream")
            refuse_param("events", fmt::format("\"{}\" is unknown", name),
                         "give levels or stream; a sender always gets the messages of its own strokes");
        events.push_back(name);
    }
    r.params["events"] = std::move(events);
}

constexpr std::string_view osc_root = "/tactor/";
constexpr std::string_view osc_stop = "/tactor/stop"; // fades out all strokes
constexpr std::pair<std::string_view, void (*)(value_list& v, osc_request& r)> readers[] = {
    {"play", read_play},         {"begin", read_begin}, {"to", read_move_to},  {"end", read_own_stroke},
    {"cancel", read_own_stroke}, {"stop", read_stop},   {"drive", read_drive}, {"subscribe", read_subscribe},
};

// Returns "did you mean /tactor/begin? " with the most similar address, or "" if none is similar.
std::string address_hint(std::string_view address)
{
    std::vector<std::string_view> known;
    for (const auto& reader : readers)
        known.push_back(reader.first);
    const std::string_view near = detail::nearest_name(address.substr(address.rfind('/') + 1), known);
    return near.empty() ? "" : fmt::format("did you mean {}{}? ", osc_root, near);
}

// Smallest change of the clocks' difference that counts. Smaller changes come from the time between reading
// the two clocks.
constexpr std::int64_t clocks_differ_ns = 50'000;

// Returns the option intensity_max of a new stroke, or 1 if it is missing or not a number. The service
// refuses a value that is not a number.
double find_intensity_max(const net::json& params)
{
    const auto own_options = params.find("options");
    const bool has_it = own_options != params.end() && own_options->contains("intensity_max");
    const net::json& v = has_it ? (*own_options)["intensity_max"] : net::json();
    return v.is_number() ? v.get<double>() : 1.0;
}

constexpr std::string_view avatar_root = "/avatar/";
constexpr double longest_touch_s = 10.0; // VRChat sends only changes
constexpr double silent_dbfs = -200.0;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::size_t most_words = 1000; // greatest length of an error text, bytes

} // namespace

bool is_server_message(std::string_view address)
{
    constexpr std::array own{"/tactor/stroke", "/tactor/error", "/tactor/levels", "/tactor/stream"};
    return std::find(own.begin(), own.end(), address) != own.end();
}

osc_request read_osc(const osc_message& m)
{
    const std::string_view address = m.address;
    const auto* found = std::find_if(std::begin(readers), std::end(readers), [&](const auto& reader) {
        return address.starts_with(osc_root) && address.substr(osc_root.size()) == reader.first;
    });
    if (found == std::end(readers))
        throw fault_error(
            {net::code_no_method, "bad-input", "address", "it is unknown",
             address_hint(address) +
                 "use /tactor/ with play, begin, to, end, cancel, stop, drive or subscribe; no pattern"});
    osc_request r{.method = std::string(found->first)};
    for (const osc_value& v : m.values)
        if (const auto* s = std::get_if<std::string>(&v))
            r.bytes += s->size();
    value_list v(m);
    found->second(v, r);
    v.end();
    return r;
}

/// Connection from the service to a sender.
class osc_clients::sender_link final : public client_link {
public:
    sender_link(osc_clients& all, endpoint to) : all_(all), to_(std::move(to)) {}
    void send(std::string /*message*/) override {} // request handlers send the answers
    void notify(std::string_view method, const net::reply_json& params) override
    {
        all_.notify(to_, method, params);
    }
    // Returns 0, because datagrams are sent immediately or lost.
    std::size_t queued_bytes() const override { return 0; }
    void finish() override {}

private:
    osc_clients& all_;
    endpoint to_;
};

osc_clients::osc_clients(boost::asio::io_context& io, service& s, outside o)
    : io_(io), service_(s), outside_(std::move(o))
{
    service_.on_stop([this] { drop_held_strokes(); });
}

osc_clients::~osc_clients()
{
    service_.on_stop({});
    for (const auto& [from, s] : senders_)
        service_.disconnect(s.client);
}

void osc_clients::receive(std::string_view packet, const endpoint& from)
{
    read_clocks();
    try {
        for (const osc_message& m : net::parse_osc(packet))
            take(m, from);
    } catch (const error& e) {
        refuse(from, "", e.what());
    }
    process_pending();
    schedule_idle_check(from);
}

void osc_clients::take(const osc_message& m, const endpoint& from)
{
    if (is_server_message(m.address))
        return;
    try {
        if (m.address.starts_with(avatar_root))
            return touch(m, from);
        if (!m.fault.empty() && m.address != osc_stop) // a stop is valid with any values
            refuse_param("values", m.fault, "send an address, types and values, as OSC 1.0 requires");
        osc_request r = read_osc(m);
        if (r.method == "stop")
            stop(from);
        else if (r.method == "subscribe")
            subscribe(r, from);
        else if (r.method == "to" || r.method == "end" || r.method == "cancel")
            move(std::move(r), from);
        else if (!r.method.empty())
            draw(std::move(r), due_ns(m), from);
    } catch (...) {
        refuse(from, m.address, net::fault_text(current_fault("values")));
    }
}

// Handles a touch of an avatar of VRChat: 0 and false end it, other values are its intensity. VRChat sends
// all other values of the avatar, too, and expects no answer.
void osc_clients::touch(const osc_message& m, const endpoint& from)
{
    const std::optional<vrchat_motor> motor = read_vrchat(m.address, service_.tactors());
    value_list v(m);
    if (!motor || !m.fault.empty() || !v.has_more())
        return;
    const auto is_drawn = [&] {
        const sender* const s = find(from);
        return s != nullptr && s->drawn_as.contains(motor->number);
    };
    if (v.released()) {
        if (is_drawn())
            move({.method = "end", .number = motor->number}, from);
        return;
    }
    const double intensity = v.next_is_number() ? std::clamp(v.number("intensity"), 0.0, 1.0) : 1.0;
    if (!is_drawn())
        draw({.method = "begin", .params = {{"timeout_s", longest_touch_s}}, .number = motor->number}, {},
             from);
    if (is_drawn()) // not if the service refused the stroke
        move({.method = "to",
              .params = {{"x_mm", motor->place.x_mm}, {"y_mm", motor->place.y_mm}, {"intensity", intensity}},
              .number = motor->number},
             from);
}

// Reads the clocks when a packet arrives. Keeps the previous difference between the clocks unless it has
// changed noticeably. Messages with the same time therefore stay in order, whether they are in one bundle or
// in several.
void osc_clients::read_clocks()
{
    unix_ns_ = outside_.unix_ns();
    const std::int64_t offset_ns = outside_.now_ns() - unix_ns_;
    if (std::abs(offset_ns - offset_ns_) > clocks_differ_ns)
        offset_ns_ = offset_ns;
}

// Returns the time of a message on the service's clock. Returns nothing if the message is due now or was due
// in the past.
std::optional<std::int64_t> osc_clients::due_ns(const osc_message& m) const
{
    if (!m.unix_ns)
        return {};
    const std::int64_t ahead_ns = *m.unix_ns - unix_ns_;
    if (ahead_ns > std::llround(farthest_s * 1e9))
        refuse_param("time tag", fmt::format("it is {:.1f} s ahead", seconds(ahead_ns)),
                     fmt::format("send it at most {:.0f} s ahead; check that the clocks agree", farthest_s));
    if (ahead_ns <= 0)
        return {};
    return *m.unix_ns + offset_ns_;
}

// Returns the lead of a live stroke, ns: the mean time from its begin request to its first sample at the DAC.
// The audio thread writes a period when the rest of the buffer is full, and takes requests once a period.
std::int64_t osc_clients::lead_ns()
{
    const stream_setup& s = service_.output().setup();
    const double frames = static_cast<double>(s.buffer_frames) - 0.5 * static_cast<double>(s.period_frames);
    return s.rate == 0 ? 0 : std::llround(1e9 * frames / s.rate);
}

// Stops everything. This also works for an unknown sender when no more clients are accepted.
void osc_clients::stop(const endpoint& from)
{
    if (find(from) != nullptr)
        return ask(from, {.method = "stop"});
    const client_number n =
        service_.connect(std::make_shared<sender_link>(*this, from), client_kind::datagram);
    service_.receive(n, net::rpc_request{.method = "stop"}, 0, {});
    service_.disconnect(n);
}

void osc_clients::subscribe(const osc_request& r, const endpoint& from)
{
    sender& s = admit(from);
    s.port = r.port;
    if (s.unsubscribes)
        held_.erase(*std::exchange(s.unsubscribes, {}));
    ask(from, r);
    if (r.params["events"].empty())
        return;
    osc_request end{.method = r.method};
    end.params["events"] = net::json::array();
    s.unsubscribes = held_.emplace(outside_.now_ns() + std::llround(subscription_s * 1e9), held{from, end});
}

// Handles the messages to, end and cancel. They take effect immediately, whatever their time tags.
void osc_clients::move(osc_request r, const endpoint& from)
{
    sender* s = find(from);
    const auto found = s == nullptr ? decltype(s->drawn_as.begin()){} : s->drawn_as.find(r.number);
    if (s == nullptr || found == s->drawn_as.end())
        refuse_param("number", fmt::format("this sender has no stroke {}", r.number),
                     "use a number from play or begin of the same address and port");
    drawn& d = found->second;
    if (const double intensity = r.params.value("intensity", 0.0);
        intensity > d.intensity_max && !std::exchange(d.is_loud, true))
        refuse(from, "/tactor/to",
               fmt::format("stroke {}: {}", r.number,
                           session::intensity_limit_text(intensity, d.intensity_max)));
    if (d.held && r.method == "cancel")
        return drop_held_strokes(
            [&](const held& h) { return h.from == from && h.request.number == r.number; });
    // Before the stroke begins, keep only the last place.
    if (d.held && r.method == "to" && !d.waiting.empty() && d.waiting.back().method == "to")
        d.waiting.pop_back();
    forward_request(from, d, std::move(r));
}

// Handles the messages play, begin and drive. If `at_ns` is set, the first sample is at the DAC at that time.
void osc_clients::draw(osc_request r, std::optional<std::int64_t> at_ns, const endpoint& from)
{
    sender& s = admit(from);
    if (r.number != 0 && s.drawn_as.contains(r.number))
        refuse_param("number", fmt::format("stroke {} is still playing", r.number),
                     "choose another number, or cancel the stroke first");
    const bool waits = at_ns && r.method == "begin";
    if (waits && s.held >= most_held)
        refuse_over_limit("strokes", "too many strokes wait for their time", "send them later");
    if (r.number != 0)
        s.drawn_as[r.number] = {.held = waits, .intensity_max = find_intensity_max(r.params)};
    if (waits) {
        ++s.held;
        held_.emplace(*at_ns - lead_ns(), held{from, std::move(r)});
        return;
    }
    if (at_ns)
        r.params["start"] = {{"monotonic_s", seconds(*at_ns)}};
    ask(from, std::move(r));
}

std::optional<std::int64_t> osc_clients::next_ns() const
{
    if (held_.empty())
        return {};
    return held_.begin()->first;
}

void osc_clients::process_pending()
{
    while (!held_.empty() && held_.begin()->first <= outside_.now_ns()) {
        const held h = std::move(held_.extract(held_.begin()).mapped());
        sender& s = senders_.at(h.from);
        if (h.request.method == "subscribe") {
            s.unsubscribes.reset();
        } else {
            --s.held;
            s.drawn_as.at(h.request.number).held = false;
        }
        ask(h.from, h.request);
        schedule_idle_check(h.from);
    }
}

void osc_clients::drop_held_strokes()
{
    drop_held_strokes([](const held&) { return true; });
}

// Drops live strokes that wait for their start times, if `which` returns true for them. Used when a client
// stops everything, and when a sender cancels one of its strokes.
void osc_clients::drop_held_strokes(const std::function<bool(const held&)>& which)
{
    for (auto h = held_.begin(); h != held_.end();) {
        const auto at = h++;
        if (at->second.request.method == "subscribe" || !which(at->second))
            continue;
        const held gone = std::move(held_.extract(at).mapped());
        sender& s = senders_.at(gone.from);
        --s.held;
        s.drawn_as.erase(gone.request.number);
        send_stroke(gone.from, gone.request.number, "cancelled");
        schedule_idle_check(gone.from);
    }
}

// Posts `f` to the context, because the service may be in the middle of another call.
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
    return found == senders_.end() ? nullptr : &found->second;
}

osc_clients::sender& osc_clients::admit(const endpoint& from)
{
    if (sender* s = find(from))
        return *s;
    if (!service_.clients().has_free_place(client_kind::datagram))
        refuse_over_limit("max_clients", "all places are taken");
    const client_number n =
        service_.connect(std::make_shared<sender_link>(*this, from), client_kind::datagram,
                         net::simplify_address(from.address()).to_string());
    return senders_[from] = {.client = n};
}

void osc_clients::ask(const endpoint& from, osc_request r)
{
    sender& s = senders_.at(from);
    ++s.unanswered;
    net::rpc_request wanted{.method = r.method, .params = std::exchange(r.params, {})};
    const std::size_t bytes = r.bytes;
    service_.receive(
        s.client, std::move(wanted), bytes,
        [this, from, r = std::move(r)](const net::reply_json& result, const net::rpc_fault* why) {
            answer(from, r, result, why);
        });
}

// Sends a request about a stroke to the service. If the stroke has no number yet, keeps the request until it
// has one.
void osc_clients::forward_request(const endpoint& from, drawn& d, osc_request r)
{
    if (d.stroke && d.waiting.empty()) {
        r.params["stroke"] = *d.stroke;
        return ask(from, std::move(r));
    }
    if (d.waiting.size() >= most_waiting)
        refuse_over_limit("messages", "too many points wait for a stroke that has not begun");
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
        ask(from, std::move(r));
    }
    schedule_idle_check(from);
}

void osc_clients::answer(const endpoint& to, const osc_request& r, const net::reply_json& result,
                         const net::rpc_fault* why)
{
    sender& s = senders_.at(to);
    --s.unanswered;
    schedule_idle_check(to);
    const bool draws = r.method == "play" || r.method == "begin" || r.method == "drive";
    if (why != nullptr) {
        const std::string text = net::fault_text(*why);
        refuse(to, "/tactor/" + r.method,
               r.number == 0 ? text : fmt::format("stroke {}: {}", r.number, text));
        if (draws)
            s.drawn_as.erase(r.number);
    } else if (draws) {
        const auto n = result["stroke"].get<std::uint32_t>();
        s.numbers[n] = r.number;
        if (const auto d = s.drawn_as.find(r.number); d != s.drawn_as.end()) {
            d->second.stroke = n;
            if (!d->second.waiting.empty())
                later([this, to, number = r.number] { flush(to, number); });
        }
    }
}

void osc_clients::notify(const endpoint& to, std::string_view method, const net::reply_json& p)
{
    sender* const known = find(to);
    if (known == nullptr)
        return;
    schedule_idle_check(to);
    sender& s = *known;
    endpoint listener = to;
    if (s.port != 0)
        listener.port(s.port);
    if (method == "stroke") {
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
    } else if (method == "levels") {
        std::vector<net::osc_value> dbfs;
        for (const net::reply_json& v : p["dbfs"])
            dbfs.emplace_back(v.is_number() ? v.get<double>() : silent_dbfs);
        outside_.send(listener, net::osc_packet("/tactor/levels", dbfs));
    } else if (method == "stream") {
        outside_.send(listener, net::osc_packet("/tactor/stream", {p["state"].get<std::string>()}));
    }
}

void osc_clients::send_stroke(const endpoint& to, std::int32_t number, const std::string& state)
{
    outside_.send(to, net::osc_packet("/tactor/stroke", {std::int64_t{number}, state}));
}

void osc_clients::refuse(const endpoint& to, const std::string& address, const std::string& why)
{
    const std::int64_t now = outside_.now_ns();
    while (!errors_ns_.empty() && errors_ns_.front() + second_ns <= now)
        errors_ns_.pop_front();
    if (errors_ns_.size() == most_errors)
        return;
    errors_ns_.push_back(now);
    outside_.send(to,
                  net::osc_packet("/tactor/error", {net::truncate_echo(address), why.substr(0, most_words)}));
}

void osc_clients::schedule_idle_check(const endpoint& e)
{
    if (to_check_.insert(e).second && to_check_.size() == 1)
        later([this] { drop_idle_senders(); });
}

void osc_clients::drop_idle_senders()
{
    for (const endpoint& e : std::exchange(to_check_, {})) {
        const auto found = senders_.find(e);
        if (found == senders_.end() || !found->second.idle())
            continue;
        service_.disconnect(found->second.client);
        senders_.erase(found);
    }
}

} // namespace tactor::server
