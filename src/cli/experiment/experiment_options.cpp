// SPDX-License-Identifier: MIT
#include "cli/experiment/experiment_options.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/experiment/power.hpp"
#include "cli/say.hpp"
#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/sha256.hpp"
#include "options/option.hpp"
#include "study/bids/study_folder.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/experiment_session.hpp"

namespace tactor::cli {

void add_experiment_options(CLI::App& command, experiment_options& o)
{
    command
        .add_option("EXPERIMENT", o.session.definition,
                    "park2016, or the file of a definition, see tactor-experiment(5)")
        ->required()
        ->type_name("");
    add_text_option(command, "--participant", "CODE", "the participant: letters and digits",
                    [&o](const std::string& t) {
                        study::check_code(t);
                        o.session.participant = t;
                    });
    command.add_option("-o,--output", o.folder, "folder of the study (BIDS), the same for all participants")
        ->type_name("DIR");
    CLI::Option* resume =
        command.add_flag("--resume", o.resume, "continue the participant's session at its next trial");
    CLI::Option* begin = command.add_flag(
        "--new", o.new_session, "begin the participant's session, with --resume only if there is none");
    add_text_option(command, "--hand", "left|right",
                    "hand that wears the array; left mirrors the motions that the definition marks",
                    [&o](const std::string& t) {
                        o.session.hand = choose("--hand", t, {"left", "right"}) == 0
                                             ? study::hand_kind::left
                                             : study::hand_kind::right;
                    });
    command.add_option("--group", o.session.group, "the participant's group, for a definition with groups")
        ->type_name("NAME");
    add_text_option(
        command, "--session", "N", "number of the session, for a definition with several",
        [&o](const std::string& t) {
            o.session.session = static_cast<unsigned>(options::parse_whole("--session", t, {1, 99}, ""));
        });
    add_text_option(
        command, "--order", "N",
        "row of the orders, such as that of a replaced participant (default: from the code)",
        [&o](const std::string& t) { // prepare() checks the number against the number of rows
            o.session.row = static_cast<std::size_t>(options::parse_whole("--order", t, {1, 1000000}, ""));
        });
    add_page_options(command, o.page);
    add_keypad_option(command, o.keypads);
    CLI::Option* masker = add_masker_option(
        command, o.masker, "play the definition's masking noise on this second device, in stereo");
    CLI::Option* check = command
                             .add_flag("--check-noise", o.check_noise,
                                       "play the masking noise with stimuli until its level is right")
                             ->needs(masker)
                             ->excludes(resume)
                             ->excludes(begin);
    command.add_flag("--allow-sound-server", o.allow_sound_server,
                     "allow a sound server, which may hide xruns; the data record it");
    add_text_option(
        command, "--seed", "N", "seed of the order of trials (default: the definition's, else from the code)",
        [&o](const std::string& t) {
            constexpr double most = (std::uint64_t{1} << 53) - 1;
            o.session.seed = static_cast<std::uint64_t>(options::parse_whole("--seed", t, {0, most}, ""));
        });
    add_text_option(command, "--simulate", "SPEC", "let a model answer: seed=1,sigma=1",
                    [&o](const std::string& t) { o.simulate = study::parse_simulation(t); })
        ->excludes(check);
    command.add_flag("--print", o.print, "print the definition, for you to copy and edit")
        ->excludes(resume)
        ->excludes(begin);
    command.add_flag("--dry-run", o.dry_run, "check everything and list each trial in order, without sound")
        ->excludes(resume)
        ->excludes(begin);
    add_format_option(command, o.format, {"text", "json"}, "format of --dry-run and --power (default text)");
    add_power_options(command, o);
}

void check_experiment_options(const settings& s, const experiment_options& o)
{
    const bool power = !o.power.empty();
    if (o.format == "json" && !o.dry_run && !power)
        refuse_option("--format", "only --dry-run and --power use it", "leave out --format");
    if (const std::string asked = find_stream_option(s);
        !asked.empty() && (o.simulate || o.print || o.dry_run))
        refuse_option(asked, "a simulated session plays nothing", fmt::format("leave out {}", asked));
    check_page_options(o.page, o.simulate.has_value() && !o.print && !o.dry_run);
    if (power && !o.folder.empty() && o.parts == 0)
        refuse_option("-o", "--power prints its result, and writes no file",
                      "leave out -o, or add --part K/N");
    if (o.print || o.dry_run || o.check_noise || power)
        return;
    if (o.simulate && !o.keypads.empty())
        refuse_option("--keypad", "a simulated session has no participant",
                      "leave out --keypad or --simulate");
    if (o.session.participant.empty())
        refuse_option("--participant", "the participant is missing",
                      "give a code of letters and digits, such as P07");
    if (o.folder.empty())
        refuse_option("-o", "the folder for the data is missing", "give the folder of the study");
}

experiment_name make_experiment_name(const study::experiment_definition& d)
{
    return {d.outline.name, d.title, detail::sha256_text(d.text)};
}

} // namespace tactor::cli
