// SPDX-License-Identifier: MIT
#include "files/plan/row_json.hpp"

#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tactor::files {
namespace {

// Numbers as nlohmann-json writes them, so that rows read like heads: 1.0, not 1.
void append_number(std::string& out, double v)
{
    if (!std::isfinite(v)) {
        out += "null";
        return;
    }
    std::array<char, 64> digits;
    const char* end = nlohmann::detail::to_chars(digits.data(), digits.data() + digits.size(), v);
    out.append(static_cast<const char*>(digits.data()), end);
}

} // namespace

void number_member::append(std::string& out, double v)
{
    const auto bits = std::bit_cast<std::uint64_t>(v);
    if (bits_ != bits) {
        text_.resize(before_);
        append_number(text_, v);
        bits_ = bits;
    }
    out += text_;
}

void row_json::append(std::string& out, const burst& b, double ramp_s)
{
    onset_.append(out, b.onset_s);
    duration_.append(out, b.duration_s);
    ramp_.append(out, ramp_s);
    append_rest(out, b);
}

void row_json::append_sample(std::string& out, const burst& b)
{
    time_.append(out, b.onset_s);
    append_rest(out, b);
}

void row_json::append_rest(std::string& out, const burst& b)
{
    if (b.tau_s)
        tau_.append(out, *b.tau_s);
    x_.append(out, b.position.x_mm);
    y_.append(out, b.position.y_mm);
    intensity_.append(out, b.intensity);
    out += ",\"drives\":[";
    bool first = true;
    for (const drive& d : b.drives) {
        std::string& tactor = tactors_[d.tactor];
        if (tactor.empty())
            tactor = fmt::format("{{\"tactor\":{},\"channel\":{},\"amplitude\":", d.tactor,
                                 array_.tactors[d.tactor].channel);
        if (!first)
            out += ',';
        first = false;
        out += tactor;
        append_number(out, d.amplitude);
        out += '}';
    }
    out += "]}";
}

} // namespace tactor::files
