// SPDX-License-Identifier: MIT
#include "study/report/sound_text.hpp"

#include <vector>

#include <fmt/format.h>

#include "study/report/markdown.hpp"

namespace tactor::study {

std::string carrier_of(const json_fact& plan)
{
    const json_fact s = plan["stroke"];
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
    for (const json_fact& c : s["course"].list())
        course.push_back(c["hz"].need_number());
    if (!course.empty())
        text += fmt::format(", its frequency changing on the way: {} Hz", range_text(course));
    return text;
}

std::string envelope_of(const json_fact& plan)
{
    const json_fact e = plan["render"]["envelope"];
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

std::string rise_of(const json_fact& plan)
{
    std::string all;
    for (const json_fact& t : plan["array"]["tactors"].list())
        if (t["rise_s"].there())
            all += fmt::format("{}tactor {} {} s", all.empty() ? "" : ", ", t["tactor"].words(),
                               digits(t["rise_s"].need_number()));
    return all.empty()
               ? ""
               : "rise times of the actuators, for which bursts begin stronger where they can: " + all;
}

} // namespace tactor::study
