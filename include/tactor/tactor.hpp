// SPDX-License-Identifier: MIT
/// \file
/// Includes every header but <tactor/asio.hpp> and <tactor/config.hpp>, and plays a stroke by one call.
/// Include this one, or single headers.
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
/// closes it again. Reads no configuration and switches no amplifier. Blocks; any thread without real-time
/// priority. A program that plays more than one stroke keeps a player. \throws error: bad_input for a stroke
/// that cannot be planned or rendered, as make_plan() and score;
///         not_available or runtime for a device that cannot be opened, as open_alsa().
[[nodiscard]] inline stroke_report play(const std::string& pcm, const array& a, const stroke& s,
                                        const render_options& o = {}, const plan_options& p = {})
{
    const score made(a, make_plan(a, s, p), o);
    player out(open_alsa({.pcm = pcm, .channels = made.channels(), .wider = true, .rate = made.rate()}), a);
    return *out.wait(out.submit(made));
}

} // namespace v0
} // namespace tactor
