// SPDX-License-Identifier: MIT
/// \file
/// Rates of serial ports.
#pragma once

#include <array>

#include <termios.h>

namespace tactor::detail {

struct baud_rate {
    unsigned baud;   ///< bits per second
    speed_t termios; ///< the same rate as a constant of termios, for cfsetspeed(3)
};

/// Rates for which Linux has constants, from the lowest rate that trigger boxes use.
inline constexpr std::array<baud_rate, 15> baud_rates{{{4800, B4800},
                                                       {9600, B9600},
                                                       {19200, B19200},
                                                       {38400, B38400},
                                                       {57600, B57600},
                                                       {115200, B115200},
                                                       {230400, B230400},
                                                       {460800, B460800},
                                                       {500000, B500000},
                                                       {576000, B576000},
                                                       {921600, B921600},
                                                       {1000000, B1000000},
                                                       {1152000, B1152000},
                                                       {1500000, B1500000},
                                                       {2000000, B2000000}}};

} // namespace tactor::detail
