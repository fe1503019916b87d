// SPDX-License-Identifier: MIT
#include "session/device_stream.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "desktop/desktop.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

constexpr double longest_pause_s = 5.0;

stream_policy::time later(stream_policy::time t, double s)
{
    constexpr double for_ever = 1e9;
    return s >= for_ever
               ? stream_policy::time::max()
               : t + std::chrono::ceil<stream_policy::time::duration>(std::chrono::duration<double>(s));
}

class lent_line final : public enable_line {
public:
    /// Lends a line. `switched` is called when the line has gone on or off, and when it has refused to go on.
    explicit lent_line(std::shared_ptr<enable_line> l, std::function<void(bool on, bool done)> switched = {})
        : line_(std::move(l)), switched_(std::move(switched))
    {
    }
    ~lent_line() override { static_cast<void>(lent_line::set(false)); }
    lent_line(const lent_line&) = delete;
    lent_line& operator=(const lent_line&) = delete;
    bool set(bool on) noexcept override
    {
        const bool done = line_->set(on);
        if (switched_ && (done || on))
            switched_(on, done);
        return done;
    }
    bool beat() noexcept override { return line_->beat(); }
    bool must_be_off() const noexcept override { return line_->must_be_off(); }

private:
    std::shared_ptr<enable_line> line_;
    std::function<void(bool, bool)> switched_;
};

/// An amplifier's line that must be off while the system sleeps.
class awake_line final : public enable_line {
public:
    explicit awake_line(std::unique_ptr<enable_line> l) : line_(std::move(l)) {}
    bool set(bool on) noexcept override
    {
        const bool done = line_->set(on);
        is_on_ = on || !done;
        return done;
    }
    bool beat() noexcept override { return line_->beat(); }
    bool must_be_off() const noexcept override { return asleep_; }

private:
    // The system sleeps when this returns.
    void follow(bool asleep) noexcept
    {
        // The player asks every 50 ms: before that the line may still go on.
        constexpr int least_ms = 60;
        constexpr int most_ms = 1000;
        asleep_ = asleep;
        for (int i = 0; asleep && (is_on_ || i < least_ms) && i < most_ms; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }

    std::unique_ptr<enable_line> line_;
    std::atomic<bool> is_on_ = false;
    std::atomic<bool> asleep_ = false;
    desktop::sleep_watch watch_{[this](bool asleep) { follow(asleep); }};
};

class lent_input final : public edge_input {
public:
    explicit lent_input(std::shared_ptr<edge_input> i) : input_(std::move(i)) {}
    int descriptor() const noexcept override { return input_->descriptor(); }
    std::optional<gpio_edge> read() noexcept override { return input_->read(); }

private:
    std::shared_ptr<edge_input> input_;
};

} // namespace

std::string_view to_string(stream_state s) noexcept
{
    return stream_state_names[static_cast<std::size_t>(s)];
}

stream_policy::act stream_policy::step(time now)
{
    again_.reset();
    return phase_ == phase::open   ? step_while_open(now)
           : phase_ == phase::shut ? step_while_shut(now)
                                   : act::nothing;
}

// Returns true once `after_s` has passed since the first call for this wait.
bool stream_policy::is_due(time now, double after_s)
{
    again_ = due_ = due_.value_or(later(now, after_s));
    return now >= *due_;
}

stream_policy::act stream_policy::step_while_shut(time now)
{
    if (is_over() || wanted_ || state_ == stream_state::idle)
        return wanted_ && !is_over() ? act::open : act::nothing;
    if (!give_up_at_)
        give_up_at_ = later(now, times_.wait_s);
    if (!due_) {
        given_up_ = now >= *give_up_at_;
        if (given_up_)
            return act::nothing;
        due_ = std::min(later(now, pause_s_), *give_up_at_);
        pause_s_ = std::min(2.0 * pause_s_, longest_pause_s);
    }
    return is_due(now, 0.0) ? act::open : act::nothing;
}

stream_policy::act stream_policy::step_while_open(time now)
{
    if (broken_ || closing_)
        return act::close;
    // A successful opening proves little: a full disk or a loose cable shows only with the first
    // periods.
    if (proves_ && is_due(now, times_.proof_s))
        run();
    if (!proves_ && !busy_ && times_.idle_stop_s > 0.0 && is_due(now, times_.idle_stop_s)) {
        set(stream_state::idle, "no stroke came for a while; the next one starts it");
        return act::close;
    }
    return act::nothing;
}

void stream_policy::on_open()
{
    phase_ = phase::open;
    wanted_ = broken_ = false;
    if (!proves_)
        run();
}

void stream_policy::run()
{
    proves_ = false;
    pause_s_ = times_.retry_s;
    again_.reset();
    due_.reset();
    give_up_at_.reset();
    set(stream_state::running, "");
}

void stream_policy::on_failure(std::string why)
{
    phase_ = phase::shut;
    wanted_ = false;
    proves_ = true;
    set(stream_state::lost, std::move(why));
}

void stream_policy::on_end(std::string why)
{
    if (phase_ != phase::open || std::exchange(broken_, true))
        return;
    proves_ = true;
    set(stream_state::lost, std::move(why));
}

void stream_policy::on_stop(std::string why)
{
    if (phase_ == phase::open && !std::exchange(broken_, true))
        set(stream_state::idle, std::move(why));
}

void stream_policy::on_close(bool left_on)
{
    phase_ = phase::shut;
    if (!left_on)
        return;
    given_up_ = true;
    set(stream_state::lost, "the amplifier may be on: its line cannot be switched off (cut the amplifier's "
                            "supply, then start the service again)");
}

void stream_policy::mute(bool is)
{
    if (state_ == stream_state::running || state_ == stream_state::muted)
        set(is ? stream_state::muted : stream_state::running,
            is ? "the amplifier is off until the stream is sound" : "");
}

void stream_policy::set_busy(bool is)
{
    if (std::exchange(busy_, is) != is && !proves_ && phase_ == phase::open)
        due_.reset(); // ends the wait for the idle stop
}

void stream_policy::end()
{
    closing_ = true;
    set(stream_state::closing, "the server ends");
}

void stream_policy::set(stream_state s, std::string reason)
{
    if (state_ == stream_state::closing) // no state follows closing
        return;
    state_ = s;
    reason_ = std::move(reason);
}

void add_stats(player_stats& sum, const player_stats& more)
{
    constexpr std::ptrdiff_t most_xrun_lengths = 64; // as many as player_stats::xrun_s has for one stream
    const bool first = sum.periods == 0;
    sum.ring_low_water = first ? more.ring_low_water : std::min(sum.ring_low_water, more.ring_low_water);
    sum.realtime = more.realtime && (first || sum.realtime);
    using count = std::uint64_t player_stats::*;
    for (const count c :
         {&player_stats::periods, &player_stats::frames, &player_stats::xruns, &player_stats::limited_frames,
          &player_stats::power_limited_frames, &player_stats::drives_cut, &player_stats::stalls,
          &player_stats::off_failures, &player_stats::sync_missed, &player_stats::minor_faults,
          &player_stats::major_faults})
        sum.*c += more.*c;
    sum.left_on = more.left_on; // a later player may have switched it off
    const auto pulses = static_cast<double>(sum.sync_pulses + more.sync_pulses);
    if (pulses > 0.0)
        sum.sync_mean_late_s = (sum.sync_mean_late_s * static_cast<double>(sum.sync_pulses) +
                                more.sync_mean_late_s * static_cast<double>(more.sync_pulses)) /
                               pulses;
    sum.sync_pulses += more.sync_pulses;
    sum.sync_worst_late_s = std::max(sum.sync_worst_late_s, more.sync_worst_late_s);
    sum.latest_wakeup_s = std::max(sum.latest_wakeup_s, more.latest_wakeup_s);
    sum.xrun_s.insert(sum.xrun_s.end(), more.xrun_s.begin(), more.xrun_s.end());
    if (std::ssize(sum.xrun_s) > most_xrun_lengths) // keeps the newest lengths
        sum.xrun_s.erase(sum.xrun_s.begin(), sum.xrun_s.end() - most_xrun_lengths);
}

static std::unique_ptr<enable_line> open_amplifier_line(const stream_options& o, const amplifier_settings& s)
{
    std::unique_ptr<enable_line> line = open_amplifier(s);
    return o.no_desktop ? std::move(line) : keep_off_while_asleep(std::move(line));
}

player_lines open_lines(const stream_options& o, const environment& e, bool arm)
{
    const setup config = o.no_gpio ? setup{} : e.config;
    player_lines l{.trigger_delay_s = o.sync_delay_ms * 1e-3};
    if (config.amplifier) {
        l.amplifier = open_amplifier_line(o, *config.amplifier);
        l.settle_s = config.amplifier->settle_s;
    }
    if (config.sync && config.sync->out) {
        l.sync_out = open_output(*config.sync->out);
        l.pulse_s = config.sync->pulse_s;
    }
    if (!arm)
        return l;
    if (!config.sync || !config.sync->in)
        throw error(error_kind::bad_input, "{arm}", "no sync input is configured",
                    "add in = { ... } under [sync], see tactor.toml(5)");
    l.trigger = open_edges(*config.sync->in, config.sync->edge, config.sync->debounce_s, config.sync->pull);
    return l;
}

std::unique_ptr<enable_line> keep_off_while_asleep(std::unique_ptr<enable_line> line)
{
    return std::make_unique<awake_line>(std::move(line));
}

std::string_view to_string(amplifier_state s) noexcept
{
    return s == amplifier_state::none ? "none" : s == amplifier_state::on ? "on" : "off";
}

lent_lines::lent_lines(player_lines own) : state_(std::make_shared<state>())
{
    state_->own = std::move(own);
}

player_lines lent_lines::lend(double proof_s) const
{
    const player_lines& own = state_->own;
    const auto shared = [this]<typename T>(const std::unique_ptr<T>& p) {
        return std::shared_ptr<T>(state_, p.get());
    };
    player_lines l{.settle_s = own.settle_s,
                   .proof_s = proof_s,
                   .pulse_s = own.pulse_s,
                   .trigger_delay_s = own.trigger_delay_s};
    state_->was_on = false;
    if (own.amplifier)
        l.amplifier = std::make_unique<lent_line>(shared(own.amplifier), [s = state_](bool on, bool done) {
            s->refused = on ? !done : s->refused.load();
            if (!done || s->on.exchange(on) == on)
                return;
            s->was_on = s->was_on || on;
            if (s->switched)
                s->switched();
        });
    if (own.sync_out)
        l.sync_out = std::make_unique<lent_line>(shared(own.sync_out));
    if (own.trigger)
        l.trigger = std::make_unique<lent_input>(shared(own.trigger));
    return l;
}

void lent_lines::renew_amplifier(const std::function<std::unique_ptr<enable_line>()>& open)
{
    if (!state_->refused)
        return;
    state_->own.amplifier.reset(); // a line has one owner
    state_->own.amplifier = open();
    state_->refused = false;
}

amplifier_state lent_lines::amplifier() const noexcept
{
    return state_->own.amplifier == nullptr && !state_->refused ? amplifier_state::none
           : state_->on                                         ? amplifier_state::on
           : state_->was_on                                     ? amplifier_state::muted
                                                                : amplifier_state::off;
}

stream_parts open_parts(const alsa_options& device, const stream_options& o, const environment& e, bool arm)
{
    stream_parts p;
    configure_realtime_kit(o);
    p.card->ask = !o.no_desktop;
    p.open = [device, tactors = e.tactors, card = p.card] { return open_device(device, tactors, *card); };
    p.lines = lent_lines(open_lines(o, e, arm));
    if (!o.no_gpio && e.config.amplifier)
        p.open_amplifier = [o, settings = *e.config.amplifier] { return open_amplifier_line(o, settings); };
    p.tactors = e.tactors;
    p.player.limits = find_limits(o, e);
    p.player.require_realtime = o.require_realtime;
    p.player.log = device.log;
    p.wished.name = device.pcm;
    p.wished.channels = device.channels;
    p.wished.rate = device.rate;
    p.wished.period_frames = device.period_frames;
    p.wished.buffer_frames = device.period_frames * device.periods;
    return p;
}

struct device_stream::outcome {
    bool closes = false;
    double proof_s = 0.0;
    std::unique_ptr<tactor::player> player = {}; ///< player that was opened, or that is to be closed
    std::exception_ptr failure = {};
    std::string why = {};
    player_stats last = {};
    std::atomic<bool> done = false;
};

device_stream::device_stream(stream_parts p)
    : stream_policy(p.times), parts_(std::move(p)), setup_(parts_.wished)
{
    parts_.lines.set_switch_handler([this] { news_.signal(); });
    parts_.card->news = [this] { news_.signal(); };
    parts_.player.log = [this, log = parts_.player.log](log_kind k, std::string_view text) {
        if (log)
            log(k, text);
        news_.signal();
    };
}

device_stream::~device_stream()
{
    finish();
}

void device_stream::finish() noexcept
{
    try {
        outcome_.reset(); // handlers of its player refer to this object
        end();
        step();
        run_work();
    } catch (const std::exception&) { // NOLINT(bugprone-empty-catch): the player has ended
    }
}

void device_stream::cancel_all()
{
    if (player_ != nullptr && !player_->ended() && !player_->cancel_all())
        on_stop("everything was stopped; the next stroke starts it");
}

void device_stream::set_busy(bool is)
{
    parts_.card->idle = !is;
    stream_policy::set_busy(is);
}

std::optional<device_stream::time> device_stream::step(time now)
{
    if (outcome_ != nullptr && outcome_->done)
        finish_work();
    if (parts_.card->idle && parts_.card->wanted.exchange(false))
        on_stop("another program asked for the card; the next stroke starts it");
    if (player_ != nullptr && !drive_time_doubted_)
        if (const std::string doubt = player_->drive_time_doubt(); !doubt.empty()) {
            drive_time_doubted_ = true;
            say(stderr, "tactor: warning: {}\n", doubt);
        }
    if (player_ != nullptr)
        if (const auto end = player_->ended())
            on_end(end->reason == reason_kind::none ? "the stream was stopped" : end->why);
    due_ = stream_policy::step(now);
    if (player_ != nullptr)
        mute(amplifier() == amplifier_state::muted);
    return next_step_time();
}

bool device_stream::begin_work()
{
    const act a = std::exchange(due_, act::nothing);
    if (a == act::nothing)
        return false;
    begin();
    outcome_ = std::make_unique<outcome>();
    outcome_->closes = a == act::close;
    outcome_->proof_s = needs_proof() ? parts_.times.proof_s : 0.0;
    outcome_->player = std::move(player_);
    return true;
}

void device_stream::work()
{
    if (outcome_->closes)
        close();
    else
        open();
    outcome_->done = true;
}

bool device_stream::run_work()
{
    if (!begin_work())
        return false;
    work();
    step();
    return true;
}

void device_stream::open()
{
    try {
        if (parts_.open_amplifier)
            parts_.lines.renew_amplifier(parts_.open_amplifier);
        auto p = std::make_unique<player>(parts_.open(), parts_.tactors, parts_.player,
                                          parts_.lines.lend(outcome_->proof_s));
        p->on_begin([this, number = number_ + 1](stroke_id id, std::optional<std::int64_t> at_ns) {
            if (parts_.begun)
                parts_.begun(number, id, at_ns);
            news_.signal();
        });
        p->on_report([this, number = number_ + 1](const stroke_report& r) {
            if (parts_.ended)
                parts_.ended(number, r);
            news_.signal();
        });
        outcome_->player = std::move(p);
    } catch (const std::exception& e) {
        parts_.card->reserved.reset();
        outcome_->failure = std::current_exception();
        outcome_->why = e.what();
    }
}

void device_stream::close()
{
    outcome_->player->stop();
    outcome_->last = outcome_->player->stats();
    outcome_->player.reset(); // sends the last reports; the player holds the device and borrows the lines
    parts_.card->reserved.reset();
}

void device_stream::finish_work()
{
    const auto o = std::exchange(outcome_, nullptr);
    if (o->closes) {
        add_stats(before_, o->last);
        return on_close(o->last.left_on);
    }
    failure_ = o->failure;
    if (failure_ != nullptr)
        return on_failure(o->why);
    player_ = std::move(o->player);
    ++number_;
    setup_ = player_->setup();
    on_open();
}

player_stats device_stream::stats() const
{
    player_stats all = before_;
    if (player_ != nullptr)
        add_stats(all, player_->stats());
    return all;
}

} // namespace tactor::session
