// SPDX-License-Identifier: MIT
#include "cli/settings.hpp"

#include <string>

#include <doctest/doctest.h>

namespace option_words_test {

using namespace tactor;

namespace {

std::string said(const error& e)
{
    return cli::in_options(e).what();
}

std::string said(const char* hint)
{
    return said(error(error_kind::bad_input, "soa_s", "no", hint).with_field("soa_s"));
}

} // namespace

TEST_CASE("fields and marks of the library become options and commands of the tool")
{
    CHECK(said("lower {level_dbfs}, or gain_db") == "--soa: no (lower --level-dbfs, or gain_db)");
    CHECK(said("{timing=fit}; {drop_points=true} leaves places out") ==
          "--soa: no (--timing fit; --drop-points leaves places out)");
    CHECK(said("{fit=true| scales it, }or {outside=clamp}") ==
          "--soa: no (--fit scales it, or --outside clamp)");
    CHECK(said("{device=hw:CARD=A}; {command:devices} lists all") ==
          "--soa: no (-D hw:CARD=A; tactor devices lists all)");
    CHECK(said("{command:plan} makes one") == "--soa: no (tactor plan STROKE --format json makes one)");
    CHECK(said("{force=true}; {wider=true} leaves the others silent") ==
          "--soa: no (--force; without a number of channels it leaves the others silent)");
    CHECK(said("{array=none}: it has its own") == "--soa: no (say no --array: it has its own)");
}

TEST_CASE("keys of a stroke file stay as they are there")
{
    CHECK(said(error(error_kind::bad_input, source_place{"s.toml", 3, 1}, "no",
                     "{faces=delaunay}, {outside=clamp}")) ==
          "s.toml:3:1: no (faces = delaunay, --outside clamp)");
}

} // namespace option_words_test
