// SPDX-License-Identifier: MIT
#include "cli/experiment/experiment_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "study/bids/study_folder.hpp"

namespace tactor::cli {
namespace {

std::uint64_t seed_in(const std::string& text)
{
    constexpr std::uint64_t most = (std::uint64_t{1} << 53) - 1;
    const auto v = detail::number_in<std::uint64_t>(text);
    if (!v || *v > most)
        refuse_option("--seed", fmt::format("\"{}\" is no seed", text),
                      fmt::format("a whole number from 0 to {}", most));
    return *v;
}

} // namespace

void add_experiment_options(CLI::App& command, experiment_options& o)
{
    command
        .add_option("EXPERIMENT", o.definition, "park2016, or a definition: a file, see tactor-experiment(5)")
        ->required()
        ->type_name("");
    add_text(command, "--participant", "CODE", "the participant: letters and digits",
             [&o](const std::string& t) {
                 study::check_code(t);
                 o.participant = t;
             });
    command.add_option("-o,--output", o.folder, "folder of the study (BIDS), the same for all participants")
        ->type_name("DIR");
    command.add_flag("--resume", o.resume, "continue the participant's session at its next trial");
    add_text(command, "--hand", "left|right",
             "hand that wears the array; a left one has the mirrored motions of the definition",
             [&o](const std::string& t) {
                 o.hand = choose("--hand", t, {"left", "right"}) == 0 ? study::hand_kind::left
                                                                      : study::hand_kind::right;
             });
    add_page_options(command, o.page);
    add_keypad_option(command, o.keypads);
    add_text(command, "--masker", "PCM",
             "play the definition's masking noise on this second device, in stereo",
             [&o](const std::string& t) {
                 if (t.empty())
                     refuse_option("--masker", "no device is named", "as hw:CARD=Phones");
                 o.masker = t;
             });
    command.add_flag("--check-noise", o.check_noise,
                     "play the masking noise with stimuli until its level is right");
    command.add_flag("--allow-sound-server", o.allow_sound_server,
                     "allow a sound server, which may hide xruns; the data record it");
    add_text(command, "--seed", "N",
             "seed of the order of trials (default: the definition's, else from the code)",
             [&o](const std::string& t) { o.seed = seed_in(t); });
    add_text(command, "--simulate", "SPEC", "let a model answer: seed=1,sigma=1",
             [&o](const std::string& t) { o.simulate = study::parse_simulation(t); });
    command.add_flag("--print", o.print, "print the definition, to copy and change it");
    command.add_flag("--dry-run", o.dry_run, "check everything and list each trial in order, without sound");
    add_format_option(command, o.format, {"text", "json"}, "format of --dry-run and --power (default text)");
}

void check_experiment_options(const settings& s, const experiment_options& o)
{
    if (o.check_noise && o.simulate)
        refuse_option("--check-noise", "in a simulated session nobody hears it", "leave one of them out");
    if (o.check_noise && o.masker.empty())
        refuse_option("--check-noise", "there is no device for the noise", "--masker PCM");
    if (o.format == "json" && !o.dry_run)
        refuse_option("--format", "only --dry-run and --power have one", "leave it out");
    if (o.resume && (o.print || o.dry_run || o.check_noise))
        refuse_option("--resume", "no session is held", "leave it out");
    if (const std::string asked = asked_of_stream(s); !asked.empty() && (o.simulate || o.print || o.dry_run))
        refuse_option(asked, "nothing is played", "leave it out");
    check_page_options(o.page, o.simulate.has_value() && !o.print && !o.dry_run);
    if (o.print || o.dry_run || o.check_noise)
        return;
    if (o.simulate && !o.keypads.empty())
        refuse_option("--keypad", "in a simulated session nobody is asked", "leave one of them out");
    if (o.participant.empty())
        refuse_option("--participant", "it is not said who takes part",
                      "a code of letters and digits, as P07");
    if (o.folder.empty())
        refuse_option("-o", "it is not said where the data go", "the folder of the study");
}

} // namespace tactor::cli
