// SPDX-License-Identifier: MIT
#include "sink/alsa/pcm_sink.hpp"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "core/log.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "rt/clock.hpp"
#include "sink/alsa/devices.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/route.hpp"

namespace tactor::alsa {
namespace {

// Returns the outcome for a state of the PCM. A negative state is an error number (the device is gone).
io_kind classify_state(int state) noexcept
{
    if (state < 0)
        return io_kind::lost;
    switch (state) {
    case SND_PCM_STATE_PREPARED:
    case SND_PCM_STATE_RUNNING:
        return io_kind::ok;
    case SND_PCM_STATE_SUSPENDED:
        return io_kind::suspended;
    case SND_PCM_STATE_DISCONNECTED:
        return io_kind::lost;
    default:
        return io_kind::xrun; // stopped for some reason: only prepare() helps
    }
}

} // namespace

pcm_sink::pcm_sink(handle h, stream_setup s, bool on_card)
    : handle_(std::move(h)),
      setup_(std::move(s)),
      arranged_(setup_.planar || setup_.device_channels > setup_.channels
                    ? std::size_t{setup_.buffer_frames} * setup_.device_channels * sample_bytes(setup_.format)
                    : 0),
      planes_(setup_.planar ? setup_.device_channels : 0),
      status_(allocate<status>(snd_pcm_status_malloc)),
      pacer_(setup_.rate, setup_.buffer_frames, setup_.period_frames),
      max_descriptors_(static_cast<std::size_t>(std::max(1, snd_pcm_poll_descriptors_count(handle_.get())))),
      on_card_(on_card)
{
    const std::size_t plane_bytes = setup_.buffer_frames * sample_bytes(setup_.format);
    for (std::size_t c = 0; c < planes_.size(); ++c)
        planes_[c] = &arranged_[c * plane_bytes];
}

io_kind pcm_sink::prepare() noexcept
{
    const quiet silent;
    // The kernel does not prepare a running stream, which may exist after a resume.
    if (state() == SND_PCM_STATE_RUNNING)
        snd_pcm_drop(handle_.get());
    written_ = 0;
    played_ = 0;
    went_round_ = false;
    const int code = snd_pcm_prepare(handle_.get());
    return code < 0 ? classify_error(code, state()) : io_kind::ok;
}

io_kind pcm_sink::start() noexcept
{
    const quiet silent;
    const int code = snd_pcm_start(handle_.get());
    if (code < 0)
        return classify_error(code, state());
    if (!paced_ && runs_without_clock()) {
        paced_ = true;
        setup_.has_clock = false;
    }
    if (paced_)
        pacer_.start(written_);
    looked_ns_ = rt::monotonic_ns();
    at_ = 0;
    return io_kind::ok;
}

std::int64_t pcm_sink::frames_to_ns(std::uint64_t frames) const noexcept
{
    return static_cast<std::int64_t>(frames) * rt::ns_per_s / setup_.rate;
}

// Returns true if all of a full buffer has been played and the stream still runs. A DAC would have had an
// xrun.
bool pcm_sink::runs_without_clock() noexcept
{
    return written_ > 0 && snd_pcm_status(handle_.get(), status_.get()) == 0 &&
           snd_pcm_status_get_state(status_.get()) == SND_PCM_STATE_RUNNING &&
           snd_pcm_status_get_delay(status_.get()) <= 0 &&
           snd_pcm_avail_update(handle_.get()) >= static_cast<snd_pcm_sframes_t>(setup_.buffer_frames);
}

// Does not call snd_pcm_recover(), which sleeps in steps of a second.
io_kind pcm_sink::resume() noexcept
{
    const quiet silent;
    const int code = snd_pcm_resume(handle_.get());
    if (code >= 0)
        return io_kind::ok;
    return code == -EAGAIN ? io_kind::again : io_kind::failed;
}

// Uses the time stamp of the stop, which drivers set. Plugins keep the stamp of the start; then the last
// position gives the time.
std::int64_t pcm_sink::xrun_ns() noexcept
{
    const quiet silent;
    const std::int64_t now = rt::monotonic_ns();
    if (snd_pcm_status(handle_.get(), status_.get()) == 0) {
        snd_htimestamp_t stamp{};
        snd_pcm_status_get_trigger_htstamp(status_.get(), &stamp);
        const std::int64_t stopped = rt::to_ns(stamp);
        if (stopped > seen_ns_ && stopped <= now)
            return now - stopped;
    }
    return dry_ns_ == 0 ? 0 : std::max<std::int64_t>(now - dry_ns_, 0);
}

std::size_t pcm_sink::descriptors(std::span<pollfd> fds) noexcept
{
    const quiet silent;
    if (paced_) {
        pacer_.arm();
        fds[0] = {.fd = pacer_.fd(), .events = POLLIN, .revents = 0};
        return 1;
    }
    const int n = snd_pcm_poll_descriptors(handle_.get(), fds.data(), static_cast<unsigned>(fds.size()));
    poll_error_ = n < 0 ? n : 0; // dmix has no descriptors during an xrun
    return n < 0 ? 0 : static_cast<std::size_t>(n);
}

io_kind pcm_sink::ready(std::span<pollfd> fds) noexcept
{
    const quiet silent;
    if (paced_)
        return pacer_.due() ? io_kind::ok : io_kind::again;
    if (fds.empty())
        return poll_error_ < 0 ? classify_error(poll_error_, state()) : classify_state(state());
    unsigned short events = 0;
    const int code = snd_pcm_poll_descriptors_revents(handle_.get(), fds.data(),
                                                      static_cast<unsigned>(fds.size()), &events);
    if (code < 0)
        return classify_error(code, state());
    if ((events & POLLNVAL) != 0)
        return io_kind::lost;
    if ((events & POLLERR) != 0) {
        const io_kind s = classify_state(state());
        if (s != io_kind::ok)
            return s;
    }
    return (events & POLLOUT) != 0 ? io_kind::ok : io_kind::again;
}

io_result pcm_sink::available() noexcept
{
    const quiet silent;
    if (paced_)
        return {io_kind::ok, static_cast<std::size_t>(pacer_.available()), 0};
    const snd_pcm_sframes_t n = snd_pcm_avail_update(handle_.get());
    if (n < 0)
        return {classify_error(n, state()), 0, static_cast<int>(n)};
    look(rt::monotonic_ns(), n);
    if (went_round_)
        return {io_kind::xrun, 0, -EPIPE};
    return {io_kind::ok, static_cast<std::size_t>(n), 0};
}

void pcm_sink::look(std::int64_t now, snd_pcm_sframes_t available) noexcept
{
    const std::int64_t at = static_cast<std::int64_t>(written_) - setup_.buffer_frames + available;
    went_round_ =
        went_round_ || (on_card_ && at != at_ && now - looked_ns_ >= frames_to_ns(setup_.buffer_frames));
    looked_ns_ = now;
    at_ = at;
}

// Copies the frames into the PCM's layout. Its further channels have been silent since construction.
void pcm_sink::arrange_frames(std::span<const std::byte> frames) noexcept
{
    const std::size_t own = setup_.frame_bytes();
    const std::size_t bytes = sample_bytes(setup_.format);
    if (setup_.planar) {
        for (unsigned c = 0; c < setup_.channels; ++c) {
            auto* to = static_cast<std::byte*>(planes_[c]);
            for (std::size_t at = c * bytes; at < frames.size(); at += own)
                to = std::copy_n(&frames[at], bytes, to);
        }
        return;
    }
    const std::size_t wide = setup_.device_channels * bytes;
    for (std::size_t f = 0; f < frames.size() / own; ++f)
        std::copy_n(&frames[f * own], own, &arranged_[f * wide]);
}

// Writes frames, which have been arranged if the PCM needs that. Returns what snd_pcm_writei() returns.
long pcm_sink::hand_over(std::span<const std::byte> frames) noexcept
{
    const std::size_t count = frames.size() / setup_.frame_bytes();
    if (setup_.planar)
        return snd_pcm_writen(handle_.get(), planes_.data(), count);
    return snd_pcm_writei(handle_.get(), arranged_.empty() ? frames.data() : arranged_.data(), count);
}

// Writes frames of a paced stream. A PCM of type multi over nulls is full before it starts, and fails after
// the start; once prepared again, it takes frames.
long pcm_sink::write_paced_frames(std::span<const std::byte> frames) noexcept
{
    const long n = hand_over(frames);
    if (n > 0 || (n != 0 && n != -EAGAIN && n != -EPIPE))
        return n;
    snd_pcm_drop(handle_.get());
    snd_pcm_prepare(handle_.get());
    return hand_over(frames);
}

io_result pcm_sink::write(std::span<const std::byte> frames) noexcept
{
    const quiet silent;
    std::size_t count = frames.size() / setup_.frame_bytes();
    if (!arranged_.empty())
        count = std::min<std::size_t>(count, setup_.buffer_frames);
    if (paced_)
        count = std::min<std::size_t>(count, pacer_.available());
    if (count == 0)
        return {io_kind::again, 0, 0};
    const std::span<const std::byte> taken_from = frames.first(count * setup_.frame_bytes());
    if (!arranged_.empty())
        arrange_frames(taken_from);
    const long n = paced_ ? write_paced_frames(taken_from) : hand_over(taken_from);
    if (n < 0)
        return {classify_error(n, state()), 0, static_cast<int>(n)};
    const auto taken = static_cast<std::size_t>(n);
    written_ += taken;
    if (paced_)
        pacer_.wrote(taken);
    // A plugin that is full before its start returns 0, not EAGAIN.
    return {taken == 0 ? io_kind::again : io_kind::ok, taken, 0};
}

stream_position pcm_sink::position() noexcept
{
    const quiet silent;
    const std::int64_t now = rt::monotonic_ns();
    if (paced_) {
        played_ = pacer_.played(now);
        return {written_, played_, now, true};
    }
    if (snd_pcm_status(handle_.get(), status_.get()) < 0 ||
        snd_pcm_status_get_state(status_.get()) != SND_PCM_STATE_RUNNING)
        return {written_, played_, now, false};
    const auto queued =
        static_cast<std::uint64_t>(std::max<snd_pcm_sframes_t>(snd_pcm_status_get_delay(status_.get()), 0));
    // The delay may include the DAC's delay, so at the start it may exceed the number of written frames.
    if (queued <= written_)
        played_ = std::max(played_, written_ - queued);
    look(now, static_cast<snd_pcm_sframes_t>(snd_pcm_status_get_avail(status_.get())));
    snd_htimestamp_t stamp{};
    snd_pcm_status_get_htstamp(status_.get(), &stamp);
    const std::int64_t at = rt::to_ns(stamp);
    // Plugins may leave the stamp empty or use another clock. A card's stamp is usually that of this call.
    const bool sane = at <= rt::monotonic_ns() && now - at < rt::ns_per_s;
    seen_ns_ = sane ? at : now;
    dry_ns_ = seen_ns_ + frames_to_ns(queued);
    return {written_, played_, seen_ns_, true};
}

void pcm_sink::drop() noexcept
{
    const quiet silent;
    snd_pcm_drop(handle_.get());
}

io_kind classify_error(long code, int state) noexcept
{
    switch (-code) {
    case EAGAIN:
    case EINTR:
        return io_kind::again;
    case EPIPE:
        // An ioplug turns each failure into EPIPE, even the loss of a device.
        return classify_state(state) == io_kind::lost ? io_kind::lost : io_kind::xrun;
    case ESTRPIPE:
        return io_kind::suspended;
    case ENODEV:
    case ENOTTY:
    case ENXIO:
        return io_kind::lost;
    case EBADFD: {
        const io_kind s = classify_state(state);
        return s == io_kind::ok ? io_kind::failed : s;
    }
    default:
        return io_kind::failed;
    }
}

namespace {

std::optional<card_place> find_place(snd_pcm_t* p)
{
    const auto info =
        allocate<std::unique_ptr<snd_pcm_info_t, deleter<snd_pcm_info_free>>>(snd_pcm_info_malloc);
    if (snd_pcm_info(p, info.get()) != 0 || snd_pcm_info_get_card(info.get()) < 0)
        return {};
    const std::string index = fmt::to_string(snd_pcm_info_get_card(info.get()));
    const std::optional<card_info> card = find_card(sound_cards("/"), index);
    return card_place{.card = card ? card->id : index,
                      .device = snd_pcm_info_get_device(info.get()),
                      .subdevice = snd_pcm_info_get_subdevice(info.get())};
}

// Configures a PCM. `top`: the configuration that defines the PCM, or null. `device`: value of
// stream_setup::device if `top` is null.
std::unique_ptr<sink> configure(handle h, const alsa_options& o, snd_config_t* top, bool as_card = false,
                                std::string_view device = {})
try {
    const library_messages silent;
    stream_setup s = negotiate(h.get(), o);
    s.device = device;
    const std::optional<card_place> place = find_place(h.get());
    if (top != nullptr) {
        s.wiring = find_wiring(top, o.pcm, o.channels, s.device_channels);
        s.device = find_drive_time_device(o.pcm, find_route(top, o.pcm), place, s.wiring);
    }
    set_software_params(h.get(), s);
    detail::log(o.log, log_kind::info, "PCM \"{}\": {}, {} Hz, {}, {} of {} frames{}", o.pcm,
                s.device_channels == s.channels
                    ? counted(s.channels, "channel")
                    : fmt::format("{} of {} channels", s.channels, s.device_channels),
                s.rate, to_string(s.format), s.buffer_frames / s.period_frames, s.period_frames,
                s.period_frames == o.period_frames && s.buffer_frames == o.periods * s.period_frames
                    ? ""
                    : fmt::format("; {} of {} were requested", o.periods, o.period_frames));
    if (s.batch)
        detail::log(o.log, log_kind::debug, "PCM \"{}\": its position moves by whole periods", o.pcm);
    if (!s.wiring.hidden_by.empty())
        detail::log(o.log, log_kind::warning,
                    "PCM \"{}\": it is unknown which channels of the device its own reach: {} is between",
                    o.pcm, s.wiring.hidden_by);
    return std::make_unique<pcm_sink>(std::move(h), std::move(s), as_card || place);
} catch (const error&) {
    throw;
} catch (const std::system_error& e) {
    detail::throw_resource_error(fmt::format("PCM \"{}\"", o.pcm), e.code().value(), e.what());
}

} // namespace

std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card, std::string_view device)
{
    handle h(p);
    check(o);
    return configure(std::move(h), o, nullptr, as_card, device);
}

} // namespace tactor::alsa

namespace tactor {
inline namespace v0 {

std::unique_ptr<sink> open_alsa(const alsa_options& o)
{
    alsa::check(o);
    const alsa::configuration top = alsa::read_configuration(o.config_text);
    return alsa::configure(alsa::open(o, top.get()), o, top.get());
}

std::unique_ptr<sink> reopen_alsa(const alsa_options& o, const std::function<bool(double)>& pause)
{
    constexpr double longest_s = 5.0;
    if (!pause)
        throw error(error_kind::bad_input, "reopen_alsa", "there is no function that waits",
                    "give a function");
    detail::log(o.log, log_kind::info, "waiting for PCM \"{}\" to come back", o.pcm);
    for (double wait_s = 0.1; pause(wait_s); wait_s = std::min(2.0 * wait_s, longest_s)) {
        try {
            std::unique_ptr<sink> s = open_alsa(o);
            detail::log(o.log, log_kind::info, "PCM \"{}\" is back", o.pcm);
            return s;
        } catch (const error& e) {
            // The device is not back yet, or udev has not set its group yet.
            if (e.kind() != error_kind::not_available)
                throw;
            detail::log(o.log, log_kind::debug, "not back yet: {}", e.what());
        }
    }
    return nullptr;
}

} // namespace v0
} // namespace tactor
