// SPDX-License-Identifier: MIT
#include "files/output_file.hpp"

#include <csignal>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "files/text_file.hpp"
#include "folder.hpp"

namespace output_file_test {

using namespace tactor;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& p, const std::string& text)
{
    detail::output_file f(p);
    f.write(text.data(), static_cast<std::int64_t>(text.size()));
    f.commit();
}

unsigned rights(const fs::path& p)
{
    struct stat s {};
    REQUIRE(::stat(p.c_str(), &s) == 0);
    return s.st_mode & 07777U;
}

std::string why_not(const fs::path& p)
{
    try {
        put(p, "x");
    } catch (const error& e) {
        return e.what();
    }
    return {};
}

/// A pipe's writer must survive it.
class no_sigpipe {
public:
    no_sigpipe() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
    ~no_sigpipe() { std::signal(SIGPIPE, before_); }
    no_sigpipe(const no_sigpipe&) = delete;
    no_sigpipe& operator=(const no_sigpipe&) = delete;

private:
    void (*before_)(int);
};

} // namespace

TEST_CASE("a replaced file keeps its rights")
{
    const folder dir;
    std::ofstream(dir / "a") << "old";
    for (const unsigned mode : {0600U, 0640U, 0664U, 0755U}) {
        REQUIRE(::chmod((dir / "a").c_str(), mode) == 0);
        put(dir / "a", "new");
        CHECK(rights(dir / "a") == mode);
    }
    // Files that we wrote never give another user's rights.
    REQUIRE(::chmod((dir / "a").c_str(), 04755) == 0);
    put(dir / "a", "new");
    CHECK(rights(dir / "a") == 0755);
}

TEST_CASE("a link is followed, but not in a folder where anybody may put one")
{
    const folder dir;
    fs::create_symlink("real", dir / "link");
    put(dir / "link", "new");
    CHECK(fs::is_symlink(dir / "link"));
    CHECK(dir.bytes("real") == "new");
    fs::create_directory(dir / "shared");
    REQUIRE(::chmod((dir / "shared").c_str(), 01777) == 0);
    fs::create_symlink(dir / "real", dir / "shared/link");
    const std::string why = why_not(dir / "shared/link");
    CHECK(why.find("link: it is a link in a folder that others can write to") != std::string::npos);
    CHECK(dir.bytes("real") == "new");
    put(dir / "shared/plain", "x");
    CHECK(dir.bytes("shared/plain") == "x");
    // A link elsewhere that leads through such a one.
    fs::create_symlink(dir / "shared/link", dir / "second");
    CHECK(why_not(dir / "second").find("shared/link is a link in") != std::string::npos);
}

TEST_CASE("writing waits for a pipe without a reader until the user stops it")
{
    const folder dir;
    REQUIRE(::mkfifo((dir / "pipe").c_str(), 0600) == 0);
    int asked = 0;
    detail::output_file f(dir / "pipe", [&] { return ++asked < 3; });
    CHECK(asked == 3);
    CHECK(f.given_up());
    CHECK(f.write("x", 1) == 0);
    CHECK_THROWS_AS(f.commit(), error);
}

TEST_CASE("writing waits for a full pipe until the user stops it, and nothing is lost until then")
{
    const folder dir;
    REQUIRE(::mkfifo((dir / "pipe").c_str(), 0600) == 0);
    const int reader = ::open((dir / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    REQUIRE(reader >= 0);
    bool enough = false;
    detail::output_file f(dir / "pipe", [&] { return !enough; });
    const std::string some(4096, 'x');
    CHECK(f.write(some.data(), 4096) == 4096);
    std::string got(1 << 20, '\0');
    CHECK(::read(reader, got.data(), got.size()) == 4096);
    enough = true;
    const std::string more(1 << 20, 'y');
    const std::int64_t done = f.write(more.data(), 1 << 20);
    CHECK(f.given_up());
    CHECK(done < 1 << 20);
    CHECK(::read(reader, got.data(), got.size()) == done);
    ::close(reader);
}

TEST_CASE("a reader that leaves is a failure that says so")
{
    const no_sigpipe quiet;
    const folder dir;
    REQUIRE(::mkfifo((dir / "pipe").c_str(), 0600) == 0);
    const int reader = ::open((dir / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    REQUIRE(reader >= 0);
    detail::output_file f(dir / "pipe");
    CHECK(f.write("x", 1) == 1);
    ::close(reader);
    CHECK(f.write("x", 1) == 0);
    CHECK_THROWS_WITH_AS(f.commit(), doctest::Contains("run to the end"), error);
}

TEST_CASE("names of descriptors are written to from their position")
{
    const folder dir;
    const int fd = ::open((dir / "a").c_str(), O_WRONLY | O_CREAT, 0600);
    REQUIRE(::write(fd, "before ", 7) == 7);
    put("/dev/fd/" + std::to_string(fd), "one ");
    put("/proc/self/fd/" + std::to_string(fd), "two");
    ::close(fd);
    CHECK(dir.bytes("a") == "before one two");
    CHECK(why_not("/dev/fd/" + std::to_string(fd)).find("cannot be written") != std::string::npos);
}

TEST_CASE("a file that was read is not replaced, under any name")
{
    const folder dir;
    std::ofstream(dir / "drawing") << "mine";
    CHECK(std::string_view(detail::read_text_file(dir / "drawing", 100)) == "mine");
    fs::create_hard_link(dir / "drawing", dir / "hard");
    fs::create_symlink("drawing", dir / "soft");
    for (const char* name : {"drawing", "hard", "soft"})
        CHECK(why_not(dir / name).find("an input") != std::string::npos);
    const int fd = ::open((dir / "hard").c_str(), O_WRONLY | O_APPEND);
    CHECK(why_not("/dev/fd/" + std::to_string(fd)).find("an input") != std::string::npos);
    ::close(fd);
    CHECK(dir.bytes("drawing") == "mine");
    put(dir / "other", "new");
}

TEST_CASE("a file with the reused number of a deleted input is no input")
{
    const folder dir;
    std::ofstream(dir / "a") << "mine";
    static_cast<void>(detail::read_text_file(dir / "a", 100));
    // The file system may give the new file the number of the old one.
    fs::remove(dir / "a");
    std::ofstream(dir / "b") << "another";
    put(dir / "b", "new");
    CHECK(dir.bytes("b") == "new");
}

TEST_CASE("the library's caller replaces any input, the program its own records, and sound none")
{
    using detail::owner_kind;
    const folder dir;
    for (const auto owner : {owner_kind::program, owner_kind::user}) {
        std::ofstream(dir / "input") << "old";
        static_cast<void>(detail::read_text_file(dir / "input", 100, owner));
        CHECK_THROWS_AS(detail::output_file(dir / "input"), error);
        CHECK_NOTHROW(detail::output_file(dir / "input", {}, owner_kind::caller));
        if (owner == owner_kind::program)
            CHECK_NOTHROW(detail::output_file(dir / "input", {}, owner_kind::program));
        else
            CHECK_THROWS_AS(detail::output_file(dir / "input", {}, owner_kind::program), error);
    }
}

TEST_CASE("a file that another program wrote or somebody changed is replaced by force only")
{
    const folder dir;
    const auto ours = [](std::string_view begin, std::string_view end) {
        return begin.starts_with("ours") || end.find("ours") != end.npos;
    };
    const auto note = [](std::string_view digits) { return "<sha256 " + std::string(digits) + ">"; };
    const auto check = [&](const char* name, bool force) {
        detail::check_overwrite(dir / name, force, ours, note);
    };
    const auto write = [&](const char* name, std::string_view text) { std::ofstream(dir / name) << text; };
    write("a", std::string(50000, 'x'));
    CHECK_THROWS_WITH_AS(check("a", false), doctest::Contains("tactor did not write it"), error);
    CHECK_NOTHROW(check("a", true));
    write("b", "");
    CHECK_NOTHROW(check("b", false));
    CHECK_NOTHROW(check("none", false));
    CHECK_NOTHROW(detail::check_overwrite("/dev/null", false, ours, note));
    // The digits are those of sha256sum.
    const std::string abc = "<sha256 ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad>";
    CHECK(detail::insert_hash("abc", 1, note) == "a" + abc + "bc");
    for (const std::size_t at : {std::size_t{4}, std::size_t{30000}}) {
        const std::string written = detail::insert_hash("ours" + std::string(29996, 'x'), at, note);
        write("c", written);
        CHECK_NOTHROW(check("c", false));
        for (const std::size_t place : {std::size_t{5}, written.size() / 2, written.size() - 1}) {
            std::string changed = written;
            changed[place] = changed[place] == 'y' ? 'z' : 'y';
            write("c", changed);
            CHECK_THROWS_WITH_AS(check("c", false), doctest::Contains("somebody changed it after"), error);
        }
        for (const std::string& changed : {written + "\n", written + "<sha256 >", written.substr(0, 29000)}) {
            write("c", changed);
            CHECK_THROWS_WITH_AS(check("c", false), doctest::Contains("force"), error);
            CHECK_NOTHROW(check("c", true));
        }
    }
    write("d", "ours, without a hash");
    CHECK_THROWS_WITH_AS(check("d", false), doctest::Contains("somebody changed it after"), error);
}

} // namespace output_file_test
