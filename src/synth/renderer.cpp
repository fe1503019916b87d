// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "core/access.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/mix/oscillator.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/score.hpp"

namespace tactor {

struct renderer::impl {
    /// Room for what sounds at once, and for what begins in the block meanwhile.
    impl(const score& s, format_kind f)
        : source(s),
          mix(detail::access::of(s).limits, f, detail::access::of(s).open_events + 256,
              guards(detail::access::of(s))),
          frame_bytes(s.channels() * bytes_of(f))
    {
    }

    static synth::guard_settings guards(const score::impl& s)
    {
        return s.guards ? synth::guards_of(*s.guards, s.rate) : synth::guard_settings{};
    }

    /// Hands over what starts before a frame. Returns the frame up to which nothing is missing.
    std::uint64_t feed(std::uint64_t until) noexcept
    {
        for (const synth::drive_event* e = source.peek(); e != nullptr && e->start < until;
             e = source.peek()) {
            if (!mix.add(*e)) {
                return e->start;
            }
            source.pop();
        }
        return until;
    }

    synth::event_source source;
    synth::mixer mix;
    std::size_t frame_bytes;
};

namespace {

template <typename Impl>
Impl& not_moved(const std::unique_ptr<Impl>& p)
{
    if (p == nullptr)
        throw error(error_kind::bad_input, "renderer", "it was moved from",
                    "use the one that it was moved to");
    return *p;
}

} // namespace

renderer::renderer(const score& s, format_kind f) : impl_(std::make_unique<impl>(s, f))
{
}

renderer::~renderer() = default;
renderer::renderer(renderer&&) noexcept = default;
renderer& renderer::operator=(renderer&&) noexcept = default;

void renderer::process(std::size_t frames, std::byte* out)
{
    impl& r = not_moved(impl_);
    // Whole blocks of the mixer, several at once: little to keep waiting, little to do between.
    constexpr std::uint64_t stride = std::uint64_t{8} * synth::block_frames;
    while (frames > 0) {
        const std::uint64_t at = r.mix.position();
        const std::uint64_t until = std::min(at + frames, at / stride * stride + stride);
        const std::uint64_t ready = std::max(r.feed(until), at + 1);
        const auto n = static_cast<std::size_t>(ready - at);
        r.mix.process(n, out);
        out += n * r.frame_bytes;
        frames -= n;
    }
}

std::uint64_t renderer::position() const
{
    return not_moved(impl_).mix.position();
}

const std::string& renderer::failure() const
{
    return not_moved(impl_).source.failure();
}

} // namespace tactor
