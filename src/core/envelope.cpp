// SPDX-License-Identifier: MIT
#include <tactor/waveform.hpp>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/kind_table.hpp"
#include "core/path/number.hpp"
#include "core/refused.hpp"

namespace tactor {
inline namespace v0 {

TACTOR_KIND_NAMES(envelope_kind, "envelope", {raised_cosine, "raised-cosine"}, {linear, "linear"},
                  {exponential, "exponential"}, {tukey, "tukey"});

burst_envelope parse_envelope(std::string_view text)
{
    const std::size_t colon = text.find(':');
    burst_envelope e;
    e.kind = from_string<envelope_kind>(text.substr(0, colon));
    if (colon == std::string_view::npos)
        return e;
    std::size_t at = colon + 1;
    const auto part = detail::scan_number(text, at);
    if (e.kind != envelope_kind::tukey || !part || at != text.size() || !(*part >= 0.0 && *part <= 1.0))
        throw detail::bad_field("envelope", fmt::format("\"{}\" is not known", text),
                                "only tukey has a part, 0 to 1, as tukey:0.5");
    e.tukey_part = *part;
    return e;
}

std::string envelope_text(const burst_envelope& e)
{
    if (e.kind == envelope_kind::tukey)
        return fmt::format("tukey:{}", e.tukey_part);
    return std::string(to_string(e.kind));
}

} // namespace v0
} // namespace tactor
