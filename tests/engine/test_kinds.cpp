// SPDX-License-Identifier: MIT
// Closed sets: each value has a unique name, and the name leads back to it.
#include <set>
#include <string>

#include <doctest/doctest.h>

#include <tactor/tactor.hpp>

#include "has.hpp"

namespace kinds_test {

using namespace tactor;

TEST_CASE_TEMPLATE("every value of an enumeration has a name that leads back to it", Kind, actuator_kind,
                   algorithm_kind, easing_kind, edge_kind, envelope_kind, error_kind, faces_kind, format_kind,
                   io_kind, log_kind, note_kind, observer_kind, outside_kind, overlap_kind, phantom_kind,
                   phase_kind, pull_kind, reason_kind, scale_kind, start_from_kind, start_kind, state_kind,
                   texture_kind, timing_kind, wait_kind, waveform_kind)
{
    std::set<std::string> names;
    for (const Kind k : all_values<Kind>()) {
        const std::string name(to_string(k));
        CHECK(names.insert(name).second);
        CHECK(from_string<Kind>(name) == k);
    }
    CHECK(names.size() >= 2);
    try {
        static_cast<void>(from_string<Kind>("no such name"));
        FAIL("no error");
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        for (const std::string& name : names)
            CHECK(has(std::string(e.hint()), name));
    }
}

TEST_CASE("an unknown value of an enumeration is named unknown")
{
    CHECK(to_string(static_cast<phantom_kind>(99)) == "unknown");
    CHECK(to_string(static_cast<state_kind>(99)) == "unknown");
}

} // namespace kinds_test
