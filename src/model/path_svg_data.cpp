// SPDX-License-Identifier: MIT
#include "model/path_svg_data.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <new>
#include <string>

#include <2geom/elliptical-arc.h>
#include <2geom/path-sink.h>
#include <2geom/svg-path-parser.h>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "model/path_impl.hpp"

namespace tactor {
namespace {

using detail::outline;
using detail::value_fault;

point from_geom(const Geom::Point& p)
{
    return {p.x(), p.y()};
}

Geom::Point to_geom(point p)
{
    return {p.x_mm, p.y_mm};
}

// Takes lib2geom's absolute commands. Straight lines stay plain points, and lib2geom's check that curves
// join to the last bit, which rounding in relative commands can break, is not in the way.
class outline_sink final : public Geom::PathSink {
public:
    explicit outline_sink(std::vector<outline>& out) : out_(out) {}

    void moveTo(const Geom::Point& p) override
    {
        flush();
        start(from_geom(p));
    }
    void lineTo(const Geom::Point& p) override { open().line(from_geom(p)); }
    void curveTo(const Geom::Point& c0, const Geom::Point& c1, const Geom::Point& p) override
    {
        open().bezier(from_geom(c0), from_geom(c1), from_geom(p));
    }
    void quadTo(const Geom::Point& c, const Geom::Point& p) override
    {
        open().quadratic(from_geom(c), from_geom(p));
    }
    void arcTo(Geom::Coord rx, Geom::Coord ry, Geom::Coord angle, bool large, bool sweep,
               const Geom::Point& p) override
    {
        outline& o = open();
        if (rx == 0.0 || ry == 0.0)
            return o.line(from_geom(p));
        const Geom::EllipticalArc arc(to_geom(o.vertices.back()), {rx, ry}, angle, large, sweep, p);
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        o.arc({from_geom(arc.center()),
               {arc.ray(Geom::X) * c, arc.ray(Geom::X) * s},
               {-arc.ray(Geom::Y) * s, arc.ray(Geom::Y) * c},
               arc.initialAngle().radians(),
               arc.sweepAngle()},
              from_geom(p));
    }
    void closePath() override
    {
        const point first = open().vertices.front();
        open().line(first);
        drawn_ = true;
        flush();
        start(first); // what follows without a move begins here
    }
    void flush() override
    {
        if (drawn_)
            out_.push_back(std::move(current_));
        current_ = {};
        drawn_ = false;
    }

private:
    void start(point p) { current_.vertices.assign(1, p); }

    outline& open()
    {
        drawn_ = true;
        if (current_.vertices.empty())
            start({});
        return current_;
    }

    std::vector<outline>& out_;
    outline current_;
    bool drawn_ = false;
};

} // namespace

std::vector<outline> detail::parse_path_data(std::string_view data, double limit)
{
    if (auto check = check_path_data(data, limit); check.fault)
        throw std::move(*check.fault);
    if (data.size() > INT_MAX)
        throw value_fault{0, "is too long", "split it"};
    // lib2geom does not know that a form feed is a blank.
    std::string without_feeds;
    if (data.find('\f') != std::string_view::npos) {
        without_feeds = data;
        std::replace(without_feeds.begin(), without_feeds.end(), '\f', ' ');
        data = without_feeds;
    }
    std::vector<outline> found;
    outline_sink sink(found);
    try {
        Geom::SVGPathParser(sink).parse(data.data(), static_cast<int>(data.size()));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw value_fault{0, fmt::format("is not path data: {}", e.what()), {}};
    }
    return found;
}

path path::from_svg(std::string_view data)
{
    constexpr const char* what = "path data";
    try {
        if (const auto second = detail::check_path_data(data, detail::max_mm).second_subpath)
            throw value_fault{*second, "a second subpath begins", "give one stroke for each"};
        std::vector<outline> found = detail::parse_path_data(data, detail::max_mm);
        if (found.empty())
            throw error(errc::bad_input, what, "draws nothing", "e.g. \"M 0 10 L 40 30\"");
        return detail::make_path(std::move(found.front()), [] { return what; });
    } catch (const value_fault& f) {
        throw error(errc::bad_input, what, fmt::format("column {}: {}", f.offset + 1, f.why), f.hint);
    }
}

} // namespace tactor
