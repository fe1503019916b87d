// SPDX-License-Identifier: MIT
/// \file
/// Everything: include this, or the single headers.
#pragma once

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/curve.hpp>
#include <tactor/devices.hpp>
#include <tactor/drive_history.hpp>
#include <tactor/envelope.hpp>
#include <tactor/error.hpp>
#include <tactor/fit.hpp>
#include <tactor/geometry.hpp>
#include <tactor/gpio.hpp>
#include <tactor/kinds.hpp>
#include <tactor/lines.hpp>
#include <tactor/live.hpp>
#include <tactor/log.hpp>
#include <tactor/movement.hpp>
#include <tactor/observer.hpp>
#include <tactor/path.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
#include <tactor/realtime.hpp>
#include <tactor/render.hpp>
#include <tactor/report.hpp>
#include <tactor/sample_format.hpp>
#include <tactor/setup.hpp>
#include <tactor/sink.hpp>
#include <tactor/start_at.hpp>
#include <tactor/stroke.hpp>
#include <tactor/version.hpp>
#include <tactor/wav.hpp>
#include <tactor/waveform.hpp>
