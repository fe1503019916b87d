// SPDX-License-Identifier: MIT
/// \file
/// A serial trigger box as lines that show a number: its outputs hold the byte that came last.
#pragma once

#include <memory>
#include <string>

#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::study {

/// Opens a serial port with eight data bits, no parity, one stop bit and no flow control, for this process
/// alone, and sends a 0. set() sends a byte if the number is another one than before, and does not wait.
/// Opens terminals alone, and sends nothing to that of this session: the path may be a stranger's.
/// `baud`: one of detail::baud_rates. `where`: place of the path in a file. \throws error: not_available if
/// the port is missing, belongs to another program or does not have the rate; bad_input if it is not a serial
/// port.
std::unique_ptr<amplifier::code_lines> open_serial_port(const std::string& device, unsigned baud,
                                                        const source_place& where);

} // namespace tactor::study
