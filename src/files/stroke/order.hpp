// SPDX-License-Identifier: MIT
// In which order the strokes of a TOML file come, how often, and from when their starts count.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

inline constexpr std::array<std::string_view, 3> order_keys{"repeat", "pause_s", "start_from"};

/// More are the wrong file, or a slip in `repeat`.
inline constexpr std::size_t most_strokes = 100'000;

/// Strokes that are one entry of the file: their starts count from one another, and the first's is the
/// entry's.
struct entry {
    std::vector<stroke> strokes = {};
    double lead_s = 0.0; ///< from the entry's start to that of its first stroke
};

/// Strokes one after the other as the keys start_s and start_from of their tables say.
class sequence {
public:
    /// Of a group, whose strokes count from its start, or of the whole piece.
    enum class of { group, piece };
    explicit sequence(of what) noexcept : whole_piece_(what == of::piece) {}

    /// Adds what table `t` says. \throws error with file, line and column.
    void add(const toml_table& t, entry e);

    entry take() && { return std::move(all_); }

private:
    struct last_entry {
        std::size_t size = 0;
        double lead_s = 0.0;
    };

    void place_first(const toml_table& t, stroke& first, double lead_s);
    void place(const toml_table& t, stroke& first, double lead_s) const;

    bool whole_piece_;
    entry all_;
    last_entry before_;
};

/// The entry as often as `repeat` says, with `pause_s` between.
entry repeated(const toml_table& t, entry e);

} // namespace tactor::detail
