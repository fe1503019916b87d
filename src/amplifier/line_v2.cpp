// SPDX-License-Identifier: MIT
// libgpiod 2 (Debian 13).
#include "amplifier/line.hpp"

#include <array>
#include <cerrno>
#include <filesystem>
#include <span>

#include <fcntl.h>
#include <gpiod.h>

#include "core/owned.hpp"

namespace tactor::amplifier {
namespace {

using detail::deleter;

using chip_handle = std::unique_ptr<gpiod_chip, deleter<gpiod_chip_close>>;
using chip_data = std::unique_ptr<gpiod_chip_info, deleter<gpiod_chip_info_free>>;
using line_data = std::unique_ptr<gpiod_line_info, deleter<gpiod_line_info_free>>;
using settings_handle = std::unique_ptr<gpiod_line_settings, deleter<gpiod_line_settings_free>>;
using line_config = std::unique_ptr<gpiod_line_config, deleter<gpiod_line_config_free>>;
using request_config = std::unique_ptr<gpiod_request_config, deleter<gpiod_request_config_free>>;
using request_handle = std::unique_ptr<gpiod_line_request, deleter<gpiod_line_request_release>>;
using event_buffer = std::unique_ptr<gpiod_edge_event_buffer, deleter<gpiod_edge_event_buffer_free>>;

gpio_line_info describe(gpiod_line_info* l)
{
    gpio_line_info out;
    out.offset = gpiod_line_info_get_offset(l);
    out.name = text(gpiod_line_info_get_name(l));
    out.consumer = text(gpiod_line_info_get_consumer(l));
    if (out.consumer.empty() && gpiod_line_info_is_used(l))
        out.consumer = nameless_consumer;
    out.output = gpiod_line_info_get_direction(l) == GPIOD_LINE_DIRECTION_OUTPUT;
    return out;
}

class output_line final : public output {
public:
    output_line(request_handle r, unsigned offset) : request_(std::move(r)), offset_(offset) {}
    bool set(bool on) noexcept override
    {
        return gpiod_line_request_set_value(request_.get(), offset_,
                                            on ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
    }
    int descriptor() const noexcept override { return gpiod_line_request_get_fd(request_.get()); }

private:
    request_handle request_;
    unsigned offset_;
};

class bulk_lines final : public code_lines {
public:
    explicit bulk_lines(request_handle r) : request_(std::move(r)) {}
    bool set(unsigned number) noexcept override
    {
        std::array<gpiod_line_value, most_code_lines> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = (number >> i & 1) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
        return gpiod_line_request_set_values(request_.get(), values.data()) == 0;
    }

private:
    request_handle request_;
};

class input_line final : public edge_input {
public:
    input_line(request_handle r, event_buffer b) : request_(std::move(r)), buffer_(std::move(b)) {}
    int descriptor() const noexcept override { return gpiod_line_request_get_fd(request_.get()); }
    // Reads one event at a time, because further events must keep the descriptor readable.
    std::optional<gpio_edge> read() noexcept override
    {
        if (gpiod_line_request_read_edge_events(request_.get(), buffer_.get(), 1) != 1)
            return std::nullopt;
        gpiod_edge_event* e = gpiod_edge_event_buffer_get_event(buffer_.get(), 0);
        return gpio_edge{static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(e)),
                         gpiod_edge_event_get_event_type(e) == GPIOD_EDGE_EVENT_RISING_EDGE};
    }

private:
    request_handle request_;
    event_buffer buffer_;
};

gpiod_line_bias to_gpiod(pull_kind p) noexcept
{
    switch (p) {
    case pull_kind::none:
        return GPIOD_LINE_BIAS_DISABLED;
    case pull_kind::up:
        return GPIOD_LINE_BIAS_PULL_UP;
    case pull_kind::down:
        return GPIOD_LINE_BIAS_PULL_DOWN;
    case pull_kind::as_is:
        break;
    }
    return GPIOD_LINE_BIAS_AS_IS;
}

gpiod_line_edge to_gpiod(edge_kind e) noexcept
{
    switch (e) {
    case edge_kind::rising:
        return GPIOD_LINE_EDGE_RISING;
    case edge_kind::falling:
        return GPIOD_LINE_EDGE_FALLING;
    case edge_kind::both:
        break;
    }
    return GPIOD_LINE_EDGE_BOTH;
}

// Returns null and sets errno if there is no such line or it is not available.
request_handle request(const std::string& path, std::span<const unsigned> offsets, gpiod_line_settings* s)
{
    errno = 0;
    const chip_handle c(gpiod_chip_open(path.c_str()));
    const line_config lines(gpiod_line_config_new());
    const request_config by(gpiod_request_config_new());
    if (!c || !lines || !by ||
        gpiod_line_config_add_line_settings(lines.get(), offsets.data(), offsets.size(), s) != 0)
        return nullptr;
    gpiod_request_config_set_consumer(by.get(), consumer);
    return request_handle(gpiod_chip_request_lines(c.get(), by.get(), lines.get()));
}

// Requests outputs, which are off at first. Returns null and sets errno on failure.
request_handle request_outputs(const std::string& path, std::span<const unsigned> offsets, bool active_low)
{
    errno = ENOMEM;
    const settings_handle s(gpiod_line_settings_new());
    if (!s)
        return nullptr;
    gpiod_line_settings_set_direction(s.get(), GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_active_low(s.get(), active_low);
    gpiod_line_settings_set_output_value(s.get(), GPIOD_LINE_VALUE_INACTIVE);
    return request(path, offsets, s.get());
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
    const chip_data data(c ? gpiod_chip_get_info(c.get()) : nullptr);
    if (!data) {
        out.code = last_error_code();
        return out;
    }
    out.info.name = text(gpiod_chip_info_get_name(data.get()));
    out.info.label = text(gpiod_chip_info_get_label(data.get()));
    const std::size_t n = gpiod_chip_info_get_num_lines(data.get());
    for (unsigned i = 0; i < n; ++i) {
        const line_data l(gpiod_chip_get_line_info(c.get(), i));
        out.info.lines.push_back(l ? describe(l.get()) : gpio_line_info{.offset = i});
    }
    return out;
}

requested<output> request_output(const output_request& r)
{
    request_handle h = request_outputs(r.path, {&r.offset, 1}, r.active_low);
    if (!h)
        return {nullptr, last_error_code()};
    return {std::make_unique<output_line>(std::move(h), r.offset), 0};
}

requested<code_lines> request_code_lines(const std::string& path, const std::vector<unsigned>& offsets)
{
    request_handle h = request_outputs(path, offsets, false);
    if (!h)
        return {nullptr, last_error_code()};
    return {std::make_unique<bulk_lines>(std::move(h)), 0};
}

requested<edge_input> request_input(const input_request& r)
{
    const settings_handle s(gpiod_line_settings_new());
    event_buffer buffer(gpiod_edge_event_buffer_new(1));
    if (!s || !buffer)
        return {nullptr, ENOMEM};
    gpiod_line_settings_set_direction(s.get(), GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_edge_detection(s.get(), to_gpiod(r.edge));
    gpiod_line_settings_set_bias(s.get(), to_gpiod(r.bias));
    gpiod_line_settings_set_event_clock(s.get(), GPIOD_LINE_CLOCK_MONOTONIC);
    request_handle h = request(r.path, {&r.offset, 1}, s.get());
    if (!h)
        return {nullptr, last_error_code()};
    // Does not use the kernel's debouncing, which stamps an edge when the line has settled, not when the edge
    // came.
    const int fd = gpiod_line_request_get_fd(h.get());
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
    return {std::make_unique<input_line>(std::move(h), std::move(buffer)), 0};
}

} // namespace tactor::amplifier
