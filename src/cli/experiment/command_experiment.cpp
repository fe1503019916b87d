// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/experiment/experiment_options.hpp"
#include "cli/experiment/real_session.hpp"
#include "cli/say.hpp"
#include "cli/warnings.hpp"
#include "core/words.hpp"
#include "session/interrupt.hpp"
#include "study/session/prepared.hpp"
#include "study/session/trials.hpp"

namespace tactor::cli {
namespace {

std::size_t describe_trials(const study::prepared_experiment& p)
{
    std::size_t n = 0;
    for (const study::run_sequence& s : p.runs)
        n += s.trials.size();
    return n;
}

int hold_session(const study::prepared_experiment& p, const experiment_options& o, const settings& s)
{
    const study::sound_servers between = o.simulate ? study::sound_servers{} : check_real_session(p, o, s);
    net::owned_fd listening = o.simulate ? net::owned_fd() : open_page(o.page);
    study::study_folder folder(o.folder, p.definition, o.simulate.has_value());
    for (const std::string& w : folder.warnings())
        say(stderr, "tactor: warning: {}: {}\n", o.folder, w);
    study::session_store store(folder, p.participant, study::describe_session(p, o.simulate, o.masker),
                               o.resume);
    const std::string who =
        fmt::format("sub-{}{}", p.participant, o.simulate ? ": SIMULATED, nobody was asked" : "");
    std::vector<const study::run_definition*> runs;
    for (const study::run_sequence& r : p.runs)
        runs.push_back(&p.definition.runs[r.run]);
    store.check_tables(runs);
    if (store.resumed() && study::finished(p, store)) {
        store.refuse_cut_lines(runs);
        for (const std::filesystem::path& lost : store.missing(p.stimuli.all()))
            say(stderr, "tactor: warning: {}: it is missing (put it back from a copy)\n", lost.string());
        say(stdout, "{}: the session is finished\n", who);
        return status_ok;
    }
    store.try_to_write(p.definition.runs);
    if (store.resumed())
        for (const std::string& what : store.mend(runs))
            say(stderr, "tactor: warning: {}\n", what);
    study::stage::left why{0};
    if (o.simulate) {
        store.begin(p.stimuli.all());
        why.signal = study::simulate_session(p, *o.simulate, store);
    } else {
        why = hold_real_session(p, o, s, between, std::move(listening), store);
    }
    if (why.signal != 0) {
        if (!store.begun())
            say(stderr, "tactor: ended by {}, before anything was answered: nothing is written\n", why.by);
        else
            say(stderr, "tactor: ended by {}: what was answered is in {}, and --resume goes on\n", why.by,
                o.folder);
        return session::interrupt::status(why.signal);
    }
    say(stdout, "{}: {} in {}, in {}\n", who, counted(describe_trials(p), "trial"),
        counted(p.runs.size(), "run"), o.folder);
    return status_ok;
}

int run(const experiment_options& o, const power_options& power, settings& s)
{
    check_power_options(s, power, o);
    if (power.participants.empty())
        check_experiment_options(s, o);
    if (o.print) {
        fmt::print("{}", study::load_definition(o.definition).text);
        return status_ok;
    }
    const auto who = o.dry_run    ? study::audience::nobody
                     : o.simulate ? study::audience::observer
                                  : study::audience::person;
    const study::prepared_experiment p =
        study::prepare({o.definition, o.participant, o.seed, who, o.hand}, s);
    say_warnings(p.warnings);
    if (!power.participants.empty())
        return tell_power(p, power, o);
    if (!o.dry_run)
        return o.check_noise ? check_noise(p, o, s) : hold_session(p, o, s);
    if (o.format == "json")
        print_dry_run_json(stdout, p);
    else
        print_dry_run_text(stdout, p);
    return status_ok;
}

} // namespace

command add_experiment(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("experiment", "Run an experiment with a participant or a simulated one");
    auto s = std::make_shared<settings>();
    auto o = std::make_shared<experiment_options>();
    auto power = std::make_shared<power_options>();
    add_experiment_options(*c, *o);
    add_power_options(*c, *power);
    add_options(*c, *s, options::on_experiment);
    require_device(*c);
    c->footer("tactor experiment park2016 --dry-run\n"
              "tactor experiment park2016 --participant 01 -o trial --simulate seed=1,sigma=1\n"
              "tactor experiment park2016 --participant P07 -o pilot --array P07.toml -D hw:CARD=Tactor");
    return [s, o, power] { return run_with(*s, [&] { return run(*o, *power, *s); }); };
}

} // namespace tactor::cli
