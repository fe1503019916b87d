// SPDX-License-Identifier: MIT
/// \file
/// A picture as a list of elements. Coordinates are in points (1/72 inch), and y points down. This file also
/// has colours and the widths of texts. to_svg(), to_png() and to_pdf() in output.hpp write the same picture.
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

/// A colour. The colours in this file can be distinguished by colour-blind people and in black and white.
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

/// Colours of categories, from the palette of Okabe and Ito. They also differ in lightness.
inline constexpr colour blue{0, 114, 178};
inline constexpr colour orange{230, 159, 0};
inline constexpr colour vermilion{213, 94, 0};

/// Returns a colour for u from 0 (dark) to 1 (light). Clamps u. The lightness changes evenly, also in grey.
/// This is the colour map "viridis" of Smith and van der Walt without its lightest colours, which are not
/// visible on white paper.
colour map_to_colour(double u) noexcept;

/// Returns the colour with another opacity.
constexpr colour with_alpha(colour c, double alpha) noexcept
{
    c.alpha = alpha;
    return c;
}

/// Number of colours for strokes.
inline constexpr std::size_t stroke_colours = 10;

/// Returns the colour of stroke n, which counts from 0. After `stroke_colours` strokes, the colours repeat.
/// Colour-blind people can distinguish any two of them: they differ by more than 20 in CIELAB in the model of
/// Machado et al. 2009.
colour stroke_colour(std::size_t n) noexcept;

/// A point on the page, pt.
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
inline constexpr double loop_pause_s = 0.8; ///< pause between two loops of an animated picture

struct style {
    std::optional<colour> fill = {};
    std::optional<colour> stroke = {};
    double width = 0.5; ///< width of the line, pt
    double dash = 0.0;  ///< length of dashes and of gaps, pt; 0 for a solid line
};

enum class align { start, middle, end };

struct text_style {
    double size = 6.5; ///< pt
    bool bold = false;
    align anchor = align::start;
    colour ink = black;
    bool halo = false;    ///< true for a white rim, which makes text on lines legible
    bool upwards = false; ///< true if the text runs from bottom to top
};

/// Description of an element for programs and screen readers. In SVG it becomes id, class, title and data-*
/// attributes. The other formats do not have it.
struct mark {
    std::string id = {};
    std::string kind = {};
    std::string title = {};
    std::vector<std::pair<std::string, std::string>> data = {};
};

/// The part of an animated picture's loop in which an element is visible, and the path of the element in this
/// time. Only in SVG: the other formats leave the element out.
struct animation {
    double from = 0.0;             ///< fraction of the loop, 0 to 1
    double to = 1.0;               ///< above `from`
    std::vector<spot> places = {}; ///< places at regular times; empty if the element stays
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
    spot at; ///< point on the baseline at the start, middle or end of the text, see text_style::anchor
    std::string string;
    text_style s;
    mark m;
};
} // namespace item

/// A picture. Later elements cover earlier ones.
struct canvas {
    using element = std::variant<item::group_begin, item::group_end, item::line, item::poly, item::rect,
                                 item::circle, item::text>;

    double width = 0.0;  ///< pt
    double height = 0.0; ///< pt
    double loop_s = 0.0; ///< duration of the loop including its pause; 0 if not animated
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

/// A group of elements. It ends when this object is destroyed.
class group {
public:
    group(canvas& c, mark m) : canvas_(c) { c.elements.emplace_back(item::group_begin{std::move(m)}); }
    ~group() { canvas_.elements.emplace_back(item::group_end{}); }
    group(const group&) = delete;
    group& operator=(const group&) = delete;

private:
    canvas& canvas_;
};

/// Typeface of all pictures in all formats.
inline constexpr const char* typeface = "DejaVu Sans";

/// Returns the width of a text, pt. It comes from a table for this typeface, because the layout must not
/// depend on installed fonts.
double text_width(std::string_view utf8, double size, bool bold = false) noexcept;

/// Returns the height of digits and capital letters, pt.
constexpr double cap_height(double size) noexcept
{
    return 0.73 * size;
}

/// Returns valid UTF-8 without control characters. Replaces bytes that are not valid in XML by U+FFFD.
std::string clean(std::string_view text);

/// Returns the text. If it is wider than `width` pt, an ellipsis replaces a part of it. `end` is the fraction
/// of the width for the end of the text: with 0, only the beginning remains.
std::string shorten(std::string_view text, double size, double width, bool bold = false, double end = 0.0);

/// Shortens a title such as "park2016:down (which, n = 12)" in the middle. Keeps the last parenthesis, unless
/// it would take most of the space.
std::string shorten_title(std::string_view text, double size, double width, bool bold = false);

/// Shortens names so that names that differ still differ. Shortens each part of a name such as
/// "park2016:down". Names become wider than `width` pt if this is necessary, but not wider than `most` pt.
std::vector<std::string> shorten_names(const std::vector<std::string>& names, double size, double width,
                                       double most);

/// Breaks a text between words into lines of at most `width` pt, but not between a number and its unit.
/// Shortens words that are wider than a line, and the last line if there would be more than `most_lines`.
std::vector<std::string> wrap(std::string_view text, double size, double width, std::size_t most_lines);

/// Formats a number with at most `digits` significant digits and without trailing zeros. Independent of the
/// locale.
std::string number(double v, int digits = 4);

} // namespace tactor::plot
