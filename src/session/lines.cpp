// SPDX-License-Identifier: MIT
#include "session/lines.hpp"

#include <utility>

namespace tactor::session {
namespace {

class lent_line final : public enable_line {
public:
    explicit lent_line(std::shared_ptr<enable_line> l) : line_(std::move(l)) {}
    ~lent_line() override { line_->set(false); }
    lent_line(const lent_line&) = delete;
    lent_line& operator=(const lent_line&) = delete;
    bool set(bool on) noexcept override { return line_->set(on); }
    bool beat() noexcept override { return line_->beat(); }

private:
    std::shared_ptr<enable_line> line_;
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

lent_lines::lent_lines(const setup& config, bool arm, double trigger_delay_s)
    : trigger_delay_s_(trigger_delay_s)
{
    if (config.amplifier) {
        amplifier_ = open_amplifier(*config.amplifier);
        settle_s_ = config.amplifier->settle_s;
    }
    if (config.sync && config.sync->out) {
        sync_out_ = open_output(*config.sync->out);
        pulse_s_ = config.sync->pulse_s;
    }
    if (!arm)
        return;
    if (!config.sync || !config.sync->in)
        throw error(error_kind::bad_input, "{arm}", "there is no line to wait for",
                    "say it as in = { ... } under [sync], see tactor.toml(5)");
    trigger_ = open_edges(*config.sync->in, config.sync->edge, config.sync->debounce_s, config.sync->pull);
}

player_lines lent_lines::lend(double proof_s) const
{
    player_lines l;
    if (amplifier_) {
        l.amplifier = std::make_unique<lent_line>(amplifier_);
        l.settle_s = settle_s_;
        l.proof_s = proof_s;
    }
    if (sync_out_) {
        l.sync_out = std::make_unique<lent_line>(sync_out_);
        l.pulse_s = pulse_s_;
    }
    if (trigger_)
        l.trigger = std::make_unique<lent_input>(trigger_);
    l.trigger_delay_s = trigger_delay_s_;
    return l;
}

} // namespace tactor::session
