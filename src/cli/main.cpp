// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <tactor/error.hpp>
#include <tactor/version.hpp>

#include "cli/commands.hpp"
#include "cli/option_words.hpp"
#include "cli/say.hpp"
#include "cli/usage.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

struct named_command {
    std::string_view name;
    command (*add)(CLI::App&);
};
constexpr std::array<named_command, 15> commands{{{"plan", add_plan},
                                                  {"render", add_render},
                                                  {"play", add_play},
                                                  {"plot", add_plot},
                                                  {"compare", add_compare},
                                                  {"calibrate", add_calibrate},
                                                  {"experiment", add_experiment},
                                                  {"analyze", add_analyze},
                                                  {"report", add_report},
                                                  {"devices", add_devices},
                                                  {"check", add_check},
                                                  {"off", add_off},
                                                  {"serve", add_serve},
                                                  {"status", add_status},
                                                  {"stop", add_stop}}};

std::string version_text()
{
    return fmt::format("tactor {}\n{}", version(), build_facts());
}

// Returns the command of that name; null if there is none.
const named_command* find_command(std::string_view name)
{
    const auto c = std::find_if(commands.begin(), commands.end(),
                                [&](const named_command& x) { return x.name == name; });
    return c == commands.end() ? nullptr : &*c;
}

// `tactor help plan` is `tactor plan --help`, for whoever has no manual pages.
std::vector<std::string> arguments(int argc, char** argv)
{
    std::vector<std::string> all(argv + 1, argv + argc);
    if (all.empty() || all.front() != "help")
        return all;
    while (!all.empty() && all.front() == "help")
        all.erase(all.begin());
    if (all.size() == 1 && find_command(all.front()) == nullptr)
        return {"help", all.front()};
    if (all.empty() || find_command(all.front()) != nullptr) // another is complained of
        all.emplace_back("--help");
    return all;
}

// Returns the slip that the words show, or else the error that they led to.
error explain(const error& e, const std::vector<std::string>& words)
{
    if (e.kind() != error_kind::bad_input)
        return e;
    std::vector<std::string> names;
    for (const named_command& c : commands)
        names.emplace_back(c.name);
    return find_slip(words, names).value_or(e);
}

int run(const std::vector<std::string>& given)
{
    const std::string_view first = given.empty() ? "" : std::string_view(given.front());
    if (first == "--version" && given.size() == 1) {
        fmt::print("{}\n", version_text());
        return status_ok;
    }
    const bool asks = first == "help" && given.size() == 2; // about options
    if (given.empty()) {
        say_error("tactor: {}\n\n{}", no_command().what(), first_steps());
        return status_usage;
    }
    CLI::App app("Draws on skin: moving tactile strokes over sparse arrays of tactors.", "tactor");
    use_help_pages(app);
    app.set_version_flag("--version", version_text, "print version, build and libraries and exit");
    app.require_subcommand(1);
    app.footer("tactor plan park2016-1\ntactor help play\ntactor help soa");
    // To describe all options of all commands takes as long as to plan a stroke: of a command that is
    // named, its own.
    const named_command* const named = find_command(first);
    std::vector<std::pair<std::string_view, command>> added;
    for (const named_command& c : commands)
        if (named == nullptr || named == &c)
            added.emplace_back(c.name, c.add(app));
    if (first == complete_command) {
        for (const std::string& line : complete(app, {given.begin() + 1, given.end()}))
            fmt::print("{}\n", line);
        return status_ok;
    }
    if (asks) {
        say_text(stdout, describe_options(app, given[1]));
        return status_ok;
    }
    try {
        std::vector<std::string> words(given.rbegin(), given.rend()); // the last first, as it wants them
        app.parse(words);
    } catch (const CLI::Success& e) {
        std::ostringstream text; // of --help or --version
        const int status = app.exit(e, text);
        say_text(stdout, text.str());
        return status;
    } catch (const CLI::ParseError& e) {
        throw usage_error(app, e);
    }
    for (const auto& [name, act] : added)
        if (app.got_subcommand(std::string(name)))
            return act();
    return status_usage;
}

// The status that SIGPIPE would give. A reader of the first lines (| head) needs no message.
constexpr int status_unread = 128 + SIGPIPE;

// Reports output that did not arrive: a full disk is a failure, not a shorter plan.
int unprinted(int code)
{
    if (code == EPIPE)
        return status_unread;
    const bool full = code == ENOSPC || code == EDQUOT;
    say_error("tactor: standard output: {}{}\n", std::strerror(code),
              full            ? " (free some space, or write to another disk; what was written is cut short)"
              : code == EBADF ? " (it is closed: send it to a file or a pipe)"
                              : "");
    return status_failed;
}

// Returns true where the reader of a file written to standard output (-o -) is gone.
bool is_unread(const tactor::error& e)
{
    return e.os_code() == EPIPE && session::is_standard_output(std::string(e.subject()));
}

int flushed(int status)
{
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)
        return status;
    return unprinted(output_error() != 0 ? output_error() : errno);
}

// Opens /dev/null for each standard file that is closed: the next opened file would get its number, and the
// output. Reading or writing it fails, as with a closed one.
void hold_standard_files() noexcept
{
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(fd, F_GETFD) == -1 && errno == EBADF)
            ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

} // namespace
} // namespace tactor::cli

int main(int argc, char** argv)
{
    using namespace tactor::cli;
    // A file that grows beyond `ulimit -f`, and a pipe whose reader is gone, are errors that say what to do
    // and leave nothing half done, not ends of the program.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    hold_standard_files();
    try {
        return flushed(run(arguments(argc, argv)));
    } catch (const tactor::error& e) {
        if (is_unread(e))
            return status_unread;
        const tactor::error said = explain(in_options(e), {argv + 1, argv + argc});
        say_error("tactor: {}{}\n", said.subject().empty() ? R"("")" : "", said.what()); // an empty name
        return exit_status_for(e.kind());
    } catch (const std::system_error& e) {
        if (std::ferror(stdout) != 0) // of fmt::print
            return unprinted(output_error() != 0 ? output_error() : e.code().value());
        say_error("tactor: failed: {}\n", e.what());
    } catch (const std::bad_alloc&) {
        say_error("tactor: memory: not enough for this input\n");
    } catch (const std::exception& e) {
        say_error("tactor: failed: {}\n", e.what());
    }
    return status_failed;
}
