// SPDX-License-Identifier: MIT
#include "amplifier/amplifier.hpp"

#include <algorithm>

namespace tactor::amplifier {

void sequence::handle(event e, std::int64_t now, played_frames at) noexcept
{
    if (state_ == state::ended)
        return;
    switch (e) {
    case event::started:
        at_ = {};
        proof_from_ = 0;
        if (state_ == state::stopped)
            state_ = state::proving;
        break;
    case event::moved:
        at_ = at;
        break;
    case event::switched:
        if (state_ == state::switching) {
            state_ = state::settling;
            settled_at_ = now + options_.settle_ns;
        }
        break;
    case event::xrun:
        count_xrun(now);
        break;
    case event::suspended:
        state_ = state::stopped;
        break;
    case event::stalled:
        stalled_ = true;
        begin_proof();
        break;
    case event::recovered:
        stalled_ = false;
        begin_proof();
        break;
    case event::lapsed:
        begin_proof();
        break;
    case event::withheld:
    case event::granted:
        withheld_ = e == event::withheld;
        begin_proof();
        break;
    case event::silent:
    case event::failed:
        state_ = state::ended;
        return;
    case event::tick:
        break;
    }
    look(now);
}

// Switches the line off until the DAC has shown that it runs.
void sequence::begin_proof() noexcept
{
    if (state_ != state::stopped)
        state_ = state::proving;
    proof_from_ = at_.played;
}

// Counts an xrun and mutes after too many. A mute pops too, so a single xrun of a few periods does not mute.
void sequence::count_xrun(std::int64_t now) noexcept
{
    if (xruns_ == 0 || now - first_xrun_ >= options_.calm_ns) {
        first_xrun_ = now;
        xruns_ = 0;
    }
    ++xruns_;
    if (xruns_ >= options_.most_xruns) {
        muted_until_ = now + options_.calm_ns;
        first_xrun_ = now; // the next xrun mutes again
        begin_proof();
    }
}

void sequence::look(std::int64_t now) noexcept
{
    const std::uint64_t from = std::max(proof_from_, at_.sounds_until);
    if (state_ == state::proving && !stalled_ && !withheld_ && now >= muted_until_ && at_.played >= from &&
        at_.played - from >= options_.proof_frames)
        state_ = state::switching;
    if (state_ == state::settling && now >= settled_at_)
        state_ = state::ready;
}

std::optional<std::int64_t> sequence::deadline() const noexcept
{
    if (state_ == state::settling)
        return settled_at_;
    if (state_ == state::proving && !stalled_ && !withheld_ && muted_until_ != INT64_MIN)
        return muted_until_;
    return std::nullopt;
}

} // namespace tactor::amplifier
