// SPDX-License-Identifier: MIT
// A finger draws: a touch screen, touch pad or mouse feeds a live stroke, point by point, while it sounds.
//   live_touch EVENTS [PCM]        e.g. live_touch /dev/input/event5 hw:CARD=Tactor; PCM is null by default
// EVENTS is an input device (members of the group input may read them), or a recording of one.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <tactor/tactor.hpp>

namespace {

constexpr double palm_mm = 40.0; // the palm's array is a square
constexpr double mouse_mm = 0.1; // on the palm, for each count of a mouse

// The whole panel is the palm. A recording does not know the size of its panel: 12 bits are usual.
double on_palm(int fd, const input_event& e)
{
    input_absinfo range{};
    if (ioctl(fd, EVIOCGABS(e.code), &range) < 0 || range.maximum <= range.minimum)
        range.minimum = 0, range.maximum = 4095;
    return palm_mm * (e.value - range.minimum) / (range.maximum - range.minimum);
}

} // namespace

int main(int argc, char** argv)
try {
    const int fd = argc > 1 ? open(argv[1], O_RDONLY | O_CLOEXEC) : -1;
    if (fd < 0)
        return std::perror("usage: live_touch EVENTS [PCM]"), 2;
    const tactor::array palm = tactor::preset_array("palm-3x3");
    tactor::player player(
        tactor::open_alsa({.pcm = argc > 2 ? argv[2] : "null", .channels = palm.channels(), .wider = true}),
        palm);
    player.on_report([](const tactor::stroke_report& r) { std::puts(to_string(r.state).data()); });

    tactor::point at{palm_mm / 2.0, palm_mm / 2.0};
    bool down = false;
    std::optional<tactor::live_stroke> stroke; // from the finger's touch on; the newest one
    for (;;) {
        pollfd events{.fd = fd, .events = POLLIN, .revents = 0};
        // A finger at rest sends no events, and the player ends a live stroke without points after
        // live_options::timeout_s: repeat the place every 100 ms.
        input_event e{};
        e.type = EV_SYN;
        if (poll(&events, 1, 100) != 0 && read(fd, &e, sizeof e) != sizeof e)
            break;
        // The kernel sends one change at a time, and then SYN_REPORT.
        if (e.type == EV_ABS && (e.code == ABS_X || e.code == ABS_Y))
            (e.code == ABS_X ? at.x_mm : at.y_mm) = on_palm(fd, e);
        if (e.type == EV_REL && (e.code == REL_X || e.code == REL_Y))
            (e.code == REL_X ? at.x_mm : at.y_mm) += mouse_mm * e.value;
        if (e.type == EV_KEY && (e.code == BTN_TOUCH || e.code == BTN_LEFT))
            down = e.value != 0;
        if (e.type != EV_SYN)
            continue;
        at = {std::clamp(at.x_mm, 0.0, palm_mm), std::clamp(at.y_mm, 0.0, palm_mm)};
        if (down && (!stroke || !stroke->open()))
            stroke = player.begin({.render = {.level_dbfs = -40.0}}); // weak: come up in steps of 6 dB
        if (down)
            stroke->to(at.x_mm, at.y_mm);
        else if (stroke)
            stroke->end(); // fades out
    }
    if (stroke)
        stroke->end();
    return !stroke || player.wait(stroke->id())->state == tactor::state_kind::finished ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "live_touch: %s\n", e.what());
    return 1;
}
