// SPDX-License-Identifier: MIT
/// \file
/// A serial trigger box. Its outputs show the last byte that the box received, so they serve like GPIO lines
/// that show a number.
#pragma once

#include <memory>
#include <string>

#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::study {

/// Opens a serial port with eight data bits, no parity, one stop bit and no flow control, for this process
/// only, and sends a 0. set() sends a byte if the number changes, and does not block. Opens only terminal
/// devices, and never the terminal of this session, because the path may come from a file that somebody else
/// wrote. `baud`: one of detail::baud_rates. `where`: place of the path in a file. \throws error:
/// not_available if the port is missing, belongs to another program or does not support the rate; bad_input
/// if it is not a serial port.
std::unique_ptr<amplifier::code_lines> open_serial_port(const std::string& device, unsigned baud,
                                                        const source_place& where);

} // namespace tactor::study
