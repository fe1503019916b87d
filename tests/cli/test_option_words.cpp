// SPDX-License-Identifier: MIT
#include "cli/option_words.hpp"

#include <string>

#include <doctest/doctest.h>

namespace option_words_test {

using namespace tactor;

namespace {

std::string said(const error& e)
{
    const error once = cli::in_options(e);
    const error twice = cli::in_options(once);
    CHECK(std::string(once.what()) == twice.what());
    return once.what();
}

std::string said(const char* what, const char* hint)
{
    return said(error(error_kind::bad_input, what, "soa_s is why", hint));
}

} // namespace

TEST_CASE("fields of the library become options of the tool, in what is named and advised")
{
    CHECK(said("soa_s", "use 0.07") == "--soa: soa_s is why (use 0.07)");
    CHECK(said("timing = fit", "") == "--timing fit: soa_s is why");
    CHECK(said("rate", "at this rate") == "--rate: soa_s is why (at this rate)");
    CHECK(said("level_dbfs", "lower level_dbfs, or gain_db") ==
          "--level-dbfs: soa_s is why (lower --level-dbfs, or gain_db)");
    CHECK(said("stroke", "use algorithm = park2016; or drop_points = true leaves places out") ==
          "stroke: soa_s is why (use --algorithm park2016; or --drop-points leaves places out)");
    CHECK(said("stroke", "outside = clamp plays the nearest") ==
          "stroke: soa_s is why (--outside clamp plays the nearest)");
    CHECK(said("margin_mm", "fit_strokes() scales it") == "--fit-margin: soa_s is why (--fit scales it)");
}

TEST_CASE("names of files, their keys, and words that only hold a field stay as they are")
{
    CHECK(said("s.toml:3:1: carrier_hz", "") == "s.toml:3:1: carrier_hz: soa_s is why");
    CHECK(said("soa_s.toml", "") == "soa_s.toml: soa_s is why");
    for (const source_place& place :
         {source_place{"s.toml", 3, 1}, source_place{"s.toml", 3}, source_place{"a b:c.toml", 12, 40}})
        CHECK(said(error(error_kind::bad_input, place, "soa_s is why", "known keys: soa_s, burst_s")) ==
              place.text() + ": soa_s is why (known keys: soa_s, burst_s)");
    CHECK(said("a.toml:11:1", "lower sl_db by 1 dB") == "a.toml:11:1: soa_s is why (lower --sl by 1 dB)");
    CHECK(said("s.toml: stroke 2", "use soa_s") == "s.toml: stroke 2: soa_s is why (use --soa)");
    CHECK(said("rates", "my_soa_s, soa_second") == "rates: soa_s is why (my_soa_s, soa_second)");
}

} // namespace option_words_test
