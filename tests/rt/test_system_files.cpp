// SPDX-License-Identifier: MIT
#include "rt/system_files.hpp"

#include <algorithm>
#include <cerrno>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "caught.hpp"
#include "count_allocations.hpp"
#include "descriptors_left.hpp"
#include "folder.hpp"

namespace system_files_test {

using namespace tactor;

TEST_CASE("contents of a folder and of a file; a missing one is empty")
{
    const folder here;
    const std::string text(10'000, 'x');
    const auto file = here.write("a", text);
    here.write("b/c");
    std::vector<std::string> names = rt::read_folder_names(here.path().string());
    std::sort(names.begin(), names.end());
    CHECK(names == std::vector<std::string>{"a", "b"});
    CHECK(rt::read_file(file.string()) == text);
    CHECK(rt::read_folder_names(here / "none").empty());
    CHECK(rt::read_folder_names(file).empty());
    CHECK(rt::read_file(here / "none").empty());
    CHECK(rt::read_file(here.path().string()).empty());
}

EXHAUSTING_TEST_CASE("without a descriptor nothing counts as empty")
{
    const auto refused = [](auto call) {
        const test::descriptors_left none(0);
        return os_code(call);
    };
    CHECK(refused([] { static_cast<void>(rt::read_folder_names("/proc")); }) == EMFILE);
    CHECK(refused([] { static_cast<void>(rt::read_file("/proc/self/status")); }) == EMFILE);
}

} // namespace system_files_test
