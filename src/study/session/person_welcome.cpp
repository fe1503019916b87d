// SPDX-License-Identifier: MIT
// Before a person's trials: consent, and the walk over the array.
#include <utility>

#include <fmt/format.h>

#include "files/plan/json_value.hpp"
#include "session/say.hpp"
#include "session/walk.hpp"
#include "study/bids/acq_time.hpp"
#include "study/session/person_session.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

} // namespace

void person_session::ask_consent()
{
    const page_words& w = p_.definition.page;
    on_page(consent_screen(p_));
    session::show_lines(p_.definition.consent + "\n");
    session::show(fmt::format("{} y {}, n {}: ", w["agree"], w["yes"], w["no"]));
    for (;;) {
        const session_key k = keys_.wait();
        if (k.asked == operator_key::quit)
            obey(*k.asked);
        if (k.character != 'y' && k.character != 'n')
            continue;
        session::show(k.character == 'y' ? w["yes"] + "\n\n" : w["no"] + "\n");
        if (k.character == 'y')
            agreed_at_ = acq_time_text(utc_now_ns());
        return flow_.agree(k.character == 'y');
    }
}

void person_session::walk(unsigned tactor)
{
    const array& a = p_.where.tactors;
    const page_words& w = p_.definition.page;
    if (tactor == 0) {
        session::show_lines(w["walk"] + "\n");
        session::show(session::numbered_map(a) + "\n");
    }
    on_page(walk_screen(p_, tactor, false));
    const score s = walk_score(p_.definition, a, p_.render, tactor);
    const given_stimulus g = [&] {
        const noise_around noise(stage_);
        return stage_.give(s, 0.0, [](std::uint64_t) {});
    }();
    if (!g.flaw.empty()) {
        session::say(stderr, "tactor: tactor {}: {}\n", tactor, g.flaw);
        find_device();
    }
    on_page(walk_screen(p_, tactor, true));
    session::show(fmt::format("{}: {} y {}, n {}, r {}{}: ", tactor, w["felt"], w["yes"], w["no"], w["again"],
                              tactor > 0 ? ", b " + w["back"] : ""));
    for (;;) {
        const session_key k = keys_.wait();
        if (k.asked == operator_key::quit)
            obey(*k.asked);
        if (k.character == '\0' || std::string("ynrb").find(k.character) == std::string::npos ||
            (k.character == 'b' && tactor == 0))
            continue;
        session::show(fmt::format("{}\n", k.character));
        if (k.character == 'y')
            walked_.push_back({{"tactor", tactor}, {"asked", acq_time_text(utc_now_ns())}});
        return flow_.felt(k.character == 'y'   ? walk_answer::felt
                          : k.character == 'n' ? walk_answer::not_felt
                          : k.character == 'r' ? walk_answer::again
                                               : walk_answer::back);
    }
}

// Only who agreed, and felt each tactor, leaves anything on the disk.
void person_session::begin_store()
{
    if (std::exchange(begun_, true))
        return;
    const std::string now = acq_time_text(utc_now_ns());
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

} // namespace tactor::study
