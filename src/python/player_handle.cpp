// SPDX-License-Identifier: MIT
#include "python/player_handle.hpp"

#include <mutex>
#include <utility>

#include <unistd.h>

#include "session/device.hpp"

namespace tactor::python {
namespace {

bool same_map(const array& a, const array& b)
{
    if (a.tactors.size() != b.tactors.size())
        return false;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (a.tactors[i].channel != b.tactors[i].channel)
            return false;
    return true;
}

} // namespace

session::environment read_environment(session::settings& s, const array* a)
{
    session::environment e = session::read_environment(s);
    if (a == nullptr)
        return e;
    // A channel count belongs to its map.
    if (!same_map(e.tactors, *a))
        e.config.output.channels.reset();
    e.tactors = *a;
    return e;
}

player_handle::player_handle(const array& a, session::settings s, bool keep, bool wants_log)
    : owner_(::getpid()), events_(std::make_shared<event_queue>()), open_(std::make_unique<open_state>())
{
    const session::environment e = read_environment(s, &a);
    const render_options sound = session::settle_render(s, e);
    alsa_options device = session::device_options(s, s.stream, e, sound.channels, sound.rate);
    const auto events = events_;
    if (wants_log)
        device.log = [events](log_kind k, std::string_view text) {
            events->put(log_line{std::string(to_string(k)), std::string(text)});
        };
    session::settle_server(device.pcm);
    const bool waits_for_edges = !s.stream.no_gpio && e.config.sync && e.config.sync->in;
    // Before threads: it forks the holder of the amplifier's line.
    open_->lines = session::lent_lines(session::open_lines(s.stream, e, waits_for_edges));
    player_options o;
    o.limits = session::settle_limits(s.stream, e);
    o.require_realtime = s.stream.require_realtime;
    o.keep_drive_time = keep;
    o.log = device.log;
    open_->stream = std::make_unique<player>(session::open_device(device, a), a, o, open_->lines.lend());
    open_->stream->on_report([events](const stroke_report& r) { events->put(r); });
    setup_ = open_->stream->setup();
}

player_handle::~player_handle()
{
    if (forked()) { // the parent's: not even the memory is given back, for that would end things
        static_cast<void>(open_.release());
        return;
    }
    // Its threads may be waiting for the interpreter, to drop what is Python's.
    if (PyGILState_Check() != 0) {
        const without_lock free;
        close();
    } else {
        close();
    }
}

bool player_handle::forked() const noexcept
{
    return ::getpid() != owner_;
}

void player_handle::refuse_child() const
{
    if (forked())
        throw error(error_kind::runtime, "player", "this process was forked from the one that has it",
                    "make one of its own, or play in the parent");
}

bool player_handle::closed() const
{
    if (forked())
        return false;
    const std::shared_lock lock(open_->mutex);
    return open_->stream == nullptr;
}

std::optional<std::string> player_handle::end_reason(const player& p)
{
    const auto end = p.ended();
    return end ? std::optional(end->why) : std::nullopt;
}

player_stats player_handle::stats() const
{
    refuse_child();
    const std::shared_lock lock(open_->mutex);
    return open_->stream != nullptr ? open_->stream->stats() : open_->last.stats;
}

std::optional<std::string> player_handle::ended() const
{
    refuse_child();
    const std::shared_lock lock(open_->mutex);
    return open_->stream != nullptr ? end_reason(*open_->stream) : open_->last.ended;
}

bool player_handle::cancel(stroke_id id) const
{
    refuse_child();
    const std::shared_lock lock(open_->mutex);
    return open_->stream != nullptr && open_->stream->cancel(id);
}

void player_handle::close()
{
    refuse_child();
    {
        const std::shared_lock lock(open_->mutex);
        if (open_->stream != nullptr)
            open_->stream->stop();
    }
    std::unique_ptr<player> ended;
    {
        const std::unique_lock lock(open_->mutex);
        ended = std::move(open_->stream);
        if (ended != nullptr)
            open_->last = {ended->stats(), end_reason(*ended)};
    }
    ended.reset();
    {
        const std::unique_lock lock(open_->mutex);
        open_->lines = session::lent_lines();
    }
    events_->close();
}

} // namespace tactor::python
