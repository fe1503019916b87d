// SPDX-License-Identifier: MIT
#include "cli/compare/compare_picture.hpp"

#include <string>
#include <vector>

#include "plot/compare_figure.hpp"

namespace tactor::cli {
namespace {

plot::people_bands bands_of(const comparison_row& r)
{
    plot::people_bands b;
    if (!r.spread)
        return b;
    b.tracks = r.spread->tracks;
    for (const speed_range& x : r.spread->speeds)
        b.speeds.push_back({x.t_s, x.low, x.high});
    return b;
}

} // namespace

plot::canvas picture_of(const comparison& c, const array& a, const picture_options& o)
{
    std::vector<plot::prediction> rows;
    for (const comparison_row& r : c.rows)
        rows.push_back({std::string(to_string(r.algorithm)), std::string(to_string(r.phantom)), r.samples,
                        r.felt, r.refused ? std::string(r.refused->why()) : "", r.taps, r.unpredicted,
                        bands_of(r)});
    return plot::draw_comparison(
        a, c.target, rows, o.has_title() ? o.choose_title(c.target.name) : "",
        "The ring is the start; dots are where " +
            std::string(c.observer.kind == observer_kind::low_speed ? "each burst is felt"
                                                                    : "the felt position rests") +
            (c.spread.people == 0 ? std::string()
                                  : "; light lines and bands: " +
                                        spread_note(c.spread, c.observer.kind == observer_kind::low_speed)) +
            ". This is " + prediction_note(c.observer) + "." +
            (c.compensated ? " Bursts are moved for " + describe(c.observer.low_speed) + "."
                           : std::string()) +
            (c.faces == faces_kind::nearest
                 ? " Of inverse-distance the three closest tactors play (faces nearest)."
                 : ""),
        o.width_mm);
}

} // namespace tactor::cli
