// SPDX-License-Identifier: MIT
/// \file
/// The tool prints by the names of session/say.hpp.
#pragma once

#include "session/say.hpp"

namespace tactor::cli {

using session::fit_lines;
using session::flush_output;
using session::line_width;
using session::output_error;
using session::say;
using session::say_error;
using session::say_text;
using session::show;
using session::shown;
using session::wrap_lines;
using session::wrapped;

} // namespace tactor::cli
