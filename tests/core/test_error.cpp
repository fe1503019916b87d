// SPDX-License-Identifier: MIT
// Errors, and words in their messages.
#include <array>
#include <cerrno>
#include <exception>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "caught.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"

namespace error_test {

using namespace tactor;
using tactor::counted;
using tactor::label_fault;
using tactor::plain_number;
using tactor::seconds_text;

namespace {

template <class F>
error thrown_by(F call)
{
    try {
        call();
    } catch (const error& e) {
        return e;
    }
    FAIL("it did not throw");
    return {error_kind::runtime, "", ""};
}

} // namespace

static_assert(std::is_nothrow_copy_constructible_v<error> && std::is_nothrow_copy_assignable_v<error>);
static_assert(std::is_nothrow_move_constructible_v<error>);

TEST_CASE("an error consists of its text, field, place and errno")
{
    const error plain(error_kind::runtime, "stream", "it broke");
    CHECK(std::string(plain.what()) == "stream: it broke");
    CHECK(plain.subject() == "stream");
    CHECK(plain.why() == "it broke");
    CHECK(plain.hint().empty());
    CHECK(plain.field().empty());
    CHECK(plain.place().text().empty());
    CHECK(plain.os_code() == 0);

    const error placed(error_kind::bad_input, source_place{"a.toml", 3, 7}, "soa_s is 1", "use 0.07");
    CHECK(std::string(placed.what()) == "a.toml:3:7: soa_s is 1 (use 0.07)");
    CHECK(placed.place().file == "a.toml");
    CHECK(placed.place().line == 3);
    CHECK(placed.place().column == 7);

    const error all = placed.with_field("soa_s").with_os_code(EIO);
    CHECK(std::string(all.what()) == placed.what());
    CHECK(all.kind() == error_kind::bad_input);
    CHECK(all.code() == error_kind::bad_input);
    CHECK(all.field() == "soa_s");
    CHECK(all.os_code() == EIO);
    CHECK(placed.field().empty());

    const error reworded = all.reworded("--soa", "1 s", "");
    CHECK(std::string(reworded.what()) == "--soa: 1 s");
    CHECK(reworded.hint().empty());
    CHECK(reworded.kind() == error_kind::bad_input);
    CHECK(reworded.field() == "soa_s");
    CHECK(reworded.place().line == 3);
    CHECK(reworded.os_code() == EIO);
    CHECK(reworded.with_place({"b.toml", 1, 0}).place().text() == "b.toml:1");
}

TEST_CASE("marks are fields to the library's own users, and marks in its hint")
{
    const error e(error_kind::bad_input, "{timing=fit}", "\"{a}\" is none",
                  "{fit=true| scales it, }{soa_s}, or ask {command:devices}; [sync] in = { chip }");
    CHECK(std::string(e.what()) ==
          "timing = fit: \"{a}\" is none (fit_strokes() scales it, soa_s, or ask tactor "
          "devices; [sync] in = { chip })");
    CHECK(e.subject() == "{timing=fit}");
    CHECK(e.hint().starts_with("{fit=true| scales it, }{soa_s}"));
    CHECK(std::string(error(error_kind::bad_input, "{a}.toml", "no").what()) == "{a}.toml: no");
    for (const char* text : {"", "{", "}", "{}", "{ a }", "{1}", "{A}", "{a b}", "{:}", "{command:}", "{=a}"})
        CHECK(std::string(error(error_kind::bad_input, "a", "b", text).what()).find(text) !=
              std::string::npos);
}

TEST_CASE("an error that was moved from, and a copy of one that is gone, say the same")
{
    std::optional<error> first(error(error_kind::bad_input, "grid", "0 rows", "1 or more"));
    error second = std::move(*first); // NOLINT(performance-move-const-arg): that is what is tried
    CHECK(std::string(first->what()) == second.what()); // NOLINT(bugprone-use-after-move)
    const std::string_view hint = second.hint();
    first.reset();
    CHECK(hint == "1 or more");
    second = error(error_kind::runtime, "other", "why");
    CHECK(second.kind() == error_kind::runtime);
    CHECK(std::string(second.what()) == "other: why");
}

TEST_CASE("refusals of the library name their field")
{
    const path line = path::polyline(std::array{point{0.0, 0.0}, point{10.0, 0.0}});
    CHECK(detail::bad_field("soa_s", "0 s").field() == "soa_s");
    CHECK(detail::bad_field("soa_s", "0 s").subject() == "soa_s");
    CHECK(caught_field([&] { return trajectory::along(line, movement{.duration_s = -1.0}); }) ==
          "duration_s");
    CHECK(caught_field([&] {
              return trajectory::along(line, movement{.duration_s = 1.0, .intensity = {{2.0, 1.0}}});
          }) == "intensity");
    CHECK(caught_field([&] { return trajectory::along(line, 1.0).with_speed(0.0); }) == "speed_mm_s");
    for (const char* text : {"noise:50-1", "noise:x", "sinus"})
        CHECK(caught_field([&] { return parse_waveform(text); }) == "waveform");
    const auto arc = [](double radius_mm, double from_deg, double sweep_deg) {
        return caught_field([&] { return path::arc({}, radius_mm, from_deg, sweep_deg); });
    };
    CHECK(arc(0.0, 0.0, 90.0) == "radius_mm");
    CHECK(arc(1.0, 1e7, 90.0) == "from_deg");
    CHECK(arc(1.0, 0.0, 0.0) == "sweep_deg");
    CHECK(caught_field([] { return path::polyline({}); }) == "points");
    CHECK(caught_field([] { return trajectory::timed({}); }) == "points");
}

TEST_CASE("refusals of the system have their errno")
{
    CHECK(thrown_by([] { detail::throw_resource_error("thread", EAGAIN, "none"); }).os_code() == EAGAIN);
    CHECK(thrown_by([] { detail::throw_with_cause(error(error_kind::runtime, "a", "b")); }).os_code() == 0);
}

TEST_CASE("an error has the errno of its nested error, unless it has its own")
{
    const auto around = [](const auto& cause, int own) {
        return thrown_by([&] {
                   try {
                       throw cause;
                   } catch (const std::exception&) {
                       detail::throw_with_cause(error(error_kind::runtime, "a", "b").with_os_code(own));
                   }
               })
            .os_code();
    };
    CHECK(around(error(error_kind::bad_input, "c", "d").with_os_code(ENOENT), 0) == ENOENT);
    CHECK(around(error(error_kind::bad_input, "c", "d"), 0) == 0);
    CHECK(around(std::system_error(EBADF, std::generic_category()), 0) == EBADF);
    CHECK(around(std::system_error(EBADF, std::system_category()), 0) == EBADF);
    CHECK(around(std::system_error(make_error_code(error_kind::runtime)), 0) == 0);
    CHECK(around(std::runtime_error("e"), 0) == 0);
    CHECK(around(std::system_error(EBADF, std::generic_category()), EIO) == EIO);
}

TEST_CASE("only one is singular")
{
    CHECK(counted(0, "burst") == "0 bursts");
    CHECK(counted(1, "burst") == "1 burst");
    CHECK(counted(2, "burst") == "2 bursts");
    CHECK(counted(1, "try", "tries") == "1 try");
    CHECK(counted(3, "try", "tries") == "3 tries");
}

TEST_CASE("numbers have no exponent and no zeros at their end")
{
    CHECK(plain_number(0.0) == "0");
    CHECK(plain_number(-0.0) == "0");
    CHECK(plain_number(0.07) == "0.07");
    CHECK(plain_number(2.6179938) == "2.61799");
    CHECK(plain_number(2.6179938, 3) == "2.62");
    CHECK(plain_number(1e6) == "1000000");
    CHECK(plain_number(-1e9) == "-1000000000");
    CHECK(plain_number(1e-5) == "0.00001");
    CHECK(plain_number(1e-30) == "0");
    CHECK(plain_number(-1e-30) == "0");
    CHECK(plain_number(9.9999999) == "10");
    CHECK(plain_number(std::numeric_limits<double>::infinity()) == "inf");
}

TEST_CASE("times have their unit, and a rounding is no time")
{
    CHECK(seconds_text(0.0) == "0 s");
    CHECK(seconds_text(1e-17) == "0 s");
    CHECK(seconds_text(-1e-17) == "0 s");
    CHECK(seconds_text(2.78521e-08) == "27.9 ns");
    CHECK(seconds_text(2.78521e-05) == "27.9 us");
    CHECK(seconds_text(1e-4) == "0.0001 s");
    CHECK(seconds_text(0.0473) == "0.0473 s");
    CHECK(seconds_text(2.6179938) == "2.61799 s");
    CHECK(seconds_text(2.6179938, 4) == "2.618 s");
    CHECK(seconds_text(86400.0) == "86400 s");
    CHECK(seconds_text(-0.5) == "-0.5 s");
}

TEST_CASE("a label has 1 to 40 characters of any script")
{
    CHECK(label_fault("").ends_with("is empty"));
    CHECK(label_fault("left palm").empty());
    CHECK(label_fault(std::string(40, 'x')).empty());
    CHECK(label_fault(std::string(41, 'x')) == "has 41 characters");
    std::string wide;
    for (int i = 0; i < 40; ++i)
        wide += i % 2 == 0 ? "\xc3\xa9" : "\xf0\x9f\x91\x8b"; // two and four bytes
    CHECK(label_fault(wide).empty());
    CHECK(label_fault(wide + "\xe6\x89\x8b") == "has 41 characters");
}

TEST_CASE("a label has no characters that end a line, move a cursor or turn the text around it")
{
    for (const char* c : {"\n", "\x1b[2J", "\x7f", "\xc2\x80", "\xc2\x9f", "\xe2\x80\xa8", "\xe2\x80\xae",
                          "\xe2\x81\xa6", "\xe2\x81\xa9"})
        CHECK(label_fault("a" + std::string(c) + "b") == "has control characters");
    CHECK(label_fault(std::string("a\0b", 3)) == "has control characters");
    for (const char* c :
         {" ", "~", "\xc2\xa0", "\xe2\x80\xa7", "\xe2\x80\xaf", "\xe2\x81\xa5", "\xe2\x81\xaa"})
        CHECK(label_fault(c).empty());
}

} // namespace error_test
