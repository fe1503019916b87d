// SPDX-License-Identifier: MIT
#include "study/session/stage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "rt/clock.hpp"

namespace tactor::study {

stage::stage(const alsa_options& device, const session::stream_options& o, const session::environment& e,
             const session::stream_source& source)
    : play_session(device, o, e, source), room_(setup().channels, session::find_limits(o, e), setup().rate)
{
    room_.resume(drive_levels_s());
}

std::string given_stimulus::fault() const
{
    if (flaw.empty() && limited)
        return "a limit changed it ([limits] in the array file or configuration)";
    return flaw;
}

double stage::needed_delay_s(const score& s, double lead_s) const
{
    const std::uint64_t at =
        before_ + position().played + static_cast<std::uint64_t>(std::llround(lead_s * s.rate()));
    const std::uint64_t wait =
        room_.wait(s, at).value_or(0); // 0 if no wait helps; play_score() reports the limit
    return static_cast<double>(wait) / s.rate();
}

bool stage::wait_for_room(const score& s, double lead_s, const std::function<bool(double)>& watch)
{
    const double wait_s = needed_delay_s(s, lead_s);
    return wait_s == 0.0 || wait_for_seconds(wait_s, watch);
}

void stage::set_masking(sink_opener open, const masking_options& o)
{
    open_masker_ = std::move(open);
    masking_ = o;
    masker_ = std::make_unique<masker>(open_masker_(), masking_);
}

void stage::set_masking(const std::string& pcm, const masking_options& o)
{
    // A buffer of 40 ms is short enough: it delays only the start of the noise.
    const alsa_options stereo{.pcm = pcm, .channels = 2, .wider = true, .period_frames = 480, .periods = 4};
    set_masking([stereo] { return open_alsa(stereo); }, o);
}

void stage::check_signal() const
{
    if (signal() != 0)
        throw interruption{signal()};
}

bool stage::fade_in()
{
    if (!masker_)
        return true;
    if (masker_->end_reason() != io_kind::ok) {
        masker_.reset(); // closes the device before it is opened again
        masker_ = std::make_unique<masker>(open_masker_(), masking_);
    }
    masker_->fade_in();
    const bool full = masker_->wait_for(masking_state::full, [this](int descriptor, int timeout_ms) {
        return play_session::wait_for(descriptor, timeout_ms);
    });
    check_signal();
    return full;
}

void stage::fade_out() noexcept
{
    if (masker_)
        masker_->fade_out();
}

given_stimulus stage::play_score(const score& s, double lead_s, const watcher& watch)
{
    given_stimulus g;
    if (!fade_in()) {
        g.flaw = fmt::format("the masking noise does not play ({})", to_string(masker_->end_reason()));
        return g;
    }
    const unsigned breaks = masker_ ? masker_->breaks() : 0;
    const player_stats before = stats();
    // Starts at a frame that is known in advance. If the stimulus is late, the report has the delay.
    const std::uint64_t at = position().played + setup().buffer_frames +
                             static_cast<std::uint64_t>(std::llround(lead_s * s.rate()));
    const auto gone = submit(s, start_at::frame(at));
    const stroke_report r = gone ? *gone : follow([&] {
        if (const auto frame = stroke_frame())
            watch(*frame);
        return session::look{.most_ms = session::frame_ms};
    });
    log_end("stimulus", r);
    check_signal();
    const player_stats after = stats();
    g.xruns = static_cast<unsigned>(after.xruns - before.xruns);
    g.limited =
        after.drives_cut != before.drives_cut || after.power_limited_frames != before.power_limited_frames;
    const auto length = static_cast<std::int64_t>(static_cast<double>(s.frames()) / s.rate() * 1e9);
    g.frames = r.frames;
    if (r.frames > 0)
        g.first_frame = at + static_cast<std::uint64_t>(std::llround(std::max(0.0, r.late_s) * s.rate()));
    g.started_ns = r.started_ns.value_or(rt::monotonic_ns() - (r.frames > 0 ? length : 0));
    g.ended_ns = g.started_ns + length;
    if (g.first_frame)
        room_.add_played_score(s, before_ + *g.first_frame);
    if (after.drives_cut != before.drives_cut)
        room_.close(before_ + position().played); // some other program must have driven the array
    if (r.state != state_kind::finished)
        g.flaw = r.state == state_kind::cancelled ? "it was cut off" : r.why;
    else if (g.xruns > 0)
        g.flaw = "an xrun";
    else if (masker_ && (masker_->breaks() != breaks || noise_end_reason() != io_kind::ok))
        g.flaw = "the masking noise stopped";
    return g;
}

given_stimulus stage::play_with_retry(const score& s, const std::function<bool(double)>& watch)
{
    const auto once = [&] {
        const noise_around noise(*this);
        return play_score(s, 0.0, [](std::uint64_t) {});
    };
    given_stimulus g = once();
    if (g.flaw.empty() && g.limited && wait_for_seconds(room_.rest_s(), watch))
        g = once();
    return g;
}

bool stage::wait_for_seconds(double seconds, const std::function<bool(double)>& watch)
{
    const std::uint64_t began = position().played;
    for (;;) {
        const std::uint64_t now = position().played;
        const double passed_s = static_cast<double>(now - std::min(now, began)) / setup().rate;
        if (passed_s >= seconds || !watch(passed_s))
            return true;
        if (lost())
            return false;
        const double left_ms = std::ceil((seconds - passed_s) * 1e3);
        static_cast<void>(
            play_session::wait_for(-1, static_cast<int>(std::min<double>(session::frame_ms, left_ms))));
        check_signal();
    }
}

void stage::wait_for(int descriptor)
{
    if (!play_session::wait_for(descriptor))
        throw interruption{signal()};
}

bool stage::reopen()
{
    const std::uint64_t passed = position().played;
    const bool back = play_session::reopen();
    before_ += back ? passed : 0;
    check_signal();
    return back;
}

void stage::finish()
{
    if (masker_) {
        masker_->fade_out();
        masker_->wait_for(masking_state::silent);
    }
    play_session::finish().check_amplifier();
}

} // namespace tactor::study
