// SPDX-License-Identifier: MIT
/// \file
/// Includes every header but <tactor/asio.hpp> and <tactor/config.hpp>. Include this one, or single headers.
#pragma once

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
