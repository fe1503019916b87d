// SPDX-License-Identifier: MIT
// SVG path data, the d attribute (https://www.w3.org/TR/SVG2/paths.html), and what its commands draw.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/path/outline.hpp"

namespace tactor::detail {

/// Returns 'M' for 'm'. A character that is not a letter never becomes one.
constexpr char upper(char c) noexcept
{
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

/// Arguments of one command, as many as it has. Flags are 0 or 1.
using path_arguments = std::array<double, 7>;

class path_pen {
public:
    /// Draws one of M L H V C S Q T A. Lower case counts from the place of the pen.
    void draw(char command, const path_arguments& v);

    /// Draws Z: a line to the start of the subpath. A command that follows without a move begins there, too.
    void close();

    /// Returns the subpaths that were drawn, and forgets them.
    std::vector<outline> take();

    /// Returns the place of the last move.
    point start() const { return start_; }

private:
    void move(point to);
    void line(point to);
    void cubic(point c1, point c2, point to);
    void quadratic(point c, point to);
    void arc(const path_arguments& v, point to);
    void arrive(point to);
    void finish();

    std::vector<outline> drawn_;
    outline open_;
    bool draws_ = false; ///< something was drawn since the last move
    point start_;
    point at_;
    // The mirrored last handle, if the last command was of the kind that S or T continues.
    point cubic_handle_;
    point quadratic_handle_;
};

/// Allowed subpaths of path data: with `one`, a second is a fault.
enum class subpaths { one, any };

/// Returns the subpaths that draw something, in user units. Skips moves that nothing follows. A number beyond
/// `limit` is a fault.
/// \throws value_fault at the first place that is not path data.
std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted);

} // namespace tactor::detail
