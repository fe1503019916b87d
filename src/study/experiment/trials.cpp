// SPDX-License-Identifier: MIT
#include "study/experiment/trials.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/marks.hpp"
#include "core/sha256.hpp"
#include "files/plan/plan_json.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"
#include "session/piece.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/experiment/trial_order.hpp"
#include "study/experiment/variation.hpp"
#include "study/random/random.hpp"
#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"
#include "synth/score/joined.hpp"

namespace tactor::study {
namespace {

// Sets the pause before each trial, in whole milliseconds. Uses random numbers only if the pause varies.
void draw_rests(std::vector<planned_trial>& trials, const rest_range& range, random_numbers& r)
{
    constexpr double steps_per_s = 1000.0;
    for (planned_trial& t : trials) {
        t.rest_s = range.least_s;
        if (range.is_random())
            t.rest_s += std::round((range.most_s - range.least_s) * r.unit() * steps_per_s) / steps_per_s;
    }
}

// Returns the order of n runs or blocks. `row` counts from 0. Uses random numbers only for a random order.
std::vector<std::size_t> make_order(std::string_view order, std::size_t n, std::size_t row, random_numbers& r)
{
    if (order != "random")
        return square_row(order, n, row % count_square_rows(order, n));
    std::vector<std::size_t> all(n);
    std::iota(all.begin(), all.end(), 0);
    shuffle(std::span(all), r);
    return all;
}

// Returns the number of blocks of a run; 1 if all its trials are mixed.
std::size_t count_blocks(const run_definition& r)
{
    return r.blocks == "methods" ? r.methods.size() : r.blocks == "motions" ? r.motions.size() : 1;
}

bool is_in_block(const experiment_definition& d, const planned_trial& t, const run_definition& r,
                 std::size_t i)
{
    if (r.blocks == "methods")
        return d.methods[t.method_1].made_of.value_or(t.method_1) == r.methods[i];
    return r.blocks.empty() || t.motion == r.motions[i];
}

// Splits the trials of a run into its blocks.
std::vector<std::vector<planned_trial>> split_into_blocks(const experiment_definition& d,
                                                          const run_definition& r,
                                                          const std::vector<planned_trial>& trials)
{
    std::vector<std::vector<planned_trial>> blocks(count_blocks(r));
    for (std::size_t i = 0; i < blocks.size(); ++i)
        std::ranges::copy_if(trials, std::back_inserter(blocks[i]),
                             [&](const planned_trial& t) { return is_in_block(d, t, r, i); });
    return blocks;
}

constexpr double longest_stimulus_s = 600.0;

// Returns the felt positions at path_parts + 1 equally spaced times. Repeats the last felt position while
// nothing is felt. Before anything is felt, uses the first felt position.
std::vector<point> sample_path(const std::vector<percept_sample>& samples)
{
    std::vector<point> felt;
    std::optional<point> last;
    for (const percept_sample& s : samples)
        if (s.felt && !last)
            last = s.felt;
    for (const percept_sample& s : samples) {
        last = s.felt ? s.felt : last;
        felt.push_back(last.value_or(s.target));
    }
    std::vector<point> parts;
    for (std::size_t i = 0; i <= path_parts; ++i)
        parts.push_back(felt[i * (felt.size() - 1) / path_parts]);
    return parts;
}

// Returns the strokes that a method plays for a motion: the method's own strokes, or else the motion's
// strokes. Removes the strokes' carrier, waveform or modulation if the method sets its own.
std::vector<stroke> choose_strokes(const motion_definition& motion, const method_definition& method)
{
    std::vector<stroke> all = method.strokes.empty() ? motion.strokes : method.strokes;
    vary_strokes(all, method);
    for (stroke& s : all) {
        if (method.silent)
            s.motion = s.motion.with_intensity(0.0);
        if (method.options.gives("carrier")) {
            s.sound.carrier_hz.reset();
            s.sound.carrier_profile.clear();
            s.sound.carrier_times.clear();
        }
        if (method.options.gives("waveform"))
            s.sound.wave.reset();
        if (method.options.gives("am"))
            s.sound.am.reset();
    }
    return all;
}

// Copies the session's render options, and overwrites the options that the method sets.
render_options merge_render_options(const render_options& common, const options::option_values& method)
{
    options::option_values all;
    all.render = common;
    for (const options::option& o : options::all())
        if (o.is_sound() && method.gives(o))
            options::give(all, o, o.to.get(method));
    return all.render;
}

// Lists the methods that a run plays: each method of the run, or the variants that replace the method.
std::vector<std::size_t> list_played_methods(const run_definition& r)
{
    std::vector<std::size_t> all;
    for (const std::size_t method : r.methods) {
        const method_variants& v = r.variants.at(method);
        if (v.values.empty())
            all.push_back(method);
        all.insert(all.end(), v.values.begin(), v.values.end());
        all.insert(all.end(), v.silences.begin(), v.silences.end());
        for (const auto& one : {v.standard, v.silent})
            if (one)
                all.push_back(*one);
    }
    return all;
}

// Returns the target of stroke i of a stimulus. If the method has its own strokes, it is stroke i of the
// motion (or the motion's last stroke), with the duration of the played stroke. Otherwise it is the played
// stroke.
stroke find_target(const motion_definition& motion, const method_definition& method, const stroke& played,
                   std::size_t i)
{
    if (method.strokes.empty())
        return played;
    stroke target = motion.strokes[std::min(i, motion.strokes.size() - 1)];
    target.motion = target.motion.with_duration(played.motion.duration_s());
    return target;
}

} // namespace

std::uint64_t default_seed(std::string_view code)
{
    const detail::sha256_digest d = detail::sha256(code);
    return std::uint64_t{d[0]} << 24 | std::uint64_t{d[1]} << 16 | std::uint64_t{d[2]} << 8 | d[3];
}

std::size_t count_square_rows(std::string_view order, std::size_t n) noexcept
{
    if (order == "random" || n < 2)
        return 1;
    return order == "williams" && n % 2 == 1 ? 2 * n : n;
}

std::vector<std::size_t> square_row(std::string_view order, std::size_t n, std::size_t row)
{
    // The first Williams row is 0, 1, n - 1, 2, n - 2, ..., in which each difference occurs once. The other
    // rows add 1, 2, ... to the first row, modulo n. For odd n, the same n rows follow in reverse.
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t williams = i == 0 ? 0 : i % 2 == 1 ? (i + 1) / 2 : n - i / 2;
        all.push_back(((order == "latin" ? i : williams) + row) % n);
    }
    if (row >= n)
        std::reverse(all.begin(), all.end());
    return all;
}

std::size_t count_rows(const experiment_definition& d)
{
    std::size_t blocks = 1;
    for (const run_definition& r : d.runs)
        blocks = std::lcm(blocks, count_square_rows(d.order, count_blocks(r)));
    return count_square_rows(d.order, d.runs.size()) * blocks;
}

std::string session_seed(std::uint64_t seed, const experiment_definition& d, std::string_view code)
{
    return fmt::format("{}/{}/{}{}", seed, d.outline.name, code,
                       d.session ? fmt::format("/ses-{}", *d.session) : "");
}

std::size_t default_row(const experiment_definition& d, std::string_view code)
{
    const std::size_t rows = count_rows(d);
    std::size_t row = default_seed(code) % rows;
    if (const std::size_t digits = code.find_last_not_of("0123456789") + 1; digits < code.size()) {
        std::size_t number = 0; // kept modulo rows, because it may have many digits
        for (const char c : code.substr(digits))
            number = (number * 10 + static_cast<std::size_t>(c - '0')) % rows;
        row = (number + rows - 1) % rows;
    }
    return (row + d.session.value_or(1) - 1) % rows + 1;
}

run_sequence make_run(const experiment_definition& d, std::size_t run, std::string_view code,
                      std::uint64_t seed, std::optional<std::size_t> row)
{
    const run_definition& r = d.runs[run];
    random_numbers numbers(fmt::format("{}/{}", session_seed(seed, d, code), r.outline.name));
    run_sequence s{run};
    const bool mixes_motions = r.motions.size() > 1 && r.blocks != "motions";
    auto blocks = split_into_blocks(d, r, find_run_task(r.outline).draw(r, r.outline.trials, numbers));
    if (mixes_motions &&
        !std::ranges::all_of(blocks, [&](const auto& b) { return has_order(b, r.max_in_a_row); }))
        blocks =
            split_into_blocks(d, r, draw_by_turns(d, r, find_run_task(r.outline).list_cells(r), numbers));
    // Skips one order of blocks after each pass through the square of the runs, so that each order of runs
    // meets each order of blocks.
    const std::size_t own_row = row.value_or(default_row(d, code)) - 1;
    const std::size_t runs = count_square_rows(d.order, d.runs.size());
    for (const std::size_t i :
         make_order(d.order, count_blocks(r), own_row / runs + own_row % runs, numbers)) {
        if (mixes_motions)
            order_trials(blocks[i], r.max_in_a_row, numbers);
        else
            shuffle(std::span(blocks[i]), numbers);
        s.trials.insert(s.trials.end(), blocks[i].begin(), blocks[i].end());
    }
    s.practice = find_run_task(r.outline).draw(r, r.practice, numbers);
    shuffle(std::span(s.practice), numbers);
    for (auto* list : {&s.trials, &s.practice})
        for (planned_trial& t : *list)
            find_run_task(r.outline).draw_initial_value(t, r, numbers);
    draw_rests(s.practice, d.rest, numbers);
    draw_rests(s.trials, d.rest, numbers);
    return s;
}

std::vector<run_sequence> make_sequence(const experiment_definition& d, std::string_view code,
                                        std::uint64_t seed, std::optional<std::size_t> row)
{
    random_numbers numbers(session_seed(seed, d, code));
    const std::size_t own_row = row.value_or(default_row(d, code));
    std::vector<run_sequence> all;
    for (const std::size_t run : make_order(d.order, d.runs.size(), own_row - 1, numbers))
        all.push_back(make_run(d, run, code, seed, own_row));
    return all;
}

session_flow::session_flow(std::vector<flow_run> runs, bool consent, unsigned tactors,
                           std::vector<flow_form> forms)
    : runs_(std::move(runs)), ask_consent_(consent), tactors_(tactors), forms_(std::move(forms))
{
    for (std::size_t i = 0; i < forms_.size(); ++i)
        if (!forms_[i].done())
            answered_.insert(answered_.end(), forms_[i].answered, i);
    skip_finished_runs(false);
}

bool session_flow::is_due(const flow_form& f) const
{
    return !f.done() &&
           (f.when == questionnaire_time::before ||
            (f.when == questionnaire_time::between && runs_[f.run].trials.done()) || run_ == runs_.size());
}

void session_flow::record_answer(const session_step& s)
{
    for (std::size_t i = 0; i < forms_.size(); ++i)
        if (forms_[i].form == s.form && forms_[i].run == s.run) {
            ++forms_[i].answered;
            answered_.push_back(i);
        }
}

bool session_flow::can_go_back() const
{
    const step_kind now = next().what;
    return !answered_.empty() && (now == step_kind::ask || now == step_kind::introduce ||
                                  now == step_kind::rest || now == step_kind::over);
}

bool session_flow::go_back()
{
    if (!can_go_back())
        return false;
    --forms_[answered_.back()].answered;
    answered_.pop_back();
    return true;
}

bool session_flow::is_asking() const
{
    return next().what == step_kind::ask ||
           std::ranges::any_of(forms_, [](const flow_form& f) { return f.answered > 0 && !f.done(); });
}

void session_flow::skip_finished_runs(bool rest)
{
    while (run_ < runs_.size() && runs_[run_].trials.done()) {
        if (rest && runs_[run_].rest && run_ + 1 < runs_.size()) {
            place_ = place::rest;
            return;
        }
        ++run_;
        place_ = place::introduce;
    }
}

session_step session_flow::next() const
{
    const auto form = std::ranges::find_if(forms_, [this](const flow_form& f) { return is_due(f); });
    const bool asks = form != forms_.end();
    if (run_ == runs_.size() && !asks)
        return {.what = step_kind::over};
    if (ask_consent_)
        return {.what = step_kind::consent};
    if (walked_ < tactors_ && run_ < runs_.size())
        return {.what = step_kind::walk, .tactor = walked_};
    if (place_ == place::rest && !asks)
        return {.what = step_kind::rest, .run = run_};
    if (paused_)
        return {.what = step_kind::pause, .run = run_};
    if (asks)
        return {.what = step_kind::ask, .run = form->run, .form = form->form, .item = form->answered};
    if (place_ == place::introduce)
        return {.what = step_kind::introduce, .run = run_};
    const flow_run& r = runs_[run_];
    session_step s{.what = step_kind::trial, .run = run_};
    s.practice = r.practised < r.practice;
    s.which = s.practice ? pending_trial{r.practised + 1, 1} : r.trials.next();
    return s;
}

void session_flow::go_on()
{
    const step_kind now = next().what;
    if (now == step_kind::pause) {
        paused_ = false;
        void_in_row_ = 0;
    } else if (now == step_kind::rest) {
        skip_finished_runs(false);
    } else if (now == step_kind::introduce) {
        place_ = place::trials;
        has_last_ = false;
    }
}

void session_flow::record_trial(bool is_void, bool ends_track)
{
    flow_run& r = runs_[run_];
    answered_.clear();
    void_in_row_ = is_void ? void_in_row_ + 1 : 0;
    paused_ = paused_ || void_in_row_ == most_void_in_row;
    if (r.practised < r.practice) {
        ++r.practised;
        return;
    }
    r.trials.remove_next(is_void, ends_track);
    last_run_ = run_;
    has_last_ = true;
    skip_finished_runs(true);
}

bool session_flow::void_last_trial()
{
    if (is_asking() || !has_last_ || !runs_[last_run_].trials.requeue_last())
        return false;
    has_last_ = false;
    if (run_ != last_run_ || place_ == place::rest) {
        run_ = last_run_;
        place_ = place::trials;
    }
    return true;
}

stimulus_set::stimulus_set(const experiment_definition& d, const array& a, const render_options& o)
    : array_(a), options_(o), gap_frames_(static_cast<std::uint64_t>(std::llround(d.gap_s * o.rate)))
{
    const layout faces(a);
    for (const run_definition& r : d.runs)
        for (const std::size_t motion : r.motions)
            for (const std::size_t method : list_played_methods(r))
                if (find(motion, method) == nullptr) {
                    all_.push_back(make(d, motion, method, r.outline.vary, faces));
                    add_duplicate_warnings(d);
                }
}

void stimulus_set::add_duplicate_warnings(const experiment_definition& d)
{
    const stimulus& last = all_.back();
    for (const stimulus& s : all_)
        if (s.motion == last.motion && s.method != last.method && s.hash == last.hash &&
            !d.methods[s.method].is_variant() && !d.methods[last.method].is_variant())
            warnings_.push_back(fmt::format("motion \"{}\": methods \"{}\" and \"{}\" make the same stimulus",
                                            d.motions[s.motion].name, d.methods[s.method].name,
                                            d.methods[last.method].name));
}

void stimulus_set::predict(stimulus& s, const motion_definition& motion,
                           const method_definition& method) const
{
    std::vector<percept_sample> all;
    for (std::size_t i = 0; i < s.made.strokes.size(); ++i) {
        const std::vector<percept_sample> samples =
            predict_percept(array_, find_target(motion, method, s.made.strokes[i], i), s.made.plans[i].plan);
        s.felt_paths.push_back(sample_path(samples));
        all.insert(all.end(), samples.begin(), samples.end());
    }
    s.felt = summarise(all);
}

stimulus stimulus_set::make(const experiment_definition& d, std::size_t motion_at, std::size_t method_at,
                            std::string_view vary, const layout& faces)
{
    const motion_definition& motion = d.motions[motion_at];
    const method_definition& method = d.methods[method_at];
    try {
        stimulus s{motion_at, method_at, {.strokes = choose_strokes(motion, method)}};
        session::place_strokes(s.made, faces, method.options);
        if (find_duration_s(s.made.strokes) > longest_stimulus_s)
            throw error(error_kind::bad_input, "stroke", "it lasts more than ten minutes", "make it shorter");
        session::plan_piece(s.made, array_, faces, method.options);
        s.render = merge_render_options(options_, method.options);
        const score sounds = session::make_score(s.made, array_, s.render);
        s.frames = sounds.frames();
        s.weakened_db = sounds.weakened().weakened_db;
        s.text = files::plans_text({s.made, array_, sounds, s.render});
        s.hash = detail::sha256_text(s.text);
        predict(s, motion, method);
        for (const placed_plan& p : s.made.plans)
            for (const std::string& w : p.plan.warnings) {
                const std::string warning =
                    fmt::format("motion \"{}\" with method \"{}\": {}", motion.name, method.name, w);
                if (std::ranges::find(warnings_, warning) == warnings_.end())
                    warnings_.push_back(warning);
            }
        return s;
    } catch (const error& e) {
        if (e.kind() != error_kind::bad_input)
            throw;
        const options::option* const option = options::find(e.field());
        const auto key = option != nullptr ? method.keys.find(options::index(*option)) : method.keys.end();
        const std::string hint = reword_hint(e.hint(), method.has_level());
        if (method.value) {
            try { // if this fails in the same words, the value is not the cause
                make(d, motion_at, *method.made_of, {}, faces);
            } catch (const error& without_value) {
                if (without_value.why().ends_with(e.why()))
                    throw;
            }
            const std::string cause =
                key == method.keys.end() || option == options::find(vary)
                    ? detail::plain(e.subject())
                    : fmt::format("{} (line {})", key->second.key, key->second.where.line);
            throw error(e.kind(), method.where,
                        fmt::format("{} = {} of motion \"{}\" with method \"{}\", {}: {}", vary,
                                    *method.value, motion.name, d.methods[*method.made_of].name, cause,
                                    e.why()),
                        hint);
        }
        const std::string of = fmt::format("motion \"{}\" with method \"{}\"", motion.name, method.name);
        if (key != method.keys.end())
            throw error(e.kind(), key->second.where,
                        fmt::format("{}, {}: {}", of,
                                    e.subject() == e.field() ? key->second.key : detail::plain(e.subject()),
                                    e.why()),
                        hint);
        throw error(
            e.kind(), motion.where,
            fmt::format("{} (line {}), {}: {}", of, method.where.line, detail::plain(e.subject()), e.why()),
            hint);
    }
}

const stimulus* stimulus_set::find(std::size_t motion, std::size_t method) const noexcept
{
    for (const stimulus& s : all_)
        if (s.motion == motion && s.method == method)
            return &s;
    return nullptr;
}

const stimulus& stimulus_set::at(std::size_t motion, std::size_t method) const
{
    return *find(motion, method);
}

std::vector<std::uint64_t> stimulus_set::starts(const planned_trial& t) const
{
    std::vector<std::uint64_t> all;
    std::uint64_t next = 0;
    for (const std::size_t method : t.list_methods()) {
        all.push_back(next);
        next += at(t.motion, method).frames + gap_frames_;
    }
    return all;
}

std::uint64_t stimulus_set::count_frames(const planned_trial& t) const
{
    return starts(t).back() + at(t.motion, t.list_methods().back()).frames;
}

score stimulus_set::make_score(const planned_trial& t, const std::optional<drive_limits>& limits) const
{
    const auto alone = [&](std::size_t method) {
        const stimulus& s = at(t.motion, method);
        render_options o = s.render;
        o.limits = limits;
        return session::make_score(s.made, array_, o);
    };
    if (!t.method_2)
        return alone(t.method_1);
    const std::vector<std::size_t> methods = t.list_methods();
    const std::vector<std::uint64_t> begin = starts(t);
    std::vector<synth::placed_score> parts;
    for (std::size_t i = 0; i < methods.size(); ++i)
        parts.push_back({alone(methods[i]), begin[i]});
    return synth::join_scores(parts);
}

} // namespace tactor::study
