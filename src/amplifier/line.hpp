// SPDX-License-Identifier: MIT
/// \file
/// What this folder needs of libgpiod, whichever version: line_v1.cpp or line_v2.cpp, chosen by Meson,
/// or line_none.cpp where there is none.
#pragma once

#include <cerrno>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <tactor/lines.hpp>

namespace tactor::gpio {

/// What other programs see as the holder of our lines.
inline constexpr const char* consumer = "tactor";
/// Stands for the consumer of a line in use whose consumer has no name.
inline constexpr const char* nameless_consumer = "kernel";

/// A name that the library gives; it gives null for none.
inline std::string text(const char* s)
{
    return s ? s : "";
}

/// Why libgpiod returned nothing: it sets errno wherever it does so.
inline int failure() noexcept
{
    return errno != 0 ? errno : EIO;
}

/// A chip and what is on it.
struct chip {
    gpio_chip_info info = {};
    int code = 0;           ///< errno of opening it; 0: it could be opened
    std::string group = {}; ///< that its device node belongs to, said only where opening failed
};

struct output_request {
    std::string path;
    unsigned offset = 0;
    bool active_low = false;
};

struct input_request {
    std::string path;
    unsigned offset = 0;
    edge_kind edge = edge_kind::both;
    pull_kind bias = pull_kind::as_is;
};

/// An output of this process, off from the moment of the request. Released, but not switched, when
/// destroyed.
class output {
public:
    virtual ~output() = default;
    /// One ioctl; neither allocates nor locks, so a forked process may call it.
    virtual bool set(bool on) noexcept = 0;
    /// Descriptor of the request; a process that has it open has the line. -1 when it could not be found out.
    virtual int descriptor() const noexcept = 0;
};

/// A line, or the errno of why there is none.
template <typename T>
struct requested {
    std::unique_ptr<T> line;
    int code = 0;
};

/// Whether this build has a libgpiod.
bool built_in() noexcept;
/// All but the group. A chip that cannot be opened is not an error.
chip read_chip(const std::string& path);
/// Direction and value in one ioctl, so the line goes from what it was to off without a glitch.
requested<output> request_output(const output_request& r);
/// Every edge that the kernel saw, not debounced.
requested<edge_input> request_input(const input_request& r);

/// A filter of contact bounce by the edges' own time stamps. Drops every edge that follows another, dropped
/// or not, within the window: the first edge of a burst passes at its own time and the rest of the burst does
/// not, however long it lasts.
class debounce {
public:
    explicit debounce(std::int64_t window_ns) : window_ns_(window_ns) {}

    bool accepts(std::int64_t time_ns) noexcept
    {
        const bool apart = !last_ns_ || time_ns - *last_ns_ >= window_ns_;
        last_ns_ = time_ns;
        return apart;
    }

private:
    std::int64_t window_ns_;
    std::optional<std::int64_t> last_ns_ = {};
};

} // namespace tactor::gpio
