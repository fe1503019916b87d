// SPDX-License-Identifier: MIT
/// \file
/// The part of libgpiod that this folder needs, for any version. Meson chooses line_v1.cpp or line_v2.cpp, or
/// line_none.cpp if there is no libgpiod.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactor/lines.hpp>

namespace tactor::amplifier {

/// Consumer name of tactor's lines, which other programs see.
inline constexpr const char* consumer = "tactor";
/// Consumer name of a line in use whose consumer gave no name.
inline constexpr const char* nameless_consumer = "kernel";

/// Returns a name from the library as text; null becomes empty.
inline std::string text(const char* s)
{
    return s ? s : "";
}

/// Returns the errno of libgpiod's last failure. libgpiod sets errno on each failure.
inline int last_error_code() noexcept
{
    return errno != 0 ? errno : EIO;
}

/// A chip and its lines.
struct chip {
    gpio_chip_info info = {};
    int code = 0;           ///< errno of opening the chip; 0 if it was opened
    std::string group = {}; ///< group of its device node, set only if opening failed
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

/// An output of this process, off from the moment of the request. The destructor releases it, but does not
/// switch it.
class output {
public:
    virtual ~output() = default;
    /// Switches by one ioctl. Does not allocate or lock, so a forked process may call it.
    virtual bool set(bool on) noexcept = 0;
    /// Returns the descriptor of the request, or -1 if it is not known. A process that has this descriptor
    /// open owns the line.
    virtual int descriptor() const noexcept = 0;
};

inline constexpr std::size_t most_code_lines = 8;

/// Outputs of one chip that show a number together, off from the moment of the request.
class code_lines {
public:
    virtual ~code_lines() = default;
    /// Switches all lines by one ioctl; the first one shows the least significant bit. Does not allocate.
    virtual bool set(unsigned number) noexcept = 0;
};

/// A line, or the errno of the refusal.
template <typename T>
struct requested {
    std::unique_ptr<T> line;
    int code = 0;
};

/// Returns true if this build contains libgpiod.
bool built_in() noexcept;
/// Reads a chip, except its group. A chip that cannot be opened is not an error.
chip read_chip(const std::string& path);
/// Requests an output. One ioctl sets direction and value, so the line goes off without a glitch.
requested<output> request_output(const output_request& r);
/// Requests outputs of one chip by one ioctl, all off.
requested<code_lines> request_code_lines(const std::string& path, const std::vector<unsigned>& offsets);
/// Requests outputs that a user named, as request_code_lines() does. `where`: place of the lines in a file.
/// Throws as open_output().
std::unique_ptr<code_lines> open_code_lines(const std::string& chip, const std::vector<unsigned>& offsets,
                                            const source_place& where);
/// Requests an input that delivers every edge that the kernel sees, without debouncing.
requested<edge_input> request_input(const input_request& r);

/// Filter of contact bounce that uses the time stamps of the edges. It drops each edge that follows another
/// edge within the window, even a dropped one. So the first edge of a bounce passes with its own time stamp,
/// and the rest is dropped, however long the bounce lasts.
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

} // namespace tactor::amplifier
