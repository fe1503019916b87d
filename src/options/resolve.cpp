// SPDX-License-Identifier: MIT
#include "options/resolve.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/marks.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "options/option.hpp"

namespace tactor::options {
namespace {

// Clears an option. The option for the level in dBFS keeps its value, because a level in dB SL has priority
// over it.
void forget(option_values& w, const option& o)
{
    w.by_user.reset(index(o));
    w.in_file.erase(index(o));
    o.to.set(w, {});
    if (o.name == "speed")
        w.usual_speed_mm_s.reset();
}

// Returns a hint that lists the options of this front end that make option `o` useful.
std::string needed(const option_values& w, const option& o)
{
    std::string all;
    for (const std::string_view one : detail::split(o.needs, '|'))
        if ((find(detail::find_mark(one)->name)->where & w.place) != 0)
            all.append(all.empty() ? "" : " or ").append(one);
    return "add " + all;
}

const option& find_default(const written_value& d)
{
    const option* o = find(d.name);
    if (o != nullptr && o->field != d.name && (o->where & in_defaults) != 0)
        return *o;
    const std::vector<std::string> names = dashed_names(in_defaults);
    throw detail::unknown_key(d.name_at, d.name, "[defaults]",
                              std::vector<std::string_view>(names.begin(), names.end()));
}

// Refuses an option if its rival comes earlier in the same file. An option overrides a rival from an included
// file.
void refuse_earlier_rival(const setup& says, const written_value& d, const option* rival)
{
    for (const written_value& other : says.defaults)
        if (rival != nullptr && find(other.name) == rival && other.at.file == d.at.file &&
            std::pair(other.at.line, other.at.column) < std::pair(d.at.line, d.at.column))
            throw error(error_kind::bad_input, d.at,
                        fmt::format("[defaults] has both {} and {}", other.name, d.name), "keep one of them");
}

// Returns true if the front end has the option, and the user set neither the option nor its rival.
bool takes_default(const option_values& w, const option& o)
{
    const option* rival = find(o.rival);
    return (o.where & w.place) != 0 && !w.gives(o) && (rival == nullptr || !w.gives(*rival));
}

error locate_option_error(const source_place& at, const option& o, const error& e)
{
    const std::string about = e.subject() == e.field() ? "" : detail::plain(e.subject()) + ": ";
    return e.reworded(at.text(), fmt::format("{}: {}{}", dashed(o), about, e.why()), e.hint())
        .with_place(at)
        .with_field(o.name);
}

} // namespace

void give(option_values& w, const option& o, const value& v)
{
    if (const option* rival = find(o.rival)) {
        if (w.gives(*rival))
            throw refusal(o, fmt::format("it cannot be combined with {{{}}}", rival->name),
                          "give one of them");
        forget(w, *rival);
    }
    put(w, o, v);
    w.by_user.set(index(o));
    w.in_file.erase(index(o));
}

std::vector<default_value> read_defaults(const setup& says)
{
    std::vector<default_value> all;
    for (const written_value& d : says.defaults) {
        const option& o = find_default(d);
        refuse_earlier_rival(says, d, find(o.rival));
        const auto* text = std::get_if<std::string>(&d.value);
        try {
            // A value in quotes is parsed as if typed: "0.07" is 0.07.
            all.push_back({&o, text != nullptr ? read_text(o, *text) : read_value(o, d.value), d.at});
            option_values tried;
            if (text == nullptr || o.name != "waveform" || !waveform_names_file(*text))
                o.to.set(tried, all.back().content); // a file is opened only where it is used
        } catch (const error& e) {
            throw locate_option_error(d.at, o, e);
        }
    }
    return all;
}

void apply_defaults(option_values& w, const setup& says)
{
    for (const default_value& d : read_defaults(says)) {
        const option& o = *d.row;
        if (!takes_default(w, o))
            continue;
        if (const option* rival = find(o.rival))
            forget(w, *rival);
        try {
            o.to.set(w, d.content);
        } catch (const error& e) {
            throw locate_option_error(d.at, o, e);
        }
        if (o.name == "speed") // a stroke's own speed has priority
            w.usual_speed_mm_s = std::exchange(w.speed_mm_s, std::nullopt);
        w.in_file.insert_or_assign(index(o), d.at);
    }
}

void resolve(option_values& w)
{
    for (const option& o : all())
        if (w.gives(o) && o.used != nullptr && !o.used(w))
            throw refusal(o, "nothing here uses it", needed(w, o));
    if (w.render.envelope.kind == envelope_kind::tukey)
        for (const char* ramp : {"attack", "release", "ramp"})
            if (w.gives(ramp))
                throw refusal(*find(ramp), "{envelope=tukey} has its own ramps",
                              fmt::format("leave out {{{}}} or {{envelope}}", ramp));
    const auto is_set = [&w](const option& o) { return w.gives(o) || w.in_file.contains(index(o)); };
    timing_profile& law = w.plan.profile;
    const timing_profile usual; // its longest SOA is the rounded value from the paper
    if ((is_set(*find("slope")) || is_set(*find("intercept"))) &&
        (law.slope != usual.slope || law.intercept_s != usual.intercept_s))
        law.max_soa_s = law.intercept_s / (1.0 - law.slope);
    if (w.plan.scale.kind == scale_kind::sl && (find("sl")->where & w.place) != 0) {
        if (!(w.render.sl_db.value_or(0.0) > 0.0))
            throw refusal(*find("intensity_scale"), "the scale sl needs a sensation level above 0 dB",
                          "add {sl}, such as {sl=7}");
        w.plan.scale.sl_db = *w.render.sl_db;
    }
}

void refuse_planning_options(const option_values& w, const std::string& what)
{
    for (const option& o : all())
        if ((o.where & planning) != 0 && w.gives(o))
            throw refusal(o, fmt::format("{} is already a plan", what),
                          fmt::format("leave out {{{0}}}, or plan the stroke again with {{{0}}}", o.name));
}

void refuse_stroke_options(const option_values& w, const std::string& what)
{
    for (const option& o : all())
        if (((o.where & planning) != 0 || o.in == group::sound || o.name == "together") && w.gives(o))
            throw refusal(o, fmt::format("{} has samples, which play as they are", what),
                          fmt::format("leave out {{{}}}", o.name));
}

error locate_default_error(const option_values& w, const error& e)
{
    const option* o = find(e.field());
    const auto found = o == nullptr || e.place().line != 0 ? w.in_file.end() : w.in_file.find(index(*o));
    if (found == w.in_file.end())
        return e;
    return locate_option_error(found->second, *o, e);
}

} // namespace tactor::options
