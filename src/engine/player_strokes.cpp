// SPDX-License-Identifier: MIT
// Strokes that wait for a trigger or for points, and who is told of their ends.
#include <utility>
#include <vector>

#include "engine/live_stroke.hpp"
#include "engine/player_impl.hpp"

namespace tactor {
namespace {

// A descriptor that stays readable without an edge is broken.
constexpr int most_empty_reads = 100;

} // namespace

std::size_t player::impl::fire(std::int64_t time_ns)
{
    const std::lock_guard lock(mutex);
    const std::size_t n = feed.fire(time_ns);
    if (n != 0)
        pump();
    return n;
}

// Control thread: the trigger line is readable. False when it is not worth listening to any more.
bool player::impl::edges()
{
    const auto delay = static_cast<std::int64_t>(lines.trigger_delay_s * 1e9);
    bool any = false;
    for (auto e = lines.trigger->read(); e; e = lines.trigger->read()) {
        fire(e->time_ns + delay);
        any = true;
    }
    empty_reads = any ? 0 : empty_reads + 1;
    return empty_reads < most_empty_reads;
}

live_stroke player::impl::begin(const live_options& o)
{
    std::unique_lock lock(mutex);
    check_open();
    if (!faces)
        faces.emplace(tactors);
    const stroke_id id = ++last_id;
    auto stroke = std::make_shared<live_stroke::impl>(id, tactors, *faces, out->setup(), o);
    feed.submit(id, std::shared_ptr<engine::live_voice>(stroke, &stroke->voice));
    pump();
    return live_stroke(std::move(stroke));
}

bool player::impl::on_end(stroke_id id, std::function<void(const stroke_report&)> done)
{
    std::unique_lock lock(mutex);
    const auto found = ended.find(id);
    if (found == ended.end()) {
        if (!feed.knows(id))
            return false;
        watchers.emplace(id, std::move(done));
        return true;
    }
    const stroke_report r = found->second;
    lock.unlock();
    done(r);
    return true;
}

// Control thread, without the mutex: what is called may call the player.
void player::impl::tell(const std::vector<stroke_report>& reports)
{
    std::unique_lock lock(mutex);
    const std::function<void(const stroke_report&)> common = handler;
    lock.unlock();
    for (const stroke_report& r : reports) {
        if (common)
            common(r);
        lock.lock();
        std::vector<std::function<void(const stroke_report&)>> own;
        const auto [first, last] = watchers.equal_range(r.id);
        for (auto w = first; w != last; ++w)
            own.push_back(std::move(w->second));
        watchers.erase(first, last);
        lock.unlock();
        for (const auto& f : own)
            f(r);
    }
}

} // namespace tactor
