// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/draw/array_frame.hpp"
#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr double legend_height = 13.0;
constexpr double least_spacing = 3.6; // least distance of two drawn bursts, pt
constexpr std::size_t always_shown = 24;
// Greatest number of bursts in a picture. If there are more, or if they would overlap, the picture shows
// every n-th burst.
constexpr std::size_t most_shown_bursts = 120;
constexpr double close_pitch = 24.0; // distance below which tactors are too close for numbers, pt
constexpr double taller = 0.3;       // greatest additional height, as a fraction of the width
constexpr std::size_t few_paths = 20;
constexpr double places_per_s = 30.0; // positions of the target per second in an animated picture
constexpr double most_places = 600.0;

// Sizes of marks. They are smaller if there are more bursts.
struct fineness {
    double dot = 2.4;  // radius of a dot, pt
    double join = 2.0; // width of the line to a tactor at full amplitude, pt
    double alpha = 0.8;
};

fineness choose_fineness(std::size_t shown) noexcept
{
    if (shown <= 12)
        return {};
    if (shown <= 40)
        return {2.2, 1.5, 0.6};
    return {1.6, 0.8, 0.4};
}

constexpr double farthest_tactor_label = 3.0; // pt; a label that is farther away seems to belong to no tactor
constexpr double arrow_length = 4.6;
constexpr double arrow_half_width = 2.1;
constexpr double arrow_every = 75.0;    // distance between arrows along the path, pt
constexpr std::size_t most_arrows = 60; // in a picture
constexpr double farthest_number = 7.0;
constexpr double same_start = 1.0;      // distance below which starts share a label, pt
constexpr double farthest_label = 20.0; // greatest distance of a label from its start or end, pt
constexpr std::size_t most_marked = 60; // greatest number of strokes whose ends are marked

// Appearance of the tactors, by index.
struct tactor_looks {
    std::vector<bool> plays = {};  // false: drawn lighter
    std::vector<bool> inside = {}; // true: the tactor's number is inside its circle
};

// Draws the circles of the tactors, and the numbers that fit inside. Labels are kept away from the circles.
void draw_tactors(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                  label_placer& taken)
{
    const group all(c, {.id = "tactors"});
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        const spot at = f(t.position);
        const colour rim = looks.plays[i] ? ink : grey;
        const style look =
            f.radius < 1.5 ? style{.fill = rim} : style{.fill = white, .stroke = rim, .width = 0.7};
        taken.block_disc(at, f.radius);
        const group one(c, {.id = fmt::format("tactor-{}", i),
                            .kind = "tactor",
                            .title = fmt::format("tactor {}, channel {}, at {}, {} mm", i, t.channel,
                                                 number(t.position.x_mm), number(t.position.y_mm)),
                            .data = {{"tactor", fmt::format("{}", i)}}});
        c.circle(at, f.radius, look);
        if (looks.inside[i])
            c.text({at.x, at.y + cap_height(f.number) / 2.0}, fmt::format("{}", i),
                   {.size = f.number, .anchor = align::middle, .ink = looks.plays[i] ? ink : dark_grey},
                   {.kind = "number"});
    }
}

// Draws labels next to their tactors, where they cover nothing else: numbers that are not inside circles, and
// channels that differ from numbers. Returns a note about labels for which there is no space, or "".
std::string draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                               label_placer& taken)
{
    const group all(c, {.id = "tactor-labels"});
    const bool channels = !has_matching_channels(a);
    std::vector<spot> sites;
    for (const tactor_spec& t : a.tactors)
        sites.push_back(f(t.position));
    std::size_t missing = 0;
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const std::string channel = channels ? fmt::format("ch {}", a.tactors[i].channel) : "";
        const std::string text = looks.inside[i] ? channel
                                 : channels      ? fmt::format("{} ({})", i, channel)
                                                 : fmt::format("{}", i);
        if (text.empty())
            continue;
        const auto at = taken.place(text, small_text, sites, i, f.radius + 1.2, farthest_tactor_label);
        if (at)
            c.text(*at, text, {.size = small_text, .ink = looks.plays[i] ? ink : dark_grey, .halo = true},
                   {.kind = "tactor-label", .data = {{"tactor", fmt::format("{}", i)}}});
        else
            ++missing;
    }
    return missing == 0                  ? ""
           : missing == a.tactors.size() ? "no space for the numbers of the tactors"
                                         : "no space for the number of " + counted(missing, "tactor");
}

class array_drawing {
public:
    array_drawing(canvas& c, const scene& s, const timeline& t, box at_most, double highest)
        : canvas_(c),
          scene_(s),
          time_(t),
          frame_(fit(s, at_most, highest)),
          taken_({at_most.x, frame_.area.y - 3.0, at_most.width, frame_.area.height + 3.0}),
          stride_(stride()),
          fine_(choose_fineness(t.bursts.size() / stride_ + 1)),
          where_(at_most)
    {
    }

    double draw()
    {
        const group all(canvas_, {.id = "array",
                                  .data = {{"mm-scale", fmt::format("{:.9g}", frame_.scale)},
                                           {"x0", fmt::format("{:.9g}", frame_.origin.x)},
                                           {"y0", fmt::format("{:.9g}", frame_.origin.y)},
                                           {"stride", fmt::format("{}", stride_)}}});
        const tactor_looks looks = find_looks();
        for (const stroke& s : scene_.strokes) {
            paths_.push_back(map_path_to_page(frame_, s.motion));
            for (const std::vector<spot>& part : paths_.back())
                taken_.avoid_line(part);
        }
        draw_joins();
        draw_paths();
        draw_tactors(canvas_, frame_, scene_.tactors, looks, taken_);
        draw_dots();
        draw_felt();
        if (canvas_.loop_s > 0.0)
            draw_moving_parts();
        const std::size_t marked = std::min(scene_.strokes.size(), most_marked);
        for (std::size_t i = 0; i < marked; ++i)
            draw_ends(i);
        for (std::size_t i = 0; i < marked; ++i)
            draw_arrows(scene_.strokes[i].motion, marked);
        notes_.push_back(draw_tactor_labels(canvas_, frame_, scene_.tactors, looks, taken_));
        if (time_.has_several_strokes())
            notes_.push_back("rings with coloured numbers: starts; squares: ends");
        if (!scene_.moved.empty())
            add_observer_notes(scene_.moved.front().observer);
        notes_.push_back(label_strokes());
        const double y = frame_.area.bottom() + legend_height / 2.0;
        draw_scale_bar(canvas_, frame_, {where_.x, y});
        if (!scene_.plans.empty())
            draw_amplitude_legend(y);
        if (time_.sampled)
            notes_.push_back("positions each " + seconds_text(time_.sample_s * static_cast<double>(stride_)));
        else if (stride_ > 1)
            notes_.push_back(fmt::format("one burst in {} is drawn on the array", stride_));
        return frame_.area.height + legend_height +
               draw_notes(canvas_, notes_, {where_.x, y + legend_height / 2.0, where_.width, 0.0},
                          most_array_notes);
    }

private:
    // Fits the array into a box. Makes the picture higher if tactors would be too close on the page for
    // numbers.
    static array_frame fit(const scene& s, box at_most, double highest)
    {
        const extent shown = shown_extent(s.tactors, s.strokes);
        const double tallest = std::min(at_most.height + taller * at_most.width, highest) - legend_height;
        at_most.height = std::min(at_most.height, highest) - legend_height;
        const array_frame f = fit_array(s.tactors, shown, at_most);
        if (f.pitch >= close_pitch)
            return f;
        at_most.height = tallest;
        return fit_array(s.tactors, shown, at_most);
    }

    // Returns the step between drawn bursts; 1 if the picture shows all of them.
    std::size_t stride() const
    {
        const std::size_t n = std::max<std::size_t>(1, time_.bursts.size());
        double length = 0.0;
        for (const stroke& s : scene_.strokes)
            length += s.motion.length_mm() * frame_.scale;
        const double fitting = std::clamp(length / least_spacing, static_cast<double>(always_shown),
                                          static_cast<double>(most_shown_bursts));
        return static_cast<std::size_t>(std::ceil(static_cast<double>(n) / fitting));
    }

    // Finds the tactors whose numbers are drawn inside their circles. The circle must be large enough, and
    // nothing must cover it.
    tactor_looks find_looks() const
    {
        // Distance at which a mark touches a number. It is larger for the rings and squares at the ends of
        // strokes than for dots.
        struct mark_on_page {
            spot at;
            double reach;
        };
        const double number_half = frame_.number > 0.0 ? frame_.radius - 1.0 : 0.0;
        std::vector<mark_on_page> marks;
        for (const stroke& s : scene_.strokes)
            for (const double t : {0.0, s.motion.duration_s()})
                marks.push_back({frame_(s.motion.position(t)), number_half + end_radius()});
        for_each_shown_burst([&](const shown_burst&, spot at, colour) {
            marks.push_back({at, number_half + fine_.dot});
        });
        tactor_looks looks{std::vector<bool>(scene_.tactors.tactors.size(), false), {}};
        for (const unsigned i : time_.playing)
            looks.plays[i] = true;
        for (const tactor_spec& t : scene_.tactors.tactors) {
            const spot at = frame_(t.position);
            looks.inside.push_back(frame_.number > 0.0 &&
                                   std::none_of(marks.begin(), marks.end(), [&](const mark_on_page& m) {
                                       return std::hypot(m.at.x - at.x, m.at.y - at.y) < m.reach;
                                   }));
        }
        return looks;
    }

    double join_width(double amplitude) const { return std::max(0.15, fine_.join * amplitude / time_.peak); }

    template <class Draw>
    void for_each_shown_burst(Draw&& draw) const
    {
        for (std::size_t i = 0; i < time_.bursts.size(); i += stride_)
            draw(time_.bursts[i], frame_(time_.bursts[i].what->position),
                 burst_colour(time_, time_.bursts[i]));
    }

    // Returns the colour of a line from a burst to a tactor. With several strokes it is grey, because mixed
    // colours of strokes would look like other strokes.
    colour join_colour(colour of_burst) const { return time_.has_several_strokes() ? grey : of_burst; }

    // Returns true if most of a stroke's path coincides with an earlier path of a different look.
    bool overlaps_earlier_path(std::size_t stroke) const
    {
        constexpr double beside = 0.6; // distance that counts as coinciding, pt
        constexpr int places = 24;
        const trajectory& motion = scene_.strokes[stroke].motion;
        for (std::size_t i = 0; i < stroke; ++i) {
            if (time_.looks[i] == time_.looks[stroke])
                continue;
            int on = 0;
            for (int k = 0; k <= places; ++k)
                on += is_near(frame_(motion.position(motion.duration_s() * k / places)), paths_[i], beside);
            if (on > places / 2)
                return true;
        }
        return false;
    }

    static bool is_near(spot at, const std::vector<std::vector<spot>>& parts, double reach)
    {
        for (const std::vector<spot>& part : parts)
            for (std::size_t i = 1; i < part.size(); ++i)
                if (distance(at, part[i - 1], part[i]) < reach)
                    return true;
        return false;
    }

    void draw_joins()
    {
        const group all(canvas_, {.id = "joins"});
        for_each_shown_burst([&](const shown_burst& b, spot at, colour c) {
            const group one(canvas_, {.kind = "joins", .data = {{"burst", fmt::format("{}", b.number)}}});
            for (const drive& d : b.what->drives) {
                const spot to = frame_(scene_.tactors.tactors[d.tactor].position);
                canvas_.line(
                    at, to,
                    {.stroke = with_alpha(join_colour(c), fine_.alpha), .width = join_width(d.amplitude)},
                    {.kind = "join",
                     .data = {{"tactor", fmt::format("{}", d.tactor)},
                              {"amplitude", fmt::format("{:.6g}", d.amplitude)}}});
            }
        });
    }

    void draw_paths()
    {
        const group all(canvas_, {.id = "paths"});
        const double width = paths_.size() == 1 ? 0.7 : paths_.size() <= few_paths ? 1.2 : 0.5;
        std::size_t next = 0; // repeats coincide with strokes that are already drawn
        for (std::size_t i = 0; i < paths_.size(); ++i) {
            if (time_.looks[i] != next)
                continue;
            ++next;
            style look{.stroke = time_.has_several_strokes() ? stroke_colour(time_.looks[i]) : ink,
                       .width = width};
            if (paths_.size() <= few_paths && overlaps_earlier_path(i))
                look.dash = 3.0; // makes the stroke underneath visible
            for (const std::vector<spot>& part : paths_[i])
                canvas_.poly(part, false, look, {.kind = "path", .title = scene_.strokes[i].name});
        }
    }

    void draw_dots()
    {
        const group all(canvas_, {.id = "bursts"});
        for_each_shown_burst([&](const shown_burst& b, spot at, colour c) {
            taken_.avoid_disc(at, fine_.dot);
            const std::string end = b.to_s > b.from_s ? fmt::format(" to {} s", number(b.to_s, 6)) : " s";
            canvas_.circle(
                at, fine_.dot, {.fill = c, .stroke = ink, .width = 0.35},
                {.id = fmt::format("burst-{}", b.number),
                 .kind = "burst",
                 .title = fmt::format("burst {}: {}{}, at {}, {} mm", b.number, number(b.from_s, 6), end,
                                      number(b.what->position.x_mm), number(b.what->position.y_mm))});
        });
    }

    void add_observer_notes(const low_speed_observer& o)
    {
        notes_.push_back("line: target, dots: played");
        notes_.push_back("dashes and small rings: predicted to be felt");
        notes_.push_back("low-speed observer, built for taps");
        notes_.push_back(fmt::format("sigma {} mm, sigma_v {} mm/s", plain_number(o.sigma_mm),
                                     plain_number(o.sigma_v_mm_s)));
    }

    // Draws the places at which an observer is predicted to feel the moved bursts.
    void draw_felt()
    {
        constexpr double radius = 1.1;
        for (const compensated_plan& m : scene_.moved) {
            const group one(canvas_, {.kind = "predicted"});
            std::vector<spot> felt;
            for (const tap& t : m.taps)
                felt.push_back(frame_(t.felt));
            canvas_.poly(simplify(felt, 0.04), false, {.stroke = vermilion, .width = 0.7, .dash = 2.0},
                         {.kind = "felt"});
            for (std::size_t i = 0; i < felt.size(); i += stride_)
                canvas_.circle(felt[i], radius, {.fill = white, .stroke = vermilion, .width = 0.5},
                               {.kind = "felt-at"});
        }
    }

    // Draws the moving parts of an animated picture: discs on tactors while they play, and the target on its
    // path.
    void draw_moving_parts()
    {
        const group all(canvas_, {.id = "playing"});
        const auto add = [&](double from_s, double to_s, spot at, double radius, const style& look,
                             const char* kind, std::vector<spot> places = {}) {
            canvas_.moving_circle(at, radius, look,
                                  {from_s / canvas_.loop_s, to_s / canvas_.loop_s, std::move(places)},
                                  {.kind = kind});
        };
        const double instant_s = time_.sample_s * static_cast<double>(stride_);
        for (std::size_t i = 0; i < time_.bursts.size(); i += time_.sampled ? stride_ : 1) {
            const shown_burst& b = time_.bursts[i];
            for (const drive& d : b.what->drives)
                add(b.from_s, b.to_s > b.from_s ? b.to_s : b.from_s + instant_s,
                    frame_(scene_.tactors.tactors[d.tactor].position), frame_.radius,
                    {.fill = with_alpha(vermilion, 0.75 * d.amplitude / time_.peak)}, "plays");
        }
        for (std::size_t i = 0; i < scene_.strokes.size(); ++i) {
            const trajectory& motion = scene_.strokes[i].motion;
            const double duration = motion.duration_s();
            const double steps = std::clamp(std::ceil(duration * places_per_s), 1.0, most_places);
            std::vector<spot> places;
            for (double k = 0.0; k <= steps; ++k)
                places.push_back(frame_(motion.position(duration * k / steps)));
            const spot first = places.front();
            add(time_.starts_s[i], time_.starts_s[i] + duration, first, 1.3 * fine_.dot,
                {.fill = white, .stroke = ink, .width = 0.9}, "target", std::move(places));
        }
    }

    // Writes "start" and "end" next to their marks. If there are several strokes, writes the number of each
    // stroke at its start. Returns a note about labels for which there is no space, or "".
    std::string label_strokes()
    {
        if (scene_.strokes.empty())
            return "";
        if (scene_.strokes.size() == 1) {
            const trajectory& motion = scene_.strokes[0].motion;
            const bool start = label("start", "start-label", motion.position(0.0));
            const bool end = label("end", "end-label", motion.position(motion.duration_s()));
            return start && end ? "" : "the ring is the start, the square the end";
        }
        std::vector<spot> starts;
        std::vector<std::vector<std::size_t>> strokes; // strokes that begin at each of `starts`
        std::size_t omitted = 0;
        for (std::size_t i = 0; i < scene_.strokes.size(); ++i) {
            const spot at = frame_(scene_.strokes[i].motion.position(0.0));
            const auto same = std::find_if(starts.begin(), starts.end(), [&](spot s) {
                return std::hypot(s.x - at.x, s.y - at.y) < same_start;
            });
            if (!on_page(at) || i >= most_marked) {
                ++omitted;
            } else if (same != starts.end()) {
                strokes[static_cast<std::size_t>(same - starts.begin())].push_back(i);
            } else {
                starts.push_back(at);
                strokes.push_back({i});
            }
        }
        for (std::size_t k = 0; k < starts.size(); ++k)
            omitted += draw_stroke_numbers(starts, k, strokes[k]) ? 0 : strokes[k].size();
        return omitted == 0 ? "" : "no space for the number of " + counted(omitted, "stroke");
    }

    // Draws the numbers of strokes in a box with the colour of the first stroke, because numbers without a
    // box stand for tactors. Returns false if there is no space.
    bool draw_stroke_numbers(const std::vector<spot>& starts, std::size_t k,
                             const std::vector<std::size_t>& strokes)
    {
        std::vector<std::size_t> numbers;
        for (const std::size_t i : strokes)
            numbers.push_back(i + 1);
        const std::string text = fmt::format("{}", fmt::join(numbers, ", "));
        const auto place =
            taken_.place(" " + text + " ", small_text, starts, k, end_radius() + 1.5, farthest_number);
        if (!place)
            return false;
        const colour fill = stroke_colour(time_.looks[strokes.front()]);
        const double height = cap_height(small_text);
        const double pad = text_width(" ", small_text);
        const double air = 1.3;
        canvas_.rect(
            {place->x, place->y - height - air, text_width(text, small_text) + 2.0 * pad, height + 2.0 * air},
            {.fill = fill, .stroke = white, .width = 0.5}, {.kind = "start-box"});
        canvas_.text({place->x + pad, place->y}, text,
                     {.size = small_text, .ink = is_dark(fill) ? white : black}, {.kind = "start-label"});
        return true;
    }

    static bool is_dark(colour c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b < 140.0; }

    bool on_page(spot s) const
    {
        return s.x >= frame_.area.x && s.x <= frame_.area.right() && s.y >= frame_.area.y &&
               s.y <= frame_.area.bottom();
    }

    // Returns the time near `wanted` at which an arrow would cover as little as possible, or nothing if there
    // is no place for it.
    std::optional<double> find_arrow_time(const trajectory& motion, double wanted, double range) const
    {
        constexpr int tries = 40;
        constexpr double r = arrow_length / 2.0 + 0.7;
        std::optional<double> best;
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= 2 * tries; ++k) { // the middle, then alternately later and earlier times
            const int step = (k + 1) / 2;
            const double t = wanted + (k % 2 == 0 ? -1.0 : 1.0) * range * step / tries;
            const spot at = frame_(motion.position(t));
            const auto covered = taken_.cover({at.x - r, at.y - r, 2.0 * r, 2.0 * r});
            if (covered && *covered + 0.5 * k < least) {
                least = *covered + 0.5 * k;
                best = t;
            }
        }
        return best;
    }

    void draw_arrow(const trajectory& motion, double t)
    {
        const double step = 1e-3 * motion.duration_s();
        const spot from = frame_(motion.position(t - step));
        const spot to = frame_(motion.position(t + step));
        const spot at = frame_(motion.position(t));
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        if (length < 1e-6 || !on_page(at))
            return; // the target does not move here
        const spot along{(to.x - from.x) / length, (to.y - from.y) / length};
        const auto corner = [&](double forward, double aside) {
            return spot{at.x + forward * along.x - aside * along.y,
                        at.y + forward * along.y + aside * along.x};
        };
        taken_.block_disc(at, arrow_length / 2.0);
        canvas_.poly({corner(arrow_length / 2.0, 0.0), corner(-arrow_length / 2.0, arrow_half_width),
                      corner(-arrow_length / 2.0, -arrow_half_width)},
                     true, {.fill = ink, .stroke = white, .width = 0.4}, {.kind = "direction"});
    }

    // Draws arrowheads on the path of a stroke, at places where they cover little. `strokes` is the number of
    // strokes in the picture.
    void draw_arrows(const trajectory& motion, std::size_t strokes)
    {
        const auto wanted = std::max(1L, std::lround(motion.length_mm() * frame_.scale / arrow_every));
        const std::size_t n =
            std::min({static_cast<std::size_t>(wanted), most_arrows / strokes, most_arrows / 6});
        const double each = motion.duration_s() / static_cast<double>(n);
        for (std::size_t k = 0; k < n; ++k)
            if (const auto t = find_arrow_time(motion, (static_cast<double>(k) + 0.5) * each, 0.4 * each))
                draw_arrow(motion, *t);
    }

    // Returns the radius of the ring at a start, which is also half the side of the square at an end, pt.
    double end_radius() const { return fine_.dot + 1.7; }

    // Draws a ring at the start of a stroke and a square at its end.
    void draw_ends(std::size_t stroke)
    {
        const trajectory& motion = scene_.strokes[stroke].motion;
        const spot start = frame_(motion.position(0.0));
        const spot end = frame_(motion.position(motion.duration_s()));
        const style look{.stroke = ink, .width = 0.9};
        const double r = end_radius();
        if (on_page(start))
            canvas_.circle(start, r, look, {.kind = "start"});
        if (on_page(end))
            canvas_.rect({end.x - r, end.y - r, 2.0 * r, 2.0 * r}, look, {.kind = "end"});
        taken_.block_disc(start, r);
        taken_.block_disc(end, r);
    }

    // Draws a label next to a place. Returns false if there is no space.
    bool label(const std::string& text, const char* kind, point where)
    {
        const spot at = frame_(where);
        if (!on_page(at))
            return true;
        const auto place = taken_.place(text, label_text, {at}, 0, end_radius() + 1.5, farthest_label);
        if (place)
            canvas_.text(*place, text, {.size = label_text, .halo = true}, {.kind = kind});
        return place.has_value();
    }

    void draw_amplitude_legend(double y)
    {
        const group g(canvas_, {.id = "amplitude-legend"});
        double x = where_.right();
        for (const double part : {1.0, 0.5, 0.25}) {
            if (part == 0.25 && where_.width < 205.0)
                continue; // the page is narrow
            const double amplitude = part * time_.peak;
            const std::string text = number(amplitude, 3);
            x -= text_width(text, small_text);
            canvas_.text({x, y + cap_height(small_text) / 2.0}, text, {.size = small_text});
            canvas_.line({x - 15.0, y}, {x - 2.5, y}, {.stroke = dark_grey, .width = join_width(amplitude)});
            x -= 21.0;
        }
        canvas_.text({x + 3.0, y + cap_height(small_text) / 2.0}, "amplitude",
                     {.size = small_text, .anchor = align::end});
    }

    canvas& canvas_;
    const scene& scene_;
    const timeline& time_;
    array_frame frame_;
    label_placer taken_;
    std::size_t stride_;
    fineness fine_;
    box where_;
    std::vector<std::string> notes_ = {};
    std::vector<std::vector<std::vector<spot>>> paths_ = {}; // by stroke, then by part of its path
};

} // namespace

double draw_array_view(canvas& c, const scene& s, const timeline& t, box at_most, double highest)
{
    return array_drawing(c, s, t, at_most, highest).draw();
}

} // namespace tactor::plot
