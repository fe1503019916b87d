// SPDX-License-Identifier: MIT
#include "study/session/serial_port.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <linux/major.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/baud_rates.hpp"
#include "core/owned.hpp"

namespace tactor::study {
namespace {

constexpr const char* port_hint = "list the ports: ls /dev/serial/by-id /dev/ttyS*";

class serial_port final : public amplifier::code_lines {
public:
    explicit serial_port(detail::owned_fd port) : port_(std::move(port)) {}
    bool set(unsigned number) noexcept override
    {
        if (number == shown_)
            return true;
        const auto byte = static_cast<unsigned char>(number);
        const bool sent = ::write(port_.get(), &byte, 1) == 1;
        if (sent)
            shown_ = number;
        return sent;
    }

private:
    detail::owned_fd port_;
    std::atomic<unsigned> shown_ = 256; ///< last byte sent; 256 before the first byte
};

// Returns true if a file is a terminal device. Does not open it, because opening some devices has side
// effects.
bool is_terminal(const struct stat& s)
{
    const unsigned kind = major(s.st_rdev);
    if (!S_ISCHR(s.st_mode))
        return false;
    if (kind >= UNIX98_PTY_SLAVE_MAJOR && kind < UNIX98_PTY_SLAVE_MAJOR + UNIX98_PTY_MAJOR_COUNT)
        return true; // the only terminals that /sys does not list
    std::error_code ec;
    const auto subsystem = std::filesystem::read_symlink(
        fmt::format("/sys/dev/char/{}:{}/subsystem", kind, minor(s.st_rdev)), ec);
    return subsystem.filename() == "tty";
}

bool set_rate(int port, speed_t rate)
{
    termios t{};
    if (::tcgetattr(port, &t) != 0)
        return false;
    ::cfmakeraw(&t);
    t.c_iflag &= ~static_cast<tcflag_t>(IXOFF | IXANY);
    t.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | CREAD);
    t.c_cflag |= CLOCAL;
    termios now{};
    return ::cfsetspeed(&t, rate) == 0 && ::tcsetattr(port, TCSANOW, &t) == 0 &&
           ::tcgetattr(port, &now) == 0 && ::cfgetospeed(&now) == rate;
}

} // namespace

std::unique_ptr<amplifier::code_lines> open_serial_port(const std::string& device, unsigned baud,
                                                        const source_place& where)
{
    const auto refuse = [&](error_kind kind, std::string_view why, std::string_view hint) {
        throw error(kind, where, fmt::format("serial: {}: {}", device, why), hint);
    };
    struct stat s {};
    if (::stat(device.c_str(), &s) != 0)
        refuse(error_kind::not_available, std::strerror(errno), port_hint);
    if (!is_terminal(s))
        refuse(error_kind::bad_input, "it is not a serial port", port_hint);
    detail::owned_fd port(::open(device.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!port)
        refuse(error_kind::not_available, std::strerror(errno),
               errno == EACCES  ? "sudo usermod -aG dialout $USER, then log in again"
               : errno == EBUSY ? "end the program that uses the port"
                                : port_hint);
    if (::isatty(port.get()) == 0)
        refuse(error_kind::bad_input, "it is not a serial port", port_hint);
    if (::tcgetsid(port.get()) != -1)
        refuse(error_kind::bad_input, "it is the terminal of this session", port_hint);
    if (::ioctl(port.get(), TIOCEXCL) != 0)
        refuse(error_kind::not_available, std::strerror(errno), port_hint);
    const auto* const rate = std::ranges::find(detail::baud_rates, baud, &detail::baud_rate::baud);
    if (rate == detail::baud_rates.end() || !set_rate(port.get(), rate->termios))
        refuse(error_kind::not_available, fmt::format("it does not support {} baud", baud),
               "use another baud");
    auto lines = std::make_unique<serial_port>(std::move(port));
    if (!lines->set(0))
        refuse(error_kind::not_available, std::strerror(errno), port_hint);
    return lines;
}

} // namespace tactor::study
