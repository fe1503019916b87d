// SPDX-License-Identifier: MIT
#include "cli/experiment/noise_check.hpp"

#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/experiment/real_session.hpp"
#include "cli/say.hpp"
#include "session/interrupt.hpp"
#include "study/session/key_input.hpp"

namespace tactor::cli {
namespace {

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

} // namespace

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

} // namespace tactor::cli
