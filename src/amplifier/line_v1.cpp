// SPDX-License-Identifier: MIT
// libgpiod 1.6 (Debian 12).
#include "amplifier/line.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <mutex>

#include <fcntl.h>
#include <gpiod.h>

#include "core/owned.hpp"
#include "rt/clock.hpp"
#include "rt/system_files.hpp"

namespace tactor::amplifier {
namespace {

/// Owner of a chip. Closing the chip also releases its lines.
using chip_handle = std::unique_ptr<gpiod_chip, detail::deleter<gpiod_chip_close>>;

gpio_line_info describe(gpiod_line* l)
{
    gpio_line_info out;
    out.offset = gpiod_line_offset(l);
    out.name = text(gpiod_line_name(l));
    out.consumer = text(gpiod_line_consumer(l));
    if (out.consumer.empty() && gpiod_line_is_used(l))
        out.consumer = nameless_consumer;
    out.output = gpiod_line_direction(l) == GPIOD_LINE_DIRECTION_OUTPUT;
    return out;
}

/// Returns the descriptors of this process that are requests of outputs. Empty if /proc is not mounted.
std::vector<int> output_descriptors()
{
    std::vector<int> found;
    std::error_code ignored;
    for (const std::string& name : rt::read_folder_names("/proc/self/fd")) {
        int fd = -1;
        std::from_chars(name.data(), name.data() + name.size(), fd);
        if (std::filesystem::read_symlink("/proc/self/fd/" + name, ignored) == "anon_inode:gpio-linehandle")
            found.push_back(fd);
    }
    return found;
}

class output_line final : public output {
public:
    output_line(chip_handle c, gpiod_line* l, int fd) : chip_(std::move(c)), line_(l), fd_(fd) {}
    bool set(bool on) noexcept override { return gpiod_line_set_value(line_, on ? 1 : 0) == 0; }
    int descriptor() const noexcept override { return fd_; }

private:
    chip_handle chip_;
    gpiod_line* line_;
    int fd_;
};

class bulk_lines final : public code_lines {
public:
    bulk_lines(chip_handle c, const gpiod_line_bulk& l) : chip_(std::move(c)), lines_(l) {}
    bool set(unsigned number) noexcept override
    {
        std::array<int, most_code_lines> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<int>(number >> i & 1);
        return gpiod_line_set_value_bulk(&lines_, values.data()) == 0;
    }

private:
    chip_handle chip_;
    gpiod_line_bulk lines_;
};

class input_line final : public edge_input {
public:
    input_line(chip_handle c, int fd) : chip_(std::move(c)), fd_(fd) {}
    int descriptor() const noexcept override { return fd_; }
    std::optional<gpio_edge> read() noexcept override
    {
        gpiod_line_event e{};
        if (gpiod_line_event_read_fd(fd_, &e) != 0)
            return std::nullopt;
        return gpio_edge{rt::to_ns(e.ts), e.event_type == GPIOD_LINE_EVENT_RISING_EDGE};
    }

private:
    chip_handle chip_;
    int fd_;
};

int bias_flag(pull_kind p) noexcept
{
    switch (p) {
    case pull_kind::none:
        return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case pull_kind::up:
        return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case pull_kind::down:
        return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case pull_kind::as_is:
        break;
    }
    return 0;
}

int event_type(edge_kind e) noexcept
{
    switch (e) {
    case edge_kind::rising:
        return GPIOD_LINE_REQUEST_EVENT_RISING_EDGE;
    case edge_kind::falling:
        return GPIOD_LINE_REQUEST_EVENT_FALLING_EDGE;
    case edge_kind::both:
        break;
    }
    return GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
}

/// Requests an output. Finds its descriptor, which the library hides: the only descriptor that is new.
int request_output_descriptor(gpiod_line* l, int flags, int& fd)
{
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const std::vector<int> before = output_descriptors();
    const int rc = gpiod_line_request_output_flags(l, consumer, flags, 0);
    const int code = errno;
    for (const int now : output_descriptors())
        if (std::find(before.begin(), before.end(), now) == before.end())
            fd = now;
    errno = code;
    return rc;
}

} // namespace

bool built_in() noexcept
{
    return true;
}

chip read_chip(const std::string& path)
{
    chip out;
    out.info.path = path;
    out.info.name = std::filesystem::path(path).filename().string();
    errno = 0;
    const chip_handle c(gpiod_chip_open(path.c_str()));
    if (!c) {
        out.code = last_error_code();
        return out;
    }
    out.info.name = text(gpiod_chip_name(c.get()));
    out.info.label = text(gpiod_chip_label(c.get()));
    for (unsigned i = 0; i < gpiod_chip_num_lines(c.get()); ++i) {
        gpiod_line* l = gpiod_chip_get_line(c.get(), i);
        out.info.lines.push_back(l ? describe(l) : gpio_line_info{.offset = i});
    }
    return out;
}

requested<output> request_output(const output_request& r)
{
    errno = 0;
    chip_handle c(gpiod_chip_open(r.path.c_str()));
    gpiod_line* l = c ? gpiod_chip_get_line(c.get(), r.offset) : nullptr;
    int fd = -1;
    if (!l || request_output_descriptor(l, r.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0, fd) != 0)
        return {nullptr, last_error_code()};
    return {std::make_unique<output_line>(std::move(c), l, fd), 0};
}

requested<code_lines> request_code_lines(const std::string& path, const std::vector<unsigned>& offsets)
{
    errno = 0;
    chip_handle c(gpiod_chip_open(path.c_str()));
    std::vector<unsigned> own = offsets; // the library takes them as mutable, but does not write to them
    const std::array<int, most_code_lines> off{};
    gpiod_line_bulk lines{};
    if (!c || gpiod_chip_get_lines(c.get(), own.data(), static_cast<unsigned>(own.size()), &lines) != 0 ||
        gpiod_line_request_bulk_output(&lines, consumer, off.data()) != 0)
        return {nullptr, last_error_code()};
    return {std::make_unique<bulk_lines>(std::move(c), lines), 0};
}

requested<edge_input> request_input(const input_request& r)
{
    errno = 0;
    chip_handle c(gpiod_chip_open(r.path.c_str()));
    gpiod_line* l = c ? gpiod_chip_get_line(c.get(), r.offset) : nullptr;
    const gpiod_line_request_config config{consumer, event_type(r.edge), bias_flag(r.bias)};
    if (!l || gpiod_line_request(l, &config, 0) != 0)
        return {nullptr, last_error_code()};
    // Edges have time stamps of CLOCK_MONOTONIC since Linux 5.7, of CLOCK_REALTIME before.
    const int fd = gpiod_line_event_get_fd(l);
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
    return {std::make_unique<input_line>(std::move(c), fd), 0};
}

} // namespace tactor::amplifier
