// SPDX-License-Identifier: MIT
#include "study/masking/masking.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <tactor/choices.hpp>
#include <tactor/error.hpp>

#include "synth/mix/converter.hpp"

namespace tactor::study {
namespace {

constexpr std::size_t masking_block_frames = 64;
constexpr unsigned most_breaks_in_row = 3;

// P. Kellet's filter for pink noise, a sum of first-order filters. At 48 kHz and above 10 Hz, its response
// falls by 3 dB per octave, with errors below 0.25 dB.
struct section {
    double pole;
    double gain;
};
constexpr std::array<section, 6> sections{{{0.99886, 0.0555179},
                                           {0.99332, 0.0750759},
                                           {0.96900, 0.1538520},
                                           {0.86650, 0.3104856},
                                           {0.55000, 0.5329522},
                                           {-0.7616, -0.0168980}}};
constexpr double direct = 0.5362;
constexpr double delayed = 0.115926;
constexpr int response_samples = 1 << 15; // long enough for the slowest pole to decay

constexpr int look_ms = 20;          // longest time between two checks of a stream
constexpr int masking_priority = 60; // below the priority of the array's audio thread

} // namespace

noise::noise(noise_color c, double level_dbfs, std::string_view seed)
    : color_(c),
      gain_(std::pow(10.0, level_dbfs / 20.0) *
            std::numbers::sqrt3), // the RMS of a uniform number between -1 and 1 is 1 / sqrt 3
      r_(seed)
{
    if (c == noise_color::white)
        return;
    double energy = 0.0;
    for (int i = 0; i < response_samples; ++i) {
        const double y = filter_to_pink(i == 0 ? 1.0 : 0.0);
        energy += y * y;
    }
    gain_ /= std::sqrt(energy);
    poles_ = {};
    late_ = 0.0;
}

double noise::filter_to_pink(double white) noexcept
{
    double y = direct * white + late_;
    for (std::size_t i = 0; i < sections.size(); ++i) {
        poles_[i] = sections[i].pole * poles_[i] + sections[i].gain * white;
        y += poles_[i];
    }
    late_ = delayed * white;
    return y;
}

double noise::next() noexcept
{
    const double white = 2.0 * r_.unit() - 1.0;
    return std::clamp(gain_ * (color_ == noise_color::white ? white : filter_to_pink(white)), -1.0, 1.0);
}

masking_stream::masking_stream(sink& s, const masking_options& o)
    : sink_(s),
      noise_(o.color, o.level_dbfs, o.seed),
      frame_bytes_(s.setup().frame_bytes()),
      fade_frames_(static_cast<std::uint32_t>(std::max(1.0, std::round(o.fade_s * s.setup().rate)))),
      samples_(masking_block_frames),
      block_(masking_block_frames * frame_bytes_)
{
}

io_kind masking_stream::begin() noexcept
{
    if (const io_kind s = sink_.prepare(); s != io_kind::ok)
        return s;
    pending_ = 0;
    faded_ = 0;
    made_ = 0;
    full_from_.reset();
    silent_from_ = 0;
    if (const io_kind s = fill(sink_.setup().buffer_frames, false); s != io_kind::ok)
        return s;
    return sink_.start();
}

io_kind masking_stream::step(io_kind ready, bool on) noexcept
{
    if (ready == io_kind::again)
        return io_kind::ok;
    if (ready != io_kind::ok)
        return recover_from_xrun(ready);
    const io_result available = sink_.available();
    if (available.status == io_kind::again)
        return io_kind::ok;
    if (available.status != io_kind::ok)
        return recover_from_xrun(available.status);
    const io_kind s = fill(available.frames, on);
    return s == io_kind::ok ? s : recover_from_xrun(s);
}

io_kind masking_stream::recover_from_xrun(io_kind why) noexcept
{
    if (why != io_kind::xrun)
        return why;
    ++breaks_;
    if (++breaks_in_row_ > most_breaks_in_row)
        return io_kind::failed;
    return begin();
}

io_kind masking_stream::fill(std::size_t frames, bool on) noexcept
{
    while (frames > 0 || pending_ > 0) {
        if (pending_ == 0) {
            pending_ = std::min(frames, masking_block_frames);
            pending_from_ = 0;
            frames -= pending_;
            make_block(pending_, on);
        }
        const io_result r =
            sink_.write(std::span(block_).subspan(pending_from_ * frame_bytes_, pending_ * frame_bytes_));
        if (r.status == io_kind::again || (r.status == io_kind::ok && r.frames == 0))
            return io_kind::ok;
        if (r.status != io_kind::ok)
            return r.status;
        pending_ -= r.frames;
        pending_from_ += r.frames;
    }
    return io_kind::ok;
}

void masking_stream::make_block(std::size_t frames, bool on) noexcept
{
    for (std::size_t i = 0; i < frames; ++i) {
        const double gain = next_gain(on);
        samples_[i] = gain > 0.0 ? gain * noise_.next() : 0.0;
    }
    const std::size_t bytes = sample_bytes(sink_.setup().format);
    const std::array<synth::channel_samples, 1> mono{{{.channel = 0, .x = samples_.data()}}};
    synth::interleave(sink_.setup().format, mono, 1, static_cast<unsigned>(frames), block_.data());
    // Copy backwards from the last frame, so that no frame is overwritten before it is read.
    for (std::size_t i = frames; i-- > 0;)
        for (std::size_t c = sink_.setup().channels; c-- > 0;)
            std::copy_n(block_.data() + i * bytes, bytes, block_.data() + i * frame_bytes_ + c * bytes);
}

double masking_stream::next_gain(bool on) noexcept
{
    if (on && faded_ < fade_frames_) {
        silent_from_.reset();
        if (++faded_ == fade_frames_)
            full_from_ = made_;
    } else if (!on && faded_ > 0) {
        full_from_.reset();
        if (--faded_ == 0)
            silent_from_ = made_;
    }
    ++made_;
    return 0.5 - 0.5 * std::cos(std::numbers::pi * faded_ / fade_frames_);
}

masking_state masking_stream::state() noexcept
{
    const stream_position p = sink_.position();
    if (!p.valid)
        return masking_state::fading;
    if (p.played > 0)
        breaks_in_row_ = 0;
    if (full_from_ && p.played > *full_from_)
        return masking_state::full;
    return silent_from_ && p.played >= *silent_from_ ? masking_state::silent : masking_state::fading;
}

masker::masker(std::unique_ptr<sink> s, const masking_options& o)
    : sink_(std::move(s)),
      patience_(o.patience_s + o.fade_s),
      stream_(*sink_, o),
      fds_(sink_->max_descriptors() + 1)
{
    if (const io_kind k = stream_.begin(); k != io_kind::ok)
        throw error(error_kind::runtime, sink_->setup().name,
                    fmt::format("the masking noise does not start: {}", to_string(k)));
    thread_ = std::make_unique<rt::thread>(
        rt::thread_options{.name = "tactor-masker", .fifo = true, .priority = masking_priority},
        [this] { run(); });
}

masker::~masker()
{
    over_ = true;
    wake_.signal();
    thread_.reset();
    sink_->drop();
}

void masker::request_noise(bool on) noexcept
{
    on_ = on;
    // The old state is no longer valid, even if the thread has not seen the request yet.
    if (ended_ == io_kind::ok)
        state_ = masking_state::fading;
    wake_.signal();
}

bool masker::poll_descriptor(int descriptor, int timeout_ms)
{
    pollfd p{.fd = descriptor, .events = POLLIN, .revents = 0};
    ::poll(&p, 1, timeout_ms);
    return true;
}

bool masker::wait_for(masking_state s, const waiter& wait)
{
    const auto until = std::chrono::steady_clock::now() + patience_;
    for (;;) {
        // Read the clock before the state, because the state may change while this thread is suspended.
        const bool late = std::chrono::steady_clock::now() >= until;
        if (ended_ != io_kind::ok)
            return false;
        if (state_ == s)
            return true;
        if (late || !wait(changed_.fd(), look_ms))
            return false;
        changed_.consume();
    }
}

io_kind masker::wait() noexcept
{
    const std::size_t n = sink_->descriptors(std::span(fds_).first(fds_.size() - 1));
    fds_[n] = {.fd = wake_.fd(), .events = POLLIN, .revents = 0};
    if (::poll(fds_.data(), n + 1, look_ms) < 0)
        return io_kind::again;
    if (fds_[n].revents != 0)
        wake_.consume();
    return sink_->ready(std::span(fds_).first(n));
}

void masker::run() noexcept
{
    while (!over_) {
        const io_kind ready = wait();
        const bool on = on_;
        const io_kind now = stream_.step(ready, on);
        breaks_ = stream_.breaks();
        if (now != io_kind::ok) {
            ended_ = now;
            changed_.signal();
            return;
        }
        const masking_state is = stream_.state();
        // Do not publish the state opposite to the request: it means that the stream has not followed the
        // request yet.
        if (is != (on ? masking_state::silent : masking_state::full) && state_.exchange(is) != is)
            changed_.signal();
    }
}

} // namespace tactor::study
