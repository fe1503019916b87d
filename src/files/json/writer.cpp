// SPDX-License-Identifier: MIT
#include "files/json/writer.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace tactor::files {

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

void append_text(std::string& out, std::string_view text)
{
    out += nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void json_writer::begin(const char* name)
{
    if (!std::exchange(first_, false))
        out_ += ',';
    if (std::exchange(next_line_, false))
        out_ += '\n';
    out_ += '"';
    out_ += name;
    out_ += "\":";
}

} // namespace tactor::files
