// SPDX-License-Identifier: MIT
// Before a person's trials: consent, and the walk over the array.
#include <utility>

#include <fmt/format.h>

#include "cli/check/walk.hpp"
#include "cli/experiment/array_walk.hpp"
#include "cli/experiment/participant_screen.hpp"
#include "cli/experiment/person_session.hpp"
#include "cli/say.hpp"
#include "files/plan/json_values.hpp"
#include "study/bids/acq_time.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

} // namespace

void person_session::ask_consent()
{
    const study::page_words& w = p_.definition.page;
    on_page(consent_screen(p_));
    show_text(p_.definition.consent + "\n");
    show(fmt::format("{} y {}, n {}: ", w["agree"], w["yes"], w["no"]));
    for (;;) {
        const session_key k = keys_.wait();
        if (k.asked == operator_key::quit)
            obey(*k.asked);
        if (k.character != 'y' && k.character != 'n')
            continue;
        show(k.character == 'y' ? w["yes"] + "\n\n" : w["no"] + "\n");
        if (k.character == 'y')
            agreed_at_ = study::acq_time_text(study::utc_now_ns());
        return flow_.agree(k.character == 'y');
    }
}

void person_session::walk(unsigned tactor)
{
    const array& a = p_.where.tactors;
    const study::page_words& w = p_.definition.page;
    if (tactor == 0) {
        show_text(w["walk"] + "\n");
        show(numbered_map(a) + "\n");
    }
    on_page(walk_screen(p_, tactor, false));
    const score s = walk_score(p_.definition, a, p_.render, tactor);
    const given_stimulus g = [&] {
        const noise_around noise(stage_);
        return stage_.give(fmt::format("tactor {}", tactor), s, 0.0, [](std::uint64_t) {});
    }();
    if (!g.flaw.empty()) {
        say(stderr, "tactor: tactor {}: {}\n", tactor, g.flaw);
        find_device();
    }
    on_page(walk_screen(p_, tactor, true));
    show(fmt::format("{}: {} y {}, n {}, r {}{}: ", tactor, w["felt"], w["yes"], w["no"], w["again"],
                     tactor > 0 ? ", b " + w["back"] : ""));
    for (;;) {
        const session_key k = keys_.wait();
        if (k.asked == operator_key::quit)
            obey(*k.asked);
        if (k.character == '\0' || std::string("ynrb").find(k.character) == std::string::npos ||
            (k.character == 'b' && tactor == 0))
            continue;
        show(fmt::format("{}\n", k.character));
        if (k.character == 'y')
            walked_.push_back({{"tactor", tactor}, {"asked", study::acq_time_text(study::utc_now_ns())}});
        return flow_.felt(k.character == 'y'   ? study::walk_answer::felt
                          : k.character == 'n' ? study::walk_answer::not_felt
                          : k.character == 'r' ? study::walk_answer::again
                                               : study::walk_answer::back);
    }
}

// Only who agreed, and felt each tactor, leaves anything on the disk.
void person_session::begin_store()
{
    if (std::exchange(begun_, true))
        return;
    const std::string now = study::acq_time_text(study::utc_now_ns());
    store_.begin(p_.stimuli.all());
    if (store_.facts()["date"].is_null()) // new, or ended before it was written down
        store_.note("date", now);
    if (!agreed_at_.empty())
        store_.note("consent", agreed_at_);
    json walks = store_.facts().value("walk", json::array()); // a session that goes on is walked again
    for (const json& one : walked_)
        walks.push_back(one);
    store_.note("walk", walks);
    store_.note("sound_server", files::or_null(devices_.between.array));
    store_.note("masker_sound_server", files::or_null(devices_.between.masker));
    note_stream();
}

} // namespace tactor::cli
