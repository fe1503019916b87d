// SPDX-License-Identifier: MIT
#include "cli/experiment/real_session.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>

#include "cli/play/live_picture.hpp"
#include "cli/say.hpp"
#include "session/device.hpp"
#include "session/interrupt.hpp"
#include "study/experiment/definition.hpp"
#include "study/session/key_input.hpp"
#include "study/session/person_session.hpp"

namespace tactor::cli {

namespace {

constexpr double patience_s = 3600.0; // for a device that was lost; Ctrl-C ends it before
constexpr unsigned most_keys = 9;

void check_keys(const study::prepared_experiment& p)
{
    for (const study::run_definition& r : p.definition.runs)
        if (study::choices_in(r) > most_keys)
            throw error(error_kind::bad_input, r.where,
                        fmt::format("run \"{}\" has {} answers, and the terminal's keys are 1 to {}",
                                    r.outline.name, study::choices_in(r), most_keys),
                        "motions = [...] with fewer of them");
}

void check_noise(const study::prepared_experiment& p, const experiment_options& o)
{
    const bool none = p.definition.masking.noise == study::noise_kind::none;
    if (none && !o.masker.empty())
        throw error(error_kind::bad_input, "--masker", "the definition has no masking noise",
                    "[masking], or leave it out");
    if (!none && o.masker.empty())
        say(stderr, "tactor: warning: the definition's masking noise has no device: whoever sits near hears "
                    "the array (--masker PCM)\n");
}

constexpr const char* masker_cure =
    "--masker hw:CARD=NAME plays on the card itself; tactor devices lists them";

// The server between the program and a card, where it may be there.
std::string check_server(const std::string& pcm, const char* cure, const experiment_options& o)
{
    std::string server = session::settle_server(pcm);
    if (!server.empty() && !o.allow_sound_server)
        throw error(error_kind::bad_input, pcm, session::server_note(server),
                    fmt::format("{}; --allow-sound-server takes it, and writes it down", cure));
    session::warn_of_server(server, cure);
    return server;
}

void warn_of_null(const std::string& pcm)
{
    if (!session::is_felt(pcm))
        say(stderr, "tactor: warning: playing to \"{}\", which nobody feels (-D PCM plays on hardware)\n",
            pcm);
}

// Warns of the authors of the shipped definition, which would stay in the data.
void warn_of_authors(const study::prepared_experiment& p)
{
    const std::vector<std::string>& said = p.definition.authors;
    if (!said.empty() && said == study::load_definition("park2016").authors)
        say(stderr,
            "tactor: warning: the data will say \"{}\" for their authors (authors in a copy of the "
            "definition)\n",
            said.front());
}

// Whoever is asked about the target must have seen it.
void warn_of_animation(const study::prepared_experiment& p)
{
    const auto& runs = p.definition.runs;
    if (!can_draw() && std::any_of(runs.begin(), runs.end(), [](const auto& r) { return r.animation; }))
        say(stderr, "tactor: warning: the target cannot be drawn: standard output is no terminal that can "
                    "move its cursor\n");
}

class noise_check {
public:
    noise_check(const study::prepared_experiment& p, study::stage& s)
        : p_(p), stage_(s), stimuli_(p.stimuli.all())
    {
    }

    // Until q, or the end of the lines.
    void hold()
    {
        turn(true);
        for (;;) {
            const std::optional<std::string> said = keys_.next();
            if (!said && keys_.ended())
                return;
            if (!said)
                stage_.wait_for(STDIN_FILENO);
            else if (*said == "n")
                turn(!on_);
            else if (*said == "s")
                play();
            else if (*said == "q")
                return;
        }
    }

private:
    void turn(bool on)
    {
        on_ = on;
        if (!on)
            stage_.fade_out();
        else if (!stage_.fade_in())
            throw error(error_kind::runtime, "--masker", "the noise does not sound",
                        "tactor devices lists them");
        show(on ? "noise\n" : "silence\n");
    }

    // Each in turn.
    void play()
    {
        const score s(p_.where.tactors, stimuli_[at_]->plan, p_.render);
        at_ = (at_ + 1) % stimuli_.size();
        const study::given_stimulus g = stage_.give(s, 0.0, [](std::uint64_t) {});
        show(fmt::format("a stimulus of {:.2f} s{}\n", static_cast<double>(s.frames()) / s.rate(),
                         g.flaw.empty() ? "" : ": " + g.flaw));
        if (stage_.lost())
            throw error(error_kind::runtime, p_.pcm, g.flaw);
        if (!on_)
            stage_.fade_out();
    }

    const study::prepared_experiment& p_;
    study::stage& stage_;
    std::vector<const study::stimulus*> stimuli_;
    study::key_input keys_;
    std::size_t at_ = 0;
    bool on_ = false;
};

class target_picture {
public:
    target_picture(const array& a, const stroke& target)
        : motion_(target.motion), faces_(a), picture_(a), now_{std::vector<double>(a.tactors.size(), 0.0), {}}
    {
    }

    bool active() const noexcept { return picture_.active(); }

    void draw(double t_s)
    {
        const point p = motion_.position(t_s);
        now_.target = faces_.contains(p) ? p : faces_.nearest(p);
        picture_.draw(now_, t_s, motion_.duration_s());
    }

private:
    const trajectory& motion_;
    layout faces_;
    live_picture picture_;
    instant now_;
};

} // namespace

study::sound_servers check_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                        const settings& s)
{
    if (!session::names_device(s, p.where))
        throw error(error_kind::bad_input, "-D", "no device is configured", "-D PCM, or --simulate SPEC");
    check_keys(p);
    check_noise(p, o);
    study::sound_servers between{check_server(p.pcm, session::server_cure, o), {}};
    if (!o.masker.empty())
        between.masker = check_server(o.masker, masker_cure, o);
    warn_of_null(p.pcm);
    warn_of_authors(p);
    if (!o.page.shown())
        warn_of_animation(p);
    return between;
}

std::unique_ptr<study::stage> open_stage(const study::prepared_experiment& p, const experiment_options& o,
                                         const settings& s)
{
    session::stream_options how = s.stream;
    how.reopen_s = patience_s;
    const alsa_options device = session::device_options(s, how, p.where, p.render.channels, p.render.rate);
    auto there = std::make_unique<study::stage>(device, how, p.where);
    if (!o.masker.empty())
        there->mask(o.masker, study::noise_options(
                                  p.definition.masking,
                                  fmt::format("{}/{}/{}/noise", p.seed, p.definition.name, p.participant)));
    return there;
}

study::stage::left hold_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                     const settings& s, const study::sound_servers& between,
                                     net::owned_fd listening, study::session_store& store)
{
    const std::unique_ptr<study::stage> there = open_stage(p, o, s);
    std::optional<study::participant_page> page; // its thread has the signals blocked that the stage takes
    if (listening)
        page.emplace(p.definition.page, p.where.tactors, std::move(listening));
    return study::until_left(*there, [&] {
        const study::answering with{page ? &*page : nullptr, o.keypads};
        terminal_display display;
        study::person_session(p, store, *there, with, display, {p.pcm, o.masker, between}).hold();
    });
}

int check_noise(const study::prepared_experiment& p, const experiment_options& o, const settings& s)
{
    static_cast<void>(check_real_session(p, o, s));
    const study::masking_definition& m = p.definition.masking;
    const std::unique_ptr<study::stage> there = open_stage(p, o, s);
    show(fmt::format("{} noise, {} dBFS, on {}. n noise on and off, s a stimulus under it, q ends.\n",
                     to_string(m.noise), m.level_dbfs, o.masker));
    const int signal = study::until_left(*there, [&] { noise_check(p, *there).hold(); }).signal;
    return signal != 0 ? session::interrupt::status(signal) : 0;
}

bool terminal_display::moves() const
{
    return can_draw();
}

std::function<void(double)> terminal_display::show(const array& a, const stroke& target,
                                                   const study::page_words& words)
{
    const auto picture = std::make_shared<target_picture>(a, target);
    if (!picture->active())
        cli::show(words["target"] + "\n");
    return [picture](double t_s) { picture->draw(t_s); };
}

} // namespace tactor::cli
