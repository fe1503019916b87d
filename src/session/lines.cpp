// SPDX-License-Identifier: MIT
#include "session/lines.hpp"

#include <utility>

namespace tactor::session {
namespace {

class lent_line final : public enable_line {
public:
    /// `switched`: called with what the line is now.
    explicit lent_line(std::shared_ptr<enable_line> l, std::function<void(bool on)> switched = {})
        : line_(std::move(l)), switched_(std::move(switched))
    {
    }
    ~lent_line() override { static_cast<void>(lent_line::set(false)); }
    lent_line(const lent_line&) = delete;
    lent_line& operator=(const lent_line&) = delete;
    bool set(bool on) noexcept override
    {
        const bool done = line_->set(on);
        if (done && switched_)
            switched_(on);
        return done;
    }
    bool beat() noexcept override { return line_->beat(); }

private:
    std::shared_ptr<enable_line> line_;
    std::function<void(bool)> switched_;
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

player_lines open_lines(const stream_options& o, const environment& e, bool arm)
{
    const setup config = o.no_gpio ? setup{} : e.config;
    player_lines l{.trigger_delay_s = o.sync_delay_ms * 1e-3};
    if (config.amplifier) {
        l.amplifier = open_amplifier(*config.amplifier);
        l.settle_s = config.amplifier->settle_s;
    }
    if (config.sync && config.sync->out) {
        l.sync_out = open_output(*config.sync->out);
        l.pulse_s = config.sync->pulse_s;
    }
    if (!arm)
        return l;
    if (!config.sync || !config.sync->in)
        throw error(error_kind::bad_input, "{arm}", "there is no line to wait for",
                    "say it as in = { ... } under [sync], see tactor.toml(5)");
    l.trigger = open_edges(*config.sync->in, config.sync->edge, config.sync->debounce_s, config.sync->pull);
    return l;
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
        l.amplifier = std::make_unique<lent_line>(shared(own.amplifier), [s = state_](bool on) {
            if (s->on.exchange(on) == on)
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

amplifier_state lent_lines::amplifier() const noexcept
{
    return state_->own.amplifier == nullptr ? amplifier_state::none
           : state_->on                     ? amplifier_state::on
           : state_->was_on                 ? amplifier_state::muted
                                            : amplifier_state::off;
}

} // namespace tactor::session
