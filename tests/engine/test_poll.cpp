// SPDX-License-Identifier: MIT
// The sink and a device that gives no descriptors.
#include <cstddef>
#include <span>
#include <vector>

#include <poll.h>

#include <doctest/doctest.h>

#include "fake_dac.hpp"
#include "player_support.hpp"
#include "sink/alsa/adopt.hpp"

namespace poll_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("a device without descriptors in an xrun, such as dmix, is not asked about them")
{
    fake_dac dac;
    dac.hide_descriptors_in_xrun();
    const auto s = pcm::adopt(dac.pcm(), nine());
    std::vector<std::byte> silence(288 * s->setup().frame_bytes());
    REQUIRE(s->prepare() == io_kind::ok);
    REQUIRE(s->write(silence).frames == 288);
    REQUIRE(s->start() == io_kind::ok);
    std::vector<pollfd> fds(s->max_descriptors());
    CHECK(s->descriptors(fds) == 1);
    CHECK(s->ready(std::span(fds).first(1)) == io_kind::again);
    dac.advance(10'000);
    CHECK(s->available().status == io_kind::xrun);
    const std::size_t n = s->descriptors(fds);
    CHECK(n == 0);
    CHECK(s->ready(std::span(fds).first(n)) == io_kind::xrun);
    CHECK(dac.asked_in_vain() == 0);
}

} // namespace poll_test
