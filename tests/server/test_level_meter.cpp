// SPDX-License-Identifier: MIT
// Levels of what is written, in every sample format.
#include "server/stream.hpp"

#include <cstring>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

namespace level_meter_test {

using namespace tactor;

namespace {

/// A sink that takes everything.
class open_mouth final : public sink {
public:
    explicit open_mouth(format_kind f)
    {
        setup_.format = f;
        setup_.channels = 2;
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 0; }
    std::size_t descriptors(std::span<pollfd>) noexcept override { return 0; }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {.frames = 2}; }
    io_result write(std::span<const std::byte>) noexcept override { return {.frames = 2}; }
    stream_position position() noexcept override { return {}; }
    void drop() noexcept override {}

private:
    stream_setup setup_;
};

// Two frames of two channels; the second channel has -0.75 in the second frame.
template <typename T>
std::vector<std::byte> frames(T quiet, T loud)
{
    const T samples[] = {quiet, quiet, quiet, loud};
    std::vector<std::byte> bytes(sizeof samples);
    std::memcpy(bytes.data(), samples, sizeof samples);
    return bytes;
}

} // namespace

TEST_CASE("the level of each channel, in each format")
{
    std::vector<std::byte> packed(12); // 24 bits in three bytes
    packed[11] = std::byte{0xa0};      // -0.75
    struct {
        format_kind format;
        std::vector<std::byte> bytes;
    } const cases[] = {
        {format_kind::float32, frames(0.0F, -0.75F)},
        {format_kind::s16, frames<std::int16_t>(0, -24576)},
        {format_kind::s24_3, packed},
        {format_kind::s24_4, frames<std::int32_t>(0, -6291456)},
        {format_kind::s32, frames<std::int32_t>(0, -1610612736)},
    };
    for (const auto& c : cases) {
        CAPTURE(to_string(c.format));
        const auto peaks = std::make_shared<server::level_peaks>(2);
        const auto s = server::add_meter(std::make_unique<open_mouth>(c.format), peaks);
        CHECK(s->write(c.bytes).frames == 2);
        CHECK(peaks->take(1) == 0.0F); // nobody listens
        peaks->listen(true);
        CHECK(s->write(c.bytes).frames == 2);
        CHECK(peaks->take(0) == 0.0F);
        CHECK(peaks->take(1) == 0.75F);
        CHECK(peaks->take(1) == 0.0F);
    }
}

} // namespace level_meter_test
