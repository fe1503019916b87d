// SPDX-License-Identifier: MIT
// Public functions of this folder, except the list of chips.
#include <tactor/lines.hpp>

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "amplifier/chips.hpp"
#include "amplifier/holder.hpp"
#include "amplifier/line.hpp"
#include "core/refused.hpp"

namespace tactor::amplifier {
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
std::unique_ptr<T> take(requested<T> r, const gpio_line_name& wanted, const gpio_line_place& at)
{
    if (!r.line)
        detail::throw_with_cause(request_error(wanted, r.code, find_holder(at)), r.code);
    return std::move(r.line);
}

constexpr double longest_debounce_s = 10.0;

debounce make_debounce(const gpio_line_name& line, double seconds)
{
    if (!(seconds >= 0.0 && seconds <= longest_debounce_s))
        throw error(error_kind::bad_input, describe_line(line),
                    fmt::format("a debounce time of {} s is out of range", seconds),
                    fmt::format("give 0 to {} s", longest_debounce_s))
            .with_field("debounce_s");
    return debounce(std::llround(seconds * 1e9));
}

bool set_output(void* line, bool on) noexcept
{
    return static_cast<output*>(line)->set(on);
}

} // namespace

std::unique_ptr<code_lines> open_code_lines(const std::string& chip, const std::vector<unsigned>& offsets,
                                            const source_place& where)
{
    gpio_line_name wanted{.chip = chip, .where = where};
    gpio_line_place at;
    for (const unsigned offset : offsets) {
        wanted.offset = offset;
        at = look_up(wanted);
        if (!at.line.consumer.empty()) // a request for all lines does not report which one is busy
            break;
    }
    return take(request_code_lines(at.path, offsets), wanted, at);
}

} // namespace tactor::amplifier

namespace tactor {
inline namespace v0 {

using namespace amplifier;

enable_line::~enable_line() = default;
edge_input::~edge_input() = default;

std::unique_ptr<enable_line> open_amplifier(const amplifier_settings& s)
{
    const gpio_line_place at = look_up(s.line);
    const output_request request{at.path, at.line.offset, s.active_low};
    // This process requests the line, because it can report errors and libgpiod may allocate here. The holder
    // inherits the request, and owns it alone once this copy is released.
    const std::unique_ptr<output> line = take(request_output(request), s.line, at);
    const auto rescue = [request] { return request_output(request).line != nullptr; };
    return start_holder({&set_output, line.get(), {line->descriptor()}}, rescue);
}

std::unique_ptr<enable_line> open_output(const gpio_line_name& line, bool active_low)
{
    const gpio_line_place at = look_up(line);
    return std::make_unique<own_output>(
        take(request_output({at.path, at.line.offset, active_low}), line, at));
}

std::unique_ptr<edge_input> open_edges(const gpio_line_name& line, edge_kind edge, double debounce_s,
                                       pull_kind pull)
{
    const debounce filter = make_debounce(line, debounce_s);
    const gpio_line_place at = look_up(line);
    return std::make_unique<debounced_input>(
        take(request_input({at.path, at.line.offset, edge, pull}), line, at), filter);
}

} // namespace v0
} // namespace tactor
