// SPDX-License-Identifier: MIT
#include "study/report/sections.hpp"

#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace tactor::study {
namespace {

using named_text = std::pair<std::string_view, std::string_view>;

constexpr std::array<named_text, 3> known_algorithms{
    {{"park2016", "the target's place was sampled once each SOA, and each place got one burst (Park et al. "
                  "2016, section 2.2). With the\nlaw above the duration $d$ of a burst is no longer than the "
                  "SOA (Eq. 11), so that bursts never overlap."},
     {"tactile-brush",
      "bursts at the path's ends and where it crosses a line of the grid (Tactile Brush, Israr and Poupyrev "
      "2011), where the\ntarget is at $\\tau_0, \\tau_1, \\ldots$ With the law $\\mathrm{SOA} = a\\,d + b$ "
      "and $m_0 = 0$:\n$m_{i+1} = (\\tau_{i+1} - \\tau_i - b + (1 - a)\\,m_i) / (1 + a)$, $\\mathrm{onset}_i "
      "= \\tau_i - m_i$, $d_i = m_i + m_{i+1}$, and\n$d_i = m_i$ of the last, so that the last burst ends "
      "with the target. Bursts overlap, also on one tactor."},
     {"continuous", "no bursts: the intensities of the phantom model were computed along the path and "
                    "interpolated for each sample."}}};

constexpr std::array<named_text, 5> known_phantoms{
    {{"inverse-distance",
      "On the line between two tactors, at distances $d_1$ and $d_2$ (Eq. 2 of Park et al. 2016):\n"
      "$A_1 = \\sqrt{d_2 / (d_1 + d_2)}\\,A_v$, $A_2 = \\sqrt{d_1 / (d_1 + d_2)}\\,A_v$. Elsewhere the three "
      "closest tactors around the place (Eq. 10):\n$A_i = \\sqrt{(1/d_i) / \\sum_{j=1}^{3} 1/d_j}\\,A_v$, so "
      "that $\\sum A_i^2 = A_v^2$ (Eq. 8) and $d_i A_i^2$ is equal for all (Eq. 9)."},
     {"barycentric", "$A_i = \\sqrt{b_i}\\,A_v$ with $b_i$ the barycentric coordinates of the place in its "
                     "Delaunay triangle."},
     {"linear",
      "$A_i = b_i A_v$ with $b_i$ the barycentric coordinates of the place in its Delaunay triangle."},
     {"log", "$A_i = \\log_2(1 + b_i)\\,A_v$ with $b_i$ the barycentric coordinates of the place in its "
             "Delaunay triangle."},
     {"gaussian", "All tactors, $g_i = e^{-d_i^2 / (2 \\sigma^2)}$ with $\\sigma$ of 0.6 times the pitch, "
                  "$A_i$ in proportion to $g_i$ and normalised\nto $\\sum A_i^2 = A_v^2$, without those "
                  "under 1 % of the largest (after Yun, Oh and Choi 2019)."}}};

template <std::size_t N>
std::string find_text(const std::array<named_text, N>& all, std::string_view name)
{
    for (const auto& [known, text] : all)
        if (known == name)
            return std::string(text);
    return "not one of tactor's own: its equations are to be added by hand.";
}

void add(std::string& all, const std::string& one)
{
    all += (all.empty() ? "" : ", ") + one;
}

} // namespace

std::string timing_law(const timing_profile& p)
{
    return fmt::format("$\\mathrm{{SOA}} = {:.6g}\\,d + {:.6g}\\,\\mathrm{{s}}$ with burst duration $d$",
                       p.slope, p.intercept_s);
}

std::string method_options(const plan_options& o)
{
    std::string all;
    if (o.algorithm == algorithm_kind::park2016) {
        add(all, fmt::format("SOA {:.6g} s{}", o.soa_s, o.timing == timing_kind::fit ? " at most" : ""));
        add(all,
            o.timing == timing_kind::fit ? "timing fit: equal SOAs that end with the path" : "timing fixed");
        if (o.burst_s)
            add(all, fmt::format("bursts of {:.6g} s instead of the law's", *o.burst_s));
    }
    if (o.algorithm == algorithm_kind::tactile_brush) {
        add(all, fmt::format("bursts that overlap on one tactor are one carrier, joined by {}",
                             to_string(o.overlap)));
        if (o.snap)
            add(all, "ends of paths moved onto the grid");
        if (o.drop_points)
            add(all, "crossings left out where there is no time for them");
    }
    if (o.faces == faces_kind::nearest && o.algorithm != algorithm_kind::tactile_brush)
        add(all,
            "faces nearest: the three closest of all tactors, whether or not their triangle holds the place");
    const timing_profile usual;
    if (o.profile.slope != usual.slope || o.profile.intercept_s != usual.intercept_s)
        add(all, timing_law(o.profile));
    if (o.outside == outside_kind::clamp)
        add(all, "places outside the array moved to its edge");
    return all.empty() ? "the defaults" : all;
}

std::string algorithm_text(std::string_view name)
{
    return find_text(known_algorithms, name);
}

std::string phantom_text(std::string_view name)
{
    return find_text(known_phantoms, name);
}

std::string describe_carrier(const json_value& plan)
{
    const json_value s = plan["stroke"];
    const std::string wave = s["waveform"].text().value_or("sine");
    std::string text;
    if (s["noise_seed"].there())
        text = fmt::format("{} Hz (seed {})", plain(wave), s["noise_seed"].words());
    else
        text = fmt::format("{} of {} Hz", plain(wave), digits(s["carrier_hz"].need_number()));
    if (const auto texture = s["texture"].text())
        text += fmt::format(
            ", a recording laid out by {}{}", plain(*texture),
            s["texture_mm"].there() ? fmt::format(" of {} mm", digits(s["texture_mm"].need_number())) : "");
    if (s["am_hz"].there())
        text += fmt::format(", amplitude-modulated at {} Hz to a depth of {}",
                            digits(s["am_hz"].need_number()), digits(s["am_depth"].need_number()));
    std::vector<double> course;
    for (const json_value& c : s["course"].list())
        course.push_back(c["hz"].need_number());
    if (!course.empty())
        text += fmt::format(", its frequency changing on the way: {} Hz", range_text(course));
    return text;
}

std::string describe_envelope(const json_value& plan)
{
    const json_value e = plan["render"]["envelope"];
    if (!e.there())
        return "raised-cosine ramps";
    std::string text = plain(e["kind"].need_text()) + " envelopes";
    if (e["attack_s"].there())
        text += fmt::format(", attack {} s", digits(e["attack_s"].need_number()));
    if (e["release_s"].there())
        text += fmt::format(", release {} s", digits(e["release_s"].need_number()));
    if (e["kind"].text() == "tukey")
        text += fmt::format(", tapered part {}", digits(e["tukey_part"].need_number()));
    return text;
}

std::string describe_rise(const json_value& plan)
{
    std::string all;
    for (const json_value& t : plan["array"]["tactors"].list())
        if (t["rise_s"].there())
            all += fmt::format("{}tactor {} {} s", all.empty() ? "" : ", ", t["tactor"].words(),
                               digits(t["rise_s"].need_number()));
    return all.empty()
               ? ""
               : "rise times of the actuators, for which bursts begin stronger where they can: " + all;
}

} // namespace tactor::study
