// SPDX-License-Identifier: MIT
// The public functions of this folder, but for the list of chips.
#include <tactor/gpio.hpp>

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "gpio/chips.hpp"
#include "gpio/debounce.hpp"
#include "gpio/errors.hpp"
#include "gpio/holder.hpp"
#include "gpio/line.hpp"

namespace tactor::gpio {
namespace {

class own_output final : public enable_line {
public:
    explicit own_output(std::unique_ptr<output> line) : line_(std::move(line)) {}
    ~own_output() override { line_->set(false); }
    own_output(const own_output&) = delete;
    own_output& operator=(const own_output&) = delete;
    bool set(bool on) noexcept override { return line_->set(on); }

private:
    std::unique_ptr<output> line_;
};

class debounced_input final : public edge_input {
public:
    debounced_input(std::unique_ptr<edge_input> raw, debounce filter) : raw_(std::move(raw)), filter_(filter)
    {
    }
    int descriptor() const noexcept override { return raw_->descriptor(); }
    std::optional<gpio_edge> read() noexcept override
    {
        while (const auto e = raw_->read())
            if (filter_.accepts(e->time_ns))
                return e;
        return std::nullopt;
    }

private:
    std::unique_ptr<edge_input> raw_;
    debounce filter_;
};

template <typename T>
std::unique_ptr<T> take(requested<T> r, const gpio_line_name& wanted, const located_line& at)
{
    if (!r.line)
        throw request_error(wanted, r.code, holder_of(at));
    return std::move(r.line);
}

template <typename T, std::size_t N>
T choose(const gpio_line_name& line, const char* what, const std::string& word,
         const std::array<std::pair<const char*, T>, N>& choices)
{
    std::string known;
    for (const auto& [name, value] : choices) {
        if (word == name)
            return value;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw error(errc::bad_input, thing(line), fmt::format("{} \"{}\" is unknown", what, word),
                fmt::format("known: {}", known));
}

constexpr std::array<std::pair<const char*, edges>, 3> edge_words{
    {{"rising", edges::rising}, {"falling", edges::falling}, {"both", edges::both}}};
constexpr std::array<std::pair<const char*, pull>, 4> pull_words{
    {{"up", pull::up}, {"down", pull::down}, {"none", pull::none}, {"as-is", pull::as_is}}};

constexpr double longest_debounce_ms = 10000.0;

debounce make_debounce(const gpio_line_name& line, double ms)
{
    if (!(ms >= 0.0 && ms <= longest_debounce_ms))
        throw error(errc::bad_input, thing(line), fmt::format("a debounce time of {} ms", ms),
                    fmt::format("0 to {}", longest_debounce_ms));
    return debounce(std::llround(ms * 1e6));
}

bool set_output(void* line, bool on) noexcept
{
    return static_cast<output*>(line)->set(on);
}

} // namespace
} // namespace tactor::gpio

namespace tactor {

using namespace gpio;

enable_line::~enable_line() = default;
edge_input::~edge_input() = default;

std::unique_ptr<enable_line> open_amplifier(const amplifier_settings& s)
{
    const located_line at = locate(s.line);
    const output_request request{at.path, at.offset, s.active_low};
    // Requested here, where errors have words and libgpiod may allocate; the holder inherits the request and
    // has it alone once this copy is given up.
    const std::unique_ptr<output> line = take(request_output(request), s.line, at);
    const auto rescue = [request] { return request_output(request).line != nullptr; };
    return start_holder({&set_output, line.get(), {line->descriptor()}}, rescue);
}

std::unique_ptr<enable_line> open_output(const gpio_line_name& line, bool active_low)
{
    const located_line at = locate(line);
    return std::make_unique<own_output>(take(request_output({at.path, at.offset, active_low}), line, at));
}

std::unique_ptr<edge_input> open_edges(const gpio_line_name& line, const std::string& edge,
                                       double debounce_ms, const std::string& pull)
{
    input_request request;
    request.edge = choose(line, "edge", edge, edge_words);
    request.bias = choose(line, "pull", pull, pull_words);
    const debounce filter = make_debounce(line, debounce_ms);
    const located_line at = locate(line);
    request.path = at.path;
    request.offset = at.offset;
    return std::make_unique<debounced_input>(take(request_input(request), line, at), filter);
}

} // namespace tactor
