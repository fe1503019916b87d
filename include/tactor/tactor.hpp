// SPDX-License-Identifier: MIT
/// \file
/// Includes every header except <tactor/asio.hpp> and <tactor/config.hpp>, and declares play(), which plays a
/// stroke in one call. Include this header, or single headers.
#pragma once

#include <string>

#include <tactor/alsa.hpp>
#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/path.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>
#include <tactor/version.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// Plays a stroke once on an ALSA device, such as "hw:CARD=Tactor", and waits until it has ended. Returns how
/// it ended. Opens the device with the channels of the array (o.channels if that is more) and o.rate, and
/// closes the device again. Reads no configuration and switches no amplifier. Blocks. Any thread without
/// real-time priority may call this. To play more than one stroke, use a player.
/// \throws error (bad_input) for a stroke that cannot be planned or rendered, as make_plan() and score do.
/// \throws error (not_available or runtime) for a device that cannot be opened, as open_alsa() does.
[[nodiscard]] inline stroke_report play(const std::string& pcm, const array& a, const stroke& s,
                                        const render_options& o = {}, const plan_options& p = {})
{
    const score made(a, make_plan(a, s, p), o);
    player out(open_alsa({.pcm = pcm, .channels = made.channels(), .wider = true, .rate = made.rate()}), a);
    return *out.wait(out.submit(made));
}

} // namespace v0
} // namespace tactor
