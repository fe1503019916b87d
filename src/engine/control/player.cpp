// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include <algorithm>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include <boost/system/system_error.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "engine/control/player_impl.hpp"

namespace tactor {
inline namespace v0 {

void start_at::refuse_frame(long long stream_frame)
{
    throw error(error_kind::bad_input, "start", fmt::format("frame {}", stream_frame),
                "frames of the stream count from 0; start_at::now() is as soon as possible")
        .with_field("start");
}

player::player(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines lines)
try : impl_(std::make_shared<impl>(std::move(s), a, o, std::move(lines))) {
    impl_->start(o);
} catch (const error&) {
    throw;
} catch (const boost::system::system_error& e) {
    detail::refused_by_system("player", e.code().value(), e.code().message());
} catch (const std::system_error& e) {
    detail::refused_by_system("player", e.code().value(), e.what());
}

player::~player()
{
    impl_->close();
}

const stream_setup& player::setup() const noexcept
{
    return impl_->made;
}

stroke_id player::submit(const score& s, start_at start, double level_db)
{
    return impl_->submit(s, start, level_db);
}

bool player::set_level(stroke_id id, double db)
{
    return impl_->set_level(id, db);
}

std::optional<std::uint64_t> player::first_frame(stroke_id id) const
{
    return impl_->first_frame(id);
}

std::size_t player::fire(std::int64_t monotonic_ns)
{
    return impl_->fire(monotonic_ns);
}

live_stroke player::begin(const live_options& o)
{
    return impl_->begin(o);
}

bool player::on_end(stroke_id id, std::function<void(const stroke_report&)> done)
{
    return impl_->on_end(id, std::move(done));
}

bool player::cancel(stroke_id id)
{
    return impl_->cancel(id);
}

bool player::cancel_all()
{
    return impl_->cancel_all();
}

wait_result player::wait(stroke_id id, std::optional<double> timeout_s)
{
    return impl_->wait(id, timeout_s);
}

void player::on_report(std::function<void(const stroke_report&)> handler)
{
    auto shared = handler ? std::make_shared<const impl::report_handler>(std::move(handler)) : nullptr;
    const std::lock_guard lock(impl_->mutex);
    impl_->handler.swap(shared); // the old one is destroyed after the lock: it may call the player
}

void player::on_begin(std::function<void(stroke_id, std::optional<std::int64_t>)> handler)
{
    auto shared = handler ? std::make_shared<const impl::begin_handler>(std::move(handler)) : nullptr;
    const std::lock_guard lock(impl_->mutex);
    if (shared != nullptr)
        impl_->feed.keep_beginnings();
    impl_->on_begun.swap(shared); // destroyed after the lock, as above
}

void player::stop()
{
    impl_->stop(false);
}

std::optional<stream_end> player::ended() const
{
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->feed.stream_over())
        return std::nullopt;
    return impl_->end();
}

player_position player::position() const noexcept
{
    const std::lock_guard lock(impl_->mutex);
    const engine::stream_status s = impl_->link.status.load();
    player_position p{.running = s.running, .played = s.played, .stroke = {}, .stroke_frame = s.stroke_frame};
    if (s.sounding)
        p.stroke = s.stroke;
    return p;
}

player_stats player::stats() const
{
    const engine::counters& c = impl_->link.count;
    const auto get = [](const std::atomic<std::uint64_t>& a) { return a.load(std::memory_order_relaxed); };
    const std::uint64_t low = get(c.low_water);
    engine::pulse_stats pulses;
    if (impl_->pulses != nullptr) {
        const std::lock_guard lock(impl_->mutex);
        pulses = impl_->pulses->stats();
    }
    const std::uint64_t xruns = c.xruns.load(std::memory_order_acquire);
    std::vector<double> lengths;
    for (std::uint64_t n = xruns - std::min<std::uint64_t>(xruns, c.xrun_ns.size()); n < xruns; ++n)
        lengths.push_back(
            static_cast<double>(c.xrun_ns[n % c.xrun_ns.size()].load(std::memory_order_relaxed)) / 1e9);
    return {.periods = get(c.periods),
            .frames = get(c.frames),
            .xruns = xruns,
            .limited_frames = get(c.limited),
            .power_limited_frames = get(c.power_limited),
            .drives_cut = get(c.drives_cut),
            .stalls = get(c.stalls),
            .off_failures = get(c.off_failures),
            .left_on = impl_->link.amplifier.stuck.load(std::memory_order_relaxed) &&
                       !impl_->link.amplifier.off.load(std::memory_order_relaxed),
            .sync_pulses = pulses.sent,
            .sync_missed = pulses.missed,
            .sync_mean_late_s = pulses.mean_late_s,
            .sync_worst_late_s = pulses.worst_late_s,
            .ring_low_water = low == UINT64_MAX ? 0 : low,
            .latest_wakeup_s = static_cast<double>(get(c.late_frames)) / impl_->made.rate,
            .minor_faults = get(c.minor_faults),
            .major_faults = get(c.major_faults),
            .realtime =
                impl_->audio.fifo_error() == 0 && !c.realtime_given_up.load(std::memory_order_relaxed),
            .xrun_s = std::move(lengths)};
}

} // namespace v0
} // namespace tactor
