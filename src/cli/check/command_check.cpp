// SPDX-License-Identifier: MIT
#include "cli/check/check.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "cli/play/play.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/members.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "files/setup_text.hpp"
#include "files/text_file.hpp"
#include "session/device.hpp"
#include "session/process.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace tactor::cli {
namespace {

using detail::about;

std::size_t count(const std::vector<finding>& all, level l)
{
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [l](const auto& f) { return f.how == l; }));
}

std::string summary(const std::vector<finding>& all)
{
    return fmt::format("{}, {}, {} ok", counted(count(all, level::error), "error"),
                       counted(count(all, level::warning), "warning"), count(all, level::ok));
}

template <class Io>
void describe_walk_members(Io& io, const walk_outcome& w)
{
    const session::walk_map& v = w.verdict;
    io.list("answers", w.felt, {"for each tactor, in order"},
            [&w](auto& inner, const std::optional<unsigned>& felt, std::size_t number) {
                constexpr about driven{"its number, and the channel that played"};
                inner("tactor", number, driven);
                inner.describe_derived(
                    "channel", [&] { return w.tactors.tactors[number].channel; }, driven);
                inner.describe_or_null("felt", felt, {"the tactor that was felt; null for none"});
            });
    io("problems", v.problems, {"why there is no map; empty if there is one"});
    io.describe_or_null("channels", v.channels.empty() ? std::nullopt : std::optional(v.channels),
                        {"the right channel of each tactor; null without a map"});
    io("changed", v.changed, {"whether these differ from those of the array"});
}

template <class Io>
void describe_check_members(Io& io, const std::vector<finding>& all, const std::optional<walk_outcome>& walk)
{
    constexpr about many{"number of them"};
    io.constant("schema", "tactor-check/1");
    io("errors", count(all, level::error), many);
    io("warnings", count(all, level::warning), many);
    io.list("findings", all, {"the checks"}, [](auto& inner, const finding& f, std::size_t) {
        inner("check", f.check, {"name of the check, as in tactor-check(1)"});
        inner.one_of("level", to_string(f.how), {"ok", "warning", "error"}, {"ok, warning or error"});
        inner("found", f.found, {"the finding"});
        inner.describe_or_null("cure", detail::omit_empty(f.cure), {"what to do about it; else null"});
    });
    io.describe_if_present("walk", walk.has_value(), {"only after --walk with answers"},
                           [&walk](auto& inner) { describe_walk_members(inner, *walk); });
}

// Returns one or two lines for each finding. A line has at most 80 columns.
std::string findings_text(const std::vector<finding>& all)
{
    std::string s;
    for (auto f = all.begin(); f != all.end(); ++f) {
        s += wrap_text(fmt::format("{:<8} {:<14} ", to_string(f->how), f->check), make_printable(f->found));
        const auto first =
            std::find_if(all.begin(), f, [&](const finding& earlier) { return earlier.cure == f->cure; });
        if (!f->cure.empty())
            s += wrap_text(fmt::format("{:<24}-> ", ""), first == f ? f->cure : "as for " + first->check);
    }
    return s;
}

finding lost_tactor_finding(const alsa_options& device, const std::string& lost)
{
    return failure("device", {error_kind::not_available, fmt::format("PCM \"{}\"", device.pcm), lost,
                              "in the PCM's ttable or bindings, route each channel to its own channel of the "
                              "device with coefficient 1, "
                              "or use -D hw:CARD=NAME to play on the card itself"});
}

std::string note_text(const std::vector<session::device_note>& notes)
{
    std::string text;
    for (const session::device_note& n : notes)
        text += "; " + n.text;
    return text;
}

finding check_open(const alsa_options& device, const session::stream_options& o, const environment& e,
                   bool named, std::string& kept_as)
{
    const std::string server = session::prepare_server(device.pcm);
    session::card_claim card{.ask = !o.no_desktop};
    const stream_setup made = session::open_device(device, e.tactors, card)->setup();
    kept_as = made.device;
    if (const std::string lost = lost_tactor(e.tactors, made.wiring); !lost.empty())
        return lost_tactor_finding(device, lost);
    const std::string found =
        describe(made) +
        (card.holder.empty() ? "" : fmt::format("; {} has given up the card for this check", card.holder)) +
        (server.empty() ? "" : "; " + session::server_note(server));
    if (!named)
        return warning("device", "none is configured, so play uses " + found,
                       "choose a device from tactor devices with -D, or with pcm under [output]");
    const std::string late = session::latency_warning(o.latency_ms, made);
    if (!late.empty())
        return warning("device", found + "; " + late, "use a device with shorter periods, or more latency");
    if (!server.empty())
        return warning("device", found, session::server_cure);
    const std::vector<session::device_note> notes = session::wiring_notes(e.tactors, made);
    if (!notes.empty())
        return warning("device", found + note_text(notes), notes.front().cure);
    return passed("device", found);
}

std::string line_place_text(const gpio_line_place& p)
{
    return fmt::format("line {}{} of {} ({})", p.line.offset,
                       p.line.name.empty() ? "" : fmt::format(" \"{}\"", p.line.name), p.label, p.path);
}

finding check_line(const char* check, const gpio_line_name& name, line_finder find)
{
    try {
        const gpio_line_place p = find(name);
        if (p.line.consumer.empty())
            return passed(check, line_place_text(p) + ", free");
        const bool own = p.line.consumer == "tactor";
        return {check, level::error, fmt::format("{}: held by \"{}\"", line_place_text(p), p.line.consumer),
                own ? "stop that tactor first" : "stop that program, or choose another line",
                error_kind::not_available};
    } catch (const error& e) {
        return failure(check, e);
    }
}

// Opens and closes the device without playing, unless the device writes a file. `named` is false for the
// default device. If the device can be opened, sets `kept_as` to stream_setup::device.
finding check_device(const alsa_options& device, const session::stream_options& o, const environment& e,
                     bool named, std::string& kept_as)
{
    if (read_route(device.pcm).writes) {
        const stream_setup there{.name = device.pcm, .wiring = read_wiring(device.pcm, device.channels)};
        if (const std::string lost = lost_tactor(e.tactors, there.wiring); !lost.empty())
            return lost_tactor_finding(device, lost);
        return warning("device",
                       fmt::format("{}: not opened, because that would empty its file or start its command",
                                   device.pcm) +
                           note_text(session::wiring_notes(e.tactors, there)),
                       "check that you want this before you play");
    }
    try {
        return check_open(device, o, e, named, kept_as);
    } catch (const error& failed) {
        return failure("device", failed);
    }
}

// Adds the checks that need no array. They run even if a file cannot be read.
void check_machine(const setup& config, const alsa_options& device, const session::stream_options& o,
                   std::vector<finding>& all)
{
    system_needs n;
    n.pcm = device.pcm;
    n.card = read_card(device.pcm);
    if (n.card) {
        n.holders = card_holders(n.card->index);
        n.ignored = is_ignored_by_servers(n.card->index);
    }
    n.amplifier = config.amplifier && !o.no_gpio;
    n.gpio = n.amplifier || (!o.no_gpio && config.sync && (config.sync->out || config.sync->in));
    n.require_realtime = o.require_realtime;
    session::configure_realtime_kit(o);
    for (finding& f : check_system(read_system(), n))
        all.push_back(std::move(f));
}

alsa_options find_device_options(const settings& s, const environment& e)
{
    const render_options r = session::find_render_options(s, e);
    return session::device_options(s, s.stream, e, r.channels, r.rate);
}

finding check_drive_time(const std::string& device)
{
    const std::string why = drive_time_fault(device);
    return why.empty() ? passed("drive time", "continues from run to run")
                       : warning("drive time", why + ": a run does not know the drive time of others",
                                 "set XDG_RUNTIME_DIR to a folder that belongs to you and has space, as a "
                                 "login does, and remove an unreadable file from it");
}

std::vector<finding> check_all(const settings& s, const environment& e)
{
    std::vector<finding> all = check_array(s, e);
    alsa_options device;
    try {
        device = find_device_options(s, e);
        std::string kept_as = device.pcm; // stays so if the device cannot be opened now
        all.push_back(check_device(device, s.stream, e, session::has_configured_pcm(s, e), kept_as));
        if (session::is_felt(device.pcm) && !kept_as.empty())
            all.push_back(check_drive_time(kept_as));
    } catch (const error& x) {
        all.push_back(failure("device", x));
    }
    if (!s.stream.no_gpio)
        for (finding& f : check_lines(e.config, session::is_felt(device.pcm)))
            all.push_back(std::move(f));
    check_machine(e.config, device, s.stream, all);
    return all;
}

// Reads the file that contains the array. If there is no such file, reads the configuration, unless --array
// names a preset.
setup read_array_source(const settings& s, const environment& e)
{
    if (!e.array_file.empty())
        return load_setup(e.array_file);
    return s.array_name || e.config_name.empty() ? setup{} : load_setup(e.config_name);
}

// Writes an array file with new channels. Everything else is copied from the file in use, so that the new
// file refers to no other file.
void write_channels(const std::string& name, const settings& s, const environment& e,
                    const std::vector<unsigned>& channels)
{
    const setup besides = read_array_source(s, e);
    array felt = e.tactors;
    for (std::size_t i = 0; i < channels.size(); ++i)
        felt.tactors[i].channel = channels[i];
    const std::string text = "# Channels as felt on a walk (tactor check --walk).\n" +
                             detail::array_text(felt, besides) +
                             (besides.calibration ? detail::format_calibration(*besides.calibration) : "");
    study::write_new_output(name, text);
}

void finish_walk(const settings& s, const check_options& o, const environment& e, const session::walk_map& v)
{
    if (!v.problems.empty())
        throw error(error_kind::runtime, "channel map", fmt::format("{}", fmt::join(v.problems, "; ")),
                    "check wires and amplifier channels, then walk again; no map was written");
    if (!o.output.empty())
        write_channels(o.output, s, e, v.channels);
    if (o.json())
        return;
    say(stdout, "{}\n",
        v.changed ? fmt::format("The map is wrong: tactors 0 to {} are on channels {}.",
                                v.channels.size() - 1, fmt::join(v.channels, ", "))
                  : "The map is right.");
    if (!o.output.empty())
        say(stdout, "Written: {}\n", o.output);
    else if (v.changed)
        say(stdout, "-o FILE writes it as an array file.\n");
}

int run_walk(const settings& s, const check_options& o, const environment& e, const std::vector<finding>& all)
{
    const walk_result w = walk(find_device_options(s, e), s, e, session::find_render_options(s, e), o);
    if (w.signal != 0)
        return session::interrupt::status(w.signal);
    if (o.no_questions) {
        if (o.json())
            fmt::print("{}", check_json(all, {}));
        return status_ok;
    }
    const session::walk_map v = session::map_channels(e.tactors, w.felt);
    if (o.json())
        fmt::print("{}", check_json(all, walk_outcome{e.tactors, w.felt, v}));
    finish_walk(s, o, e, v);
    return status_ok;
}

void check_usage(const settings& s, const check_options& o)
{
    if (!o.walk && (o.no_questions || !o.output.empty() || o.max_dbfs))
        refuse_option(o.no_questions      ? "--auto"
                      : !o.output.empty() ? "--output"
                                          : "--max-dbfs",
                      "only a walk uses it", "add --walk");
    if (!o.walk && (s.stream.verbose || !s.stream.log.empty()))
        refuse_option(s.stream.verbose ? "--verbose" : "--log", "nothing plays without a walk", "add --walk");
    if (o.no_questions && !o.output.empty())
        refuse_option("--output", "--auto asks no questions, so there is no map to write",
                      "leave out --auto or --output");
    if (!o.output.empty())
        study::check_new_output(o.output);
}

int check(settings& s, const check_options& o)
{
    check_usage(s, o);
    if (s.array_name)
        detail::note_input(*s.array_name); // prevents the output from replacing it
    std::vector<finding> all;
    std::optional<environment> e;
    try {
        e = session::read_environment(s);
        for (tactor_spec& t : e->tactors.tactors)
            t.max_dbfs = std::min(t.max_dbfs, o.max_dbfs.value_or(t.max_dbfs));
        all = check_all(s, *e);
    } catch (const error& x) {
        all = {failure("array", x)};
        check_machine({}, {.pcm = s.pcm.value_or("null")}, s.stream, all);
    }
    const auto first =
        std::find_if(all.begin(), all.end(), [](const auto& f) { return f.how == level::error; });
    const bool walks = o.walk && first == all.end();
    if (!o.json())
        say(stdout, "{}", check_text(all, o.walk));
    else if (!walks)
        fmt::print("{}", check_json(all, {}));
    flush_output();
    if (first != all.end())
        say(stderr, "tactor: {}: {}{}\n", first->check, first->found,
            first->cure.empty() ? "" : fmt::format(" ({})", first->cure));
    return walks ? run_walk(s, o, *e, all) : worst_status(all);
}

} // namespace

std::string_view to_string(level l)
{
    return l == level::ok ? "ok" : l == level::warning ? "warning" : "error";
}

int worst_status(const std::vector<finding>& all)
{
    for (const error_kind k : {error_kind::bad_input, error_kind::not_available, error_kind::runtime})
        if (std::any_of(all.begin(), all.end(),
                        [k](const finding& f) { return f.how == level::error && f.kind == k; }))
            return find_exit_status(k);
    return status_ok;
}

std::string check_text(const std::vector<finding>& all, bool brief)
{
    std::vector<finding> shown;
    std::copy_if(all.begin(), all.end(), std::back_inserter(shown),
                 [&](const finding& f) { return !brief || f.how != level::ok; });
    return fmt::format("{}{}{}\n", findings_text(shown), shown.empty() ? "" : "\n", summary(all));
}

std::string check_json(const std::vector<finding>& all, const std::optional<walk_outcome>& walked)
{
    return files::make_object([&](auto& io) { describe_check_members(io, all, walked); }).dump(2) + "\n";
}

nlohmann::ordered_json check_schema()
{
    const array none;
    const session::walk_answers felt;
    const session::walk_map verdict;
    return files::json_schema::describe_object([&](auto& io) {
        describe_check_members(io, {}, walk_outcome{none, felt, verdict});
    });
}

std::vector<finding> check_lines(const setup& config, bool felt, line_finder find)
{
    std::vector<finding> all;
    if (!config.amplifier)
        all.push_back({"amplifier", felt ? level::warning : level::ok,
                       "no [amplifier]: nothing switches the amplifier off",
                       "wire its enable input to a GPIO line, see tactor-raspberry-pi(7)"});
    else {
        finding f = check_line("amplifier", config.amplifier->line, find);
        if (f.how == level::ok && config.amplifier->active_low)
            f = warning("amplifier", f.found + ", on when low: a floating line may switch it on",
                        "use an amplifier that is on when high, with a pull-down resistor");
        all.push_back(std::move(f));
    }
    if (config.sync && config.sync->out)
        all.push_back(check_line("sync out", *config.sync->out, find));
    if (config.sync && config.sync->in)
        all.push_back(check_line("sync in", *config.sync->in, find));
    return all;
}

int run_check(command_line& line)
{
    check_options o;
    CLI::App& c = line.app;
    settings& s = add_options(line, options::on_check);
    c.add_flag("--walk", o.walk, "then play each tactor in turn and ask where you feel it");
    c.add_flag("--auto", o.no_questions, "with --walk: ask no questions");
    c.add_option("-o,--output", o.output, "with --walk: array file to write, with the channels as felt")
        ->type_name("FILE.toml");
    add_text_option(
        c, "--max-dbfs", "DB", "with --walk: highest peak of every tactor, in the walk and in the file",
        [&o](const std::string& t) {
            o.max_dbfs = options::parse_number("--max-dbfs", t, detail::bounds_of::level_dbfs, "dBFS");
        });
    add_format_option(c, o.format, {"text", "json"}, "format of the output (default text)");
    c.footer("tactor check -D hw:CARD=Tactor\n"
             "tactor check --walk -o felt.toml --level-dbfs -40 --max-dbfs -12 -D hw:CARD=Tactor\n"
             "tactor check --format json");
    line.parse();
    return check(s, o);
}

} // namespace tactor::cli
