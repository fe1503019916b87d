// SPDX-License-Identifier: MIT
/// \file
/// A picture as a list of elements, in points (1/72 inch), y down; its colours, and the width of its texts.
/// to_svg(), to_png() and to_pdf() (output.hpp) write the same picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace tactor::plot {

/// A colour that stays distinct from the other colours here for colour-blind people and in black and white.
struct colour {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    double alpha = 1.0;

    friend bool operator==(const colour&, const colour&) = default;
};

inline constexpr colour black{0, 0, 0};
inline constexpr colour ink{34, 34, 34};
inline constexpr colour dark_grey{90, 90, 90};
inline constexpr colour grey{150, 150, 150};
inline constexpr colour light_grey{215, 215, 215};
inline constexpr colour white{255, 255, 255};

/// Colours of categories, from the palette of Okabe and Ito; they also differ in lightness.
inline constexpr colour blue{0, 114, 178};
inline constexpr colour orange{230, 159, 0};
inline constexpr colour vermilion{213, 94, 0};

/// Returns the colour of u in 0 ... 1 (clamped), from dark to light, evenly in grey too: the map "viridis" of
/// Smith and van der Walt without its lightest end, which is lost on white paper.
colour ordered(double u) noexcept;

/// Returns the same colour, translucent.
constexpr colour with_alpha(colour c, double alpha) noexcept
{
    c.alpha = alpha;
    return c;
}

/// Number of different colours of strokes.
inline constexpr std::size_t stroke_colours = 10;

/// Returns the colour of the n-th stroke, from 0; colours repeat after `stroke_colours`. Colour-blind people
/// can tell any two apart: they differ by more than 20 in CIELAB in the model of Machado et al. 2009.
colour stroke_colour(std::size_t n) noexcept;

/// A place on the page, pt.
struct spot {
    double x = 0.0;
    double y = 0.0;
};

/// A rectangle on the page, pt.
struct box {
    double x = 0.0;
    double y = 0.0;
    double width = 0.0;
    double height = 0.0;

    double right() const noexcept { return x + width; }
    double bottom() const noexcept { return y + height; }
};

inline constexpr double pt_per_mm = 72.0 / 25.4;
inline constexpr double margin = 5.0;       ///< margin of every figure, pt
inline constexpr double loop_pause_s = 0.8; ///< pause of an animated picture before it begins again

struct style {
    std::optional<colour> fill = {};
    std::optional<colour> stroke = {};
    double width = 0.5; ///< width of the line, pt
    double dash = 0.0;  ///< length of dashes and gaps, pt; 0: none
};

enum class align { start, middle, end };

struct text_style {
    double size = 6.5; ///< pt
    bool bold = false;
    align anchor = align::start;
    colour ink = black;
    bool halo = false;    ///< white rim, for text on lines
    bool upwards = false; ///< turned by a quarter, read from below
};

/// Description of an element for programs and screen readers: id, class, title and data-* attributes of SVG.
/// Only SVG has it.
struct mark {
    std::string id = {};
    std::string kind = {};
    std::string title = {};
    std::vector<std::pair<std::string, std::string>> data = {};
};

/// Part of an animated picture's loop in which an element is visible, and its way meanwhile. SVG only: the
/// other formats leave the element out.
struct animation {
    double from = 0.0;             ///< fraction of the loop, 0 to 1
    double to = 1.0;               ///< above `from`
    std::vector<spot> places = {}; ///< places at even intervals; empty: the element stays
};

namespace item {
struct group_begin {
    mark m;
};
struct group_end {};
struct line {
    spot from;
    spot to;
    style s;
    mark m;
};
struct poly {
    std::vector<spot> points;
    bool closed = false;
    style s;
    mark m;
};
struct rect {
    box b;
    style s;
    mark m;
};
struct circle {
    spot centre;
    double radius = 0.0;
    style s;
    mark m;
    std::optional<animation> moves;
};
struct text {
    spot at; ///< on the baseline
    std::string string;
    text_style s;
    mark m;
};
} // namespace item

/// A picture. Later elements lie on earlier ones.
struct canvas {
    using element = std::variant<item::group_begin, item::group_end, item::line, item::poly, item::rect,
                                 item::circle, item::text>;

    double width = 0.0;  ///< pt
    double height = 0.0; ///< pt
    double loop_s = 0.0; ///< loop of an animated picture with its pause; 0: it stands still
    std::string title = {};
    std::string description = {};
    std::vector<element> elements = {};

    void line(spot from, spot to, const style& s, mark m = {})
    {
        elements.emplace_back(item::line{from, to, s, std::move(m)});
    }
    void poly(std::vector<spot> points, bool closed, const style& s, mark m = {})
    {
        elements.emplace_back(item::poly{std::move(points), closed, s, std::move(m)});
    }
    void rect(box b, const style& s, mark m = {}) { elements.emplace_back(item::rect{b, s, std::move(m)}); }
    void circle(spot centre, double radius, const style& s, mark m = {})
    {
        elements.emplace_back(item::circle{centre, radius, s, std::move(m), {}});
    }
    void moving_circle(spot centre, double radius, const style& s, animation moves, mark m = {})
    {
        elements.emplace_back(item::circle{centre, radius, s, std::move(m), std::move(moves)});
    }
    void text(spot at, std::string string, const text_style& s, mark m = {})
    {
        elements.emplace_back(item::text{at, std::move(string), s, std::move(m)});
    }
};

/// A group that ends with its scope.
class group {
public:
    group(canvas& c, mark m) : canvas_(c) { c.elements.emplace_back(item::group_begin{std::move(m)}); }
    ~group() { canvas_.elements.emplace_back(item::group_end{}); }
    group(const group&) = delete;
    group& operator=(const group&) = delete;

private:
    canvas& canvas_;
};

/// The typeface of all pictures, in every format.
inline constexpr const char* typeface = "DejaVu Sans";

/// Returns the width in pt, from a table of that typeface: layout must not depend on the fonts of a machine.
double text_width(std::string_view utf8, double size, bool bold = false) noexcept;

/// Returns the height of digits and capitals, pt.
constexpr double cap_height(double size) noexcept
{
    return 0.73 * size;
}

/// Returns valid UTF-8 without control characters: U+FFFD replaces bytes that XML refuses.
std::string clean(std::string_view text);

/// Returns the text, or its beginning and an ellipsis if it is wider than `width` pt.
std::string shorten(std::string_view text, double size, double width, bool bold = false);

/// Returns lines of at most `width` pt, broken between words. Shortens the last of `most_lines`, and words
/// that are wider.
std::vector<std::string> wrap(std::string_view text, double size, double width, std::size_t most_lines);

/// Formats a number with at most `digits` significant digits and no trailing zeros, the same in every locale.
std::string number(double v, int digits = 4);

} // namespace tactor::plot
