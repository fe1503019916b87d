// SPDX-License-Identifier: MIT
/// \file
/// A picture as a value: what is drawn where, in points (1/72 inch), y down. It knows no file format;
/// to_svg(), to_png() and to_pdf() (output.hpp) write the same picture.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "plot/paint/colours.hpp"

namespace tactor::plot {

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

struct style {
    std::optional<colour> fill = {};
    std::optional<colour> stroke = {};
    double width = 0.5; ///< of the stroke, pt
    double dash = 0.0;  ///< length of dashes and gaps, pt; 0: none
};

enum class align { start, middle, end };

struct text_style {
    double size = 6.5; ///< pt
    bool bold = false;
    align anchor = align::start;
    colour ink = black;
    bool halo = false;    ///< white rim, where it lies on lines
    bool upwards = false; ///< turned by a quarter, read from below
};

/// What readers that are no eyes learn of an element: SVG's id, class, title and data-* attributes. PNG and
/// PDF leave it out.
struct mark {
    std::string id = {};
    std::string kind = {};
    std::string title = {};
    std::vector<std::pair<std::string, std::string>> data = {};
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
};
struct text {
    spot at; ///< on the baseline
    std::string string;
    text_style s;
    mark m;
};
} // namespace item

/// Later elements lie on earlier ones.
struct canvas {
    using element = std::variant<item::group_begin, item::group_end, item::line, item::poly, item::rect,
                                 item::circle, item::text>;

    double width = 0.0;  ///< pt
    double height = 0.0; ///< pt
    std::string title = {};
    std::string description = {};
    std::vector<element> elements = {};

    void begin(mark m) { elements.emplace_back(item::group_begin{std::move(m)}); }
    void end() { elements.emplace_back(item::group_end{}); }
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
        elements.emplace_back(item::circle{centre, radius, s, std::move(m)});
    }
    void text(spot at, std::string string, const text_style& s, mark m = {})
    {
        elements.emplace_back(item::text{at, std::move(string), s, std::move(m)});
    }
};

/// A group that ends with its scope.
class group {
public:
    group(canvas& c, mark m) : canvas_(c) { c.begin(std::move(m)); }
    ~group() { canvas_.end(); }
    group(const group&) = delete;
    group& operator=(const group&) = delete;

private:
    canvas& canvas_;
};

} // namespace tactor::plot
