// SPDX-License-Identifier: MIT
/// \file
/// How bursts rise and fall.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

/// How a burst rises and falls: like half a cycle of a cosine, by a straight line, or by an exponential that
/// ends after five of its time constants. `tukey` is raised_cosine with ramps that are a part of the burst.
enum class envelope_kind { raised_cosine, linear, exponential, tukey };
TACTOR_KIND(envelope_kind);

/// The envelope of every burst, and of a continuous stroke as a whole. Where both ramps do not fit, they are
/// shortened in the same ratio.
struct burst_envelope {
    envelope_kind kind = envelope_kind::raised_cosine;
    std::optional<double> attack_s = {};  ///< s, from 0; none: render_options::ramp_s
    std::optional<double> release_s = {}; ///< s, from 0; none: render_options::ramp_s
    double tukey_part = 0.5; ///< tukey: part of the burst in both ramps, 0 to 1; in place of other ramps

    friend bool operator==(const burst_envelope&, const burst_envelope&) = default;
};

/// The name of a kind, or "tukey:PART". The ramps are not set. \throws error (bad_input).
[[nodiscard]] TACTOR_API burst_envelope parse_envelope(std::string_view text);

/// The text that parse_envelope() takes; it does not have the ramps.
[[nodiscard]] TACTOR_API std::string envelope_text(const burst_envelope& e);

} // namespace v0
} // namespace tactor
