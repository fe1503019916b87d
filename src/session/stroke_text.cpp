// SPDX-License-Identifier: MIT
#include "session/stroke_text.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/kind_names.hpp"
#include "core/start_times.hpp"
#include "core/words.hpp"
#include "files/output_file.hpp"
#include "files/vibration_file.hpp"

namespace tactor::session {
namespace {

// Returns the method of a plan. A burst as long as its SOA counts as that of the timing law.
stroke_choices read_method(const plan& p)
{
    stroke_choices method{.algorithm = detail::find_kind<algorithm_kind>(p.algorithm),
                          .phantom = detail::find_kind<phantom_kind>(p.phantom)};
    if (method.algorithm != algorithm_kind::park2016 || !p.soa_s || p.bursts.empty())
        return method;
    method.soa_s = p.soa_s;
    if (const double burst_s = p.bursts.front().duration_s; burst_s < *p.soa_s)
        method.burst_s = burst_s;
    return method;
}

// Returns true for a start that a new file cannot hold: it has no groups, and most formats count each start
// from that of the piece.
bool lacks_start(const stroke& k, const detail::stroke_format& to) noexcept
{
    return k.anchor.back != 1 || (!to.starts_from_strokes && k.anchor.from != start_from_kind::piece);
}

// Adds to a stroke the options that differ from the built-in ones or that the user set, if stroke files have
// keys for them and the stroke does not set them itself.
void add_missing_options(stroke& k, const options::option_values& o)
{
    const plan_options& p = o.plan;
    const plan_options usual;
    const auto put = [&o](auto& own, std::string_view option, const auto& chosen, const auto& built_in) {
        if (!own && (o.gives(option) || chosen != built_in))
            own = chosen;
    };
    put(k.choices.algorithm, "algorithm", p.algorithm, usual.algorithm);
    put(k.choices.phantom, "phantom", p.phantom, usual.phantom);
    put(k.choices.faces, "faces", p.faces, usual.faces);
    put(k.choices.soa_s, "soa", p.soa_s, usual.soa_s);
    put(k.choices.burst_s, "burst", p.burst_s, usual.burst_s);
    if (k.sound.carrier_profile.empty() && k.sound.carrier_times.empty())
        put(k.sound.carrier_hz, "carrier", p.carrier_hz, usual.carrier_hz);
    if (p.wave.kind != waveform_kind::recording || o.place != options::by_client) // no names of files
        put(k.sound.wave, "waveform", p.wave, usual.wave);
    put(k.sound.am, "am", p.am, usual.am);
}

// Returns true if a copy of a stroke has another waveform. Ignores how a file of a recording is named.
bool differs_in_wave(const std::optional<waveform>& was, const std::optional<waveform>& is)
{
    if (!was || !is || !was->recorded || !is->recorded)
        return was && was != is;
    waveform same_file = *is;
    if (was->recorded->sha256 == is->recorded->sha256)
        same_file.recorded = was->recorded;
    return *was != same_file;
}

// Largest differences of a movement and its copy in a file.
struct difference {
    double duration_s = 0.0;
    double mm = 0.0;
    double intensity = 0.0;
};

difference compare(const trajectory& was, const trajectory& is)
{
    constexpr int steps = 4096;
    difference d{.duration_s = std::abs(was.duration_s() - is.duration_s())};
    for (int k = 0; k <= steps; ++k) {
        const double t_s = was.duration_s() * k / steps;
        d.mm = std::max(d.mm, distance_mm(was.position(t_s), is.position(t_s)));
        d.intensity = std::max(d.intensity, std::abs(was.intensity(t_s) - is.intensity(t_s)));
    }
    return d;
}

// Compares strokes with a file of one vibration between the knots of both, where all is linear. Calls
// add(what) for each difference.
void compare(detail::joined_strokes was, detail::joined_strokes is,
             const std::function<void(std::string_view)>& add)
{
    constexpr double steps_s = 1e-4; // times closer than this are steps
    std::vector<double> knots = was.knots();
    knots.insert(knots.end(), is.knots().begin(), is.knots().end());
    std::sort(knots.begin(), knots.end());
    double intensity = 0.0;
    double hz = 0.0;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        if (knots[i + 1] - knots[i] <= steps_s)
            continue;
        for (const double part : {0.02, 0.98}) {
            const double t_s = std::lerp(knots[i], knots[i + 1], part);
            const auto a = was.at(t_s);
            const auto b = is.at(t_s);
            intensity = std::max(intensity, std::abs(a.amplitude - b.amplitude));
            if (a.amplitude > 0.0 && b.amplitude > 0.0)
                hz = std::max(hz, std::abs(a.hz - b.hz));
        }
    }
    const auto add_largest = [&add](double v, double least, const char* what, const char* unit) {
        if (v > least)
            add(fmt::format("{} (up to {:.2g}{} away)", what, v, unit));
    };
    if (std::abs(was.duration_s() - is.duration_s()) > 1e-9)
        add("the duration");
    add_largest(intensity, 1e-9, "the changes of intensity", "");
    add_largest(hz, 0.1, "the carrier", " Hz");
    if (was.touches().size() != is.touches().size())
        return add("all short touches");
    detail::short_touch off;
    bool wave = false;
    for (std::size_t i = 0; i < was.touches().size(); ++i) {
        const detail::short_touch& a = was.touches()[i];
        const detail::short_touch& b = is.touches()[i];
        off.t_s = std::max(off.t_s, std::abs(a.t_s - b.t_s));
        off.lasts_s = std::max(off.lasts_s, std::abs(a.lasts_s - b.lasts_s));
        off.amplitude = std::max(off.amplitude, std::abs(a.amplitude - b.amplitude));
        off.hz = std::max(off.hz, std::abs(a.hz - b.hz));
        wave = wave || std::abs(a.square - b.square) > 1e-9;
    }
    add_largest(1e3 * off.t_s, 1e-2, "the starts of short touches", " ms");
    add_largest(1e3 * off.lasts_s, 1e-2, "the durations of short touches", " ms");
    add_largest(off.amplitude, 1e-9, "the intensities of short touches", "");
    add_largest(off.hz, 0.1, "the carriers of short touches", " Hz");
    if (wave)
        add("the waveforms of short touches");
}

// Collects what a file lacks, and of which strokes.
class omissions {
public:
    explicit omissions(std::span<const stroke> strokes) : strokes_(strokes) {}

    void add(bool lacking, std::string_view what)
    {
        const auto known = std::find_if(all_.begin(), all_.end(), [&](auto& o) { return o.first == what; });
        if (lacking && known == all_.end())
            all_.push_back({std::string(what), {at_}});
        else if (lacking)
            known->second.push_back(at_);
    }

    void compare_next(const stroke& is)
    {
        const stroke& was = strokes_[at_];
        add(was.name != is.name && !was.name.empty(), "the name");
        compare_choices(was, is);
        add(differs(was.start_s, is.start_s) && (*was.start_s != 0.0 || at_ != 0), "the start");
        add(differs(was.sound.carrier_hz, is.sound.carrier_hz), "the carrier");
        add(was.sound.carrier_profile != is.sound.carrier_profile, "the carrier profile");
        add(was.sound.carrier_times != is.sound.carrier_times, "the carrier over time");
        add(differs_in_wave(was.sound.wave, is.sound.wave), "the waveform");
        add(was.choices.level_db != is.choices.level_db, "the level relative to other strokes");
        add(was.fit != is.fit, "the fit to the array");
        const difference d = compare(was.motion, is.motion);
        add(d.duration_s > 1e-9, "the duration");
        if (d.mm > 1e-6)
            add(true, fmt::format("the exact movement (up to {:.2g} mm away)", d.mm));
        if (d.intensity > 1e-9)
            add(true, fmt::format("the changes of intensity (up to {:.2g} away)", d.intensity));
        ++at_;
    }

    // Compares with the strokes of a file of one vibration, which is called by the file's name.
    void compare_vibration(const std::vector<stroke>& again, const std::string& called)
    {
        const stroke& is = again.front();
        for (const stroke& was : strokes_) {
            const bool is_short = was.motion.duration_s() <= detail::longest_short_s;
            const waveform_kind wave = was.sound.wave ? was.sound.wave->kind : waveform_kind::sine;
            const bool rests = was.motion.length_mm() == 0.0;
            add(!was.name.empty() && was.name != called && !was.name.starts_with(called + "-"), "the name");
            compare_choices(was, is);
            add(!was.choices.algorithm, "the algorithm"); // the usual one
            add(wave != waveform_kind::sine && !(is_short && wave == waveform_kind::square), "the waveform");
            add(!rests, "the movement");
            add(rests && (was.fit != is.fit ||
                          distance_mm(was.motion.position(0.0), is.motion.position(0.0)) > 1e-6),
                "the place");
            ++at_;
        }
        compare(detail::joined_strokes(strokes_), detail::joined_strokes(again),
                [this](std::string_view what) {
                    all_.push_back({std::string(what), {}});
                });
    }

    std::vector<std::string> texts(const detail::stroke_format& to) const
    {
        std::vector<std::string> texts;
        for (const auto& [what, at] : all_) {
            std::string of = at.size() > 1 ? " of " + counted(at.size(), "stroke") : "";
            if (at.size() == 1 && strokes_.size() > 1)
                of = fmt::format(" of stroke {}", at.front() + 1);
            texts.push_back(fmt::format("{} cannot hold {}{}", to.title, what, of));
        }
        return texts;
    }

private:
    static bool differs(const auto& a, const auto& b) { return a && a != b; }

    void compare_choices(const stroke& was, const stroke& is)
    {
        const stroke_choices& c = was.choices;
        add(was.note != is.note, "the note that it is reconstructed");
        add(differs(was.sound.am, is.sound.am), "the amplitude modulation");
        add(differs(c.algorithm, is.choices.algorithm), "the algorithm");
        add(differs(c.phantom, is.choices.phantom), "the phantom model");
        add(differs(c.faces, is.choices.faces), "the faces");
        add(differs(c.soa_s, is.choices.soa_s), "the SOA");
        add(differs(c.burst_s, is.choices.burst_s), "the duration of bursts");
    }

    std::span<const stroke> strokes_;
    std::size_t at_ = 0;
    std::vector<std::pair<std::string, std::vector<std::size_t>>> all_;
};

} // namespace

std::vector<stroke> list_plan_strokes(const files::piece& planned)
{
    std::vector<stroke> all = planned.strokes;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double level_db = all[i].choices.level_db;
        all[i].choices = read_method(planned.plans[i].plan);
        all[i].choices.level_db = level_db;
        all[i].start_s = planned.plans[i].start_s;
        all[i].anchor = planned.plans[i].anchor;
    }
    return all;
}

void replace_unsupported_starts(std::vector<stroke>& strokes, const detail::stroke_format& to,
                                const start_finder& find)
{
    const auto lacks = [&to](const stroke& k) { return lacks_start(k, to); };
    if (std::none_of(strokes.begin(), strokes.end(), lacks))
        return;
    const std::vector<double> starts_s = find(strokes);
    for (std::size_t i = 0; i < strokes.size(); ++i)
        if (lacks(strokes[i])) {
            strokes[i].start_s = starts_s[i];
            strokes[i].anchor = {};
        }
}

void add_missing_options(std::vector<stroke>& strokes, const options::option_values& o)
{
    for (stroke& k : strokes)
        add_missing_options(k, o);
}

std::vector<double> path_starts_s(const std::vector<stroke>& strokes)
{
    detail::start_times times;
    for (const stroke& k : strokes) {
        times.start(k.start_s, k.anchor);
        times.set_duration(k.motion.duration_s());
    }
    return std::move(times).all();
}

std::string lost_fit(const detail::stroke_format& to)
{
    return fmt::format("{} cannot hold the fit to the array", to.title);
}

written_strokes write_strokes(std::span<const stroke> strokes, const detail::stroke_format& to,
                              const std::string& name, const layout* on)
{
    if (strokes.empty())
        throw error(error_kind::bad_input, name, "there is no stroke to write", "give one");
    if (to.only_points && strokes.size() != 1)
        throw error(
            error_kind::bad_input, name,
            fmt::format("a {} file can have only one stroke, but there are {}", to.title, strokes.size()),
            "write a TOML file");
    written_strokes made{to.write(strokes)};
    // A recording is a file that the text names, and a text is read without a folder.
    const std::filesystem::path here;
    std::vector<stroke> again = to.parse({made.text, name, 1.0, &here});
    omissions lacking(strokes);
    if (to.one_vibration)
        lacking.compare_vibration(on != nullptr ? apply_fits(std::move(again), *on) : std::move(again),
                                  detail::stem(name));
    else
        for (const stroke& k : again)
            lacking.compare_next(k);
    made.left_out = lacking.texts(to);
    return made;
}

const detail::stroke_format& find_output_format(const std::string& file,
                                                std::initializer_list<std::string_view> others)
{
    const detail::stroke_format* const found = detail::find_format_by_extension(file);
    if (found != nullptr && found->write != nullptr)
        return *found;
    std::vector<std::string_view> known;
    for (const detail::stroke_format* f : detail::stroke_formats())
        if (f->write != nullptr)
            known.push_back(f->extensions.front());
    known.insert(known.end(), others.begin(), others.end());
    throw error(error_kind::bad_input, file, "the name has no supported extension",
                fmt::format("use one of {}", fmt::join(known, ", ")));
}

std::vector<std::string> save_strokes(std::span<const stroke> strokes, const std::string& file, bool force,
                                      const layout* on, detail::owner_kind writer)
{
    const detail::stroke_format& to = find_output_format(file);
    written_strokes made = write_strokes(strokes, to, file, on);
    detail::write_text(file, made.text, to.comment, force, writer);
    return std::move(made.left_out);
}

} // namespace tactor::session
