// SPDX-License-Identifier: MIT
#include "core/path/impl.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor::detail {
namespace {

/// Arguments of one command, at most seven. A flag is 0 or 1.
using path_arguments = std::array<double, 7>;

/// Returns 'M' for 'm'. Characters that are not letters stay unchanged.
constexpr char upper(char c) noexcept
{
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

// Returns the arc of command A: part of an ellipse with radii rx and ry, between two points. Signs of the
// radii do not matter. The x axis of the ellipse is turned by `turn_deg`; `longer` chooses the longer way
// round. Radii that are too small for the distance are enlarged by a common factor. Returns nothing for a
// straight line, for example if a radius is 0.
// https://www.w3.org/TR/SVG2/implnote.html#ArcImplementationNotes
//
// Rotates the ellipse so that its axes are parallel to x and y, and stretches it to a circle with the longer
// radius. Then computes the arc on that circle.
std::optional<elliptic> svg_arc(point from, double rx, double ry, double turn_deg, bool longer,
                                bool clockwise, point to)
{
    const double radius = std::max(std::abs(rx), std::abs(ry));
    const double kx = std::abs(rx) / radius;
    const double ky = std::abs(ry) / radius;
    const affine turn = rotation(std::remainder(turn_deg, 360.0));
    const double c = turn.a;
    const double s = turn.b;

    // Vector from the middle of the chord to the start of the arc.
    const point half = 0.5 * (from - to);
    const point h{(c * half.x_mm + s * half.y_mm) / kx, (c * half.y_mm - s * half.x_mm) / ky};
    const double reach = std::hypot(h.x_mm, h.y_mm);
    if (!(kx > 0.0 && ky > 0.0 && reach > 0.0))
        return std::nullopt;

    // For a half circle, `reach` equals the radius except for rounding. A square root would turn a rounding
    // error into an error of a ten-millionth of the radius.
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    const bool half_turn = reach >= radius * (1.0 - rounding);
    const double r = half_turn ? reach : radius;
    const double away = half_turn ? 0.0 : std::sqrt((r - reach) * (r + reach));
    const double side = longer != clockwise ? away / reach : -away / reach;
    const point centre{side * h.y_mm, -side * h.x_mm};

    const double short_way = 2.0 * std::atan2(reach, away);
    const double way = longer ? 2.0 * std::numbers::pi - short_way : short_way;
    const point u{r * kx * c, r * kx * s};
    const point v{-r * ky * s, r * ky * c};
    return elliptic{0.5 * (from + to) + (centre.x_mm / r) * u + (centre.y_mm / r) * v, u, v,
                    std::atan2(h.y_mm - centre.y_mm, h.x_mm - centre.x_mm), clockwise ? way : -way};
}

/// A pen that draws the commands of path data.
class path_pen {
public:
    /// Draws one of the commands M L H V C S Q T A. The coordinates of lower-case commands are relative to
    /// the pen.
    void draw(char command, const path_arguments& v)
    {
        const char kind = upper(command);
        const point base = command == kind ? point{} : at_;
        const auto to = [&](std::size_t i) { return point{base.x_mm + v[i], base.y_mm + v[i + 1]}; };
        switch (kind) {
        case 'M':
            return move(to(0));
        case 'L':
            return line(to(0));
        case 'H':
            return line({base.x_mm + v[0], at_.y_mm});
        case 'V':
            return line({at_.x_mm, base.y_mm + v[0]});
        case 'C':
            return cubic(to(0), to(2), to(4));
        case 'S':
            return cubic(cubic_handle_, to(0), to(2));
        case 'Q':
            return quadratic(to(0), to(2));
        case 'T':
            return quadratic(quadratic_handle_, to(0));
        default:
            return arc(v, to(5));
        }
    }

    /// Draws Z, a line to the start of the subpath. If the next command is not a move, it also begins at that
    /// start.
    void close()
    {
        line(start_);
        move(start_);
    }

    /// Returns the drawn subpaths and clears them.
    std::vector<outline> take()
    {
        finish();
        return std::exchange(drawn_, {});
    }

    /// Returns the place of the last move.
    point start() const { return start_; }

private:
    void move(point to)
    {
        finish();
        start_ = to;
        open_.vertices.assign(1, to);
        arrive(to);
        draws_ = false;
    }

    void line(point to)
    {
        open_.line(to);
        arrive(to);
    }

    void cubic(point c1, point c2, point to)
    {
        open_.bezier(c1, c2, to);
        arrive(to);
        cubic_handle_ = to + (to - c2);
    }

    void quadratic(point c, point to)
    {
        open_.quadratic(c, to);
        arrive(to);
        quadratic_handle_ = to + (to - c);
    }

    void arc(const path_arguments& v, point to)
    {
        if (to == at_) {
            cubic_handle_ = quadratic_handle_ = to;
            return; // SVG draws no arc between two equal points
        }
        if (const auto a = svg_arc(at_, v[0], v[1], v[2], v[3] != 0.0, v[4] != 0.0, to))
            open_.arc(*a, to);
        else
            open_.line(to);
        arrive(to);
    }

    // Records that a command drew something, which may be a single point. All commands but M do.
    void arrive(point to)
    {
        draws_ = true;
        at_ = cubic_handle_ = quadratic_handle_ = to;
    }

    void finish()
    {
        if (draws_)
            drawn_.push_back(std::move(open_));
        open_ = {};
        draws_ = false;
    }

    std::vector<outline> drawn_;
    outline open_;
    bool draws_ = false; ///< true if something was drawn since the last move
    point start_;
    point at_;
    // The last handle, mirrored, if S or T continues the kind of the last command.
    point cubic_handle_;
    point quadratic_handle_;
};

constexpr const char* starts = "start the path with M x y";

// Arguments of the commands: n stands for a number, f for a flag.
constexpr std::pair<char, std::string_view> commands[] = {
    {'M', "nn"},   {'L', "nn"},   {'H', "n"},  {'V', "n"},       {'C', "nnnnnn"},
    {'S', "nnnn"}, {'Q', "nnnn"}, {'T', "nn"}, {'A', "nnnffnn"}, {'Z', ""}};

class path_reader {
public:
    path_reader(std::string_view data, double limit, subpaths wanted)
        : data_(data), limit_(limit), one_(wanted == subpaths::one)
    {
    }

    std::vector<outline> run()
    {
        skip_blanks(data_, at_);
        if (at_ == data_.size())
            fail("it is empty", starts);
        if (upper(data_[at_]) != 'M')
            fail(fmt::format("{} cannot start a path", found()), starts);
        while (at_ < data_.size()) {
            read_command();
            skip_blanks(data_, at_);
        }
        std::vector<outline> drawn = pen_.take();
        if (one_ && drawn.empty()) // a move alone draws a single place
            drawn.push_back({{pen_.start()}, {}});
        return drawn;
    }

private:
    void read_command()
    {
        const char c = data_[at_];
        const char kind = upper(c);
        const auto* const known = std::find_if(std::begin(commands), std::end(commands),
                                               [kind](const auto& k) { return k.first == kind; });
        if (known == std::end(commands))
            fail(fmt::format("{} is not a path command", found()),
                 "use M L H V C S Q T A Z, or the same in lower case");
        if (one_ && begun_ && (kind == 'M' || (closed_ && kind != 'Z')))
            fail("a second subpath begins", "give one stroke for each");
        begun_ = true;
        closed_ = kind == 'Z';
        ++at_;
        if (closed_)
            return pen_.close();
        skip_blanks(data_, at_);
        groups(c, known->second);
    }

    // Reads groups of arguments. After a move, all groups but the first are lines.
    void groups(char c, std::string_view wanted)
    {
        for (char drawn = c;; drawn = c == 'M' ? 'L' : c == 'm' ? 'l' : c) {
            pen_.draw(drawn, group(c, wanted));
            const bool comma = separator();
            if (at_ == data_.size() || !begins_number(data_[at_])) {
                if (comma)
                    fail(fmt::format("a number is missing before {}", found()),
                         "write a number after each comma");
                return;
            }
        }
    }

    path_arguments group(char c, std::string_view wanted)
    {
        path_arguments values{};
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (i > 0)
                separator();
            values[i] = wanted[i] == 'f' ? flag(c) : number(c, wanted.size());
        }
        return values;
    }

    double flag(char c)
    {
        if (at_ == data_.size() || (data_[at_] != '0' && data_[at_] != '1'))
            fail(fmt::format("a flag of {1} is missing before {0}", found(), c), "use 0 or 1");
        return data_[at_++] == '1' ? 1.0 : 0.0;
    }

    double number(char c, std::size_t count)
    {
        const std::size_t begin = at_;
        const auto value = scan_number(data_, at_);
        if (!value)
            fail(fmt::format("a number of {1} is missing before {0}", found(), c),
                 fmt::format("give {} {}", c, counted(count, "number")));
        if (!(std::abs(*value) <= limit_)) {
            at_ = begin;
            fail(fmt::format("{:g} is beyond {:g}", *value, limit_), "check the unit");
        }
        return *value;
    }

    bool separator()
    {
        skip_blanks(data_, at_);
        if (at_ == data_.size() || data_[at_] != ',')
            return false;
        ++at_;
        skip_blanks(data_, at_);
        return true;
    }

    static bool begins_number(char c) noexcept
    {
        return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
    }

    std::string found() const { return at_ == data_.size() ? "the end" : quoted(data_.substr(at_, 1)); }

    [[noreturn]] void fail(std::string why, std::string hint = {}) const
    {
        throw value_fault{at_, std::move(why), std::move(hint)};
    }

    std::string_view data_;
    double limit_;
    bool one_;
    std::size_t at_ = 0;
    bool begun_ = false;
    bool closed_ = false;
    path_pen pen_;
};

} // namespace

std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted)
{
    return path_reader(data, limit, wanted).run();
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

path path::from_svg(std::string_view data)
{
    constexpr const char* what = "path data";
    try {
        std::vector<detail::outline> found =
            detail::parse_path_data(data, detail::max_mm, detail::subpaths::one);
        return detail::make_path(std::move(found.front()), what);
    } catch (const detail::value_fault& f) {
        throw error(error_kind::bad_input, what, fmt::format("column {}: {}", f.offset + 1, f.why), f.hint);
    }
}

} // namespace v0
} // namespace tactor
