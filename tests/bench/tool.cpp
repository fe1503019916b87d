// SPDX-License-Identifier: MIT
// The tool as a process: cost of its start, and its greatest memory.
#include <sys/resource.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "report.hpp"

namespace {

double seconds(const timeval& t)
{
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Starts the tool with its standard output in `out`, or nowhere; 0 when it does not start.
pid_t start(const std::vector<std::string>& arguments, int out)
{
    std::vector<std::string> all{TACTOR_TOOL};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& a : all)
        argv.push_back(a.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
    if (out >= 0)
        posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    pid_t child = 0;
    const int failed = posix_spawn(&child, TACTOR_TOOL, &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    return failed == 0 ? child : 0;
}

/// Returns whether it ends with that status.
bool ends(pid_t child, int wanted, rusage& used)
{
    int status = 0;
    return child != 0 && wait4(child, &status, 0, &used) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == wanted;
}

bool run(const std::vector<std::string>& arguments, rusage& used)
{
    return ends(start(arguments, -1), 0, used);
}

/// Plays until the tool prints its device, when all is planned, and interrupts it.
bool interrupt(const std::vector<std::string>& arguments, rusage& used)
{
    constexpr int interrupted = 130;
    int line[2] = {-1, -1};
    if (pipe2(line, O_CLOEXEC) != 0)
        return false;
    const pid_t child = start(arguments, line[1]);
    close(line[1]);
    char first = 0;
    const bool said = child != 0 && read(line[0], &first, 1) == 1;
    if (said)
        kill(child, SIGINT);
    const bool ended = ends(child, interrupted, used);
    close(line[0]);
    return said && ended;
}

/// Returns the least time and greatest memory of so many runs.
bench::tool_row measure(const std::string& what, const std::vector<std::string>& arguments, int times,
                        bool (*how)(const std::vector<std::string>&, rusage&) = run)
{
    bench::tool_row row{what, 1e9, 0.0};
    for (int i = 0; i < times; ++i) {
        rusage used{};
        if (!how(arguments, used))
            return {what + ": the tool failed", 0.0, 0.0};
        row.cpu_ms = std::min(row.cpu_ms, 1e3 * (seconds(used.ru_utime) + seconds(used.ru_stime)));
        row.peak_mb = std::max(row.peak_mb, static_cast<double>(used.ru_maxrss) / 1024.0);
    }
    return row;
}

} // namespace

std::vector<bench::tool_row> bench::measure_tool()
{
    const std::string picture = std::filesystem::temp_directory_path() / "tactor-bench.svg";
    const auto hours = [](std::vector<std::string> what, const char* seconds,
                          const std::vector<std::string>& more) {
        what.insert(what.end(), {"park2016-1", "--duration", seconds});
        what.insert(what.end(), more.begin(), more.end());
        return what;
    };
    constexpr const char* hour = "3600";
    constexpr const char* ten = "36000";
    const std::vector<std::string> nowhere{"-o", "/dev/null"};
    const std::vector<std::string> continuous{"--algorithm", "continuous", "-o", "/dev/null"};
    const std::vector<std::string> null{"-D", "null"};
    const std::vector<tool_row> rows{
        measure("--version", {"--version"}, 10),
        measure("plan park2016-1", {"plan", "park2016-1"}, 10),
        measure("plan, an hour, as JSON", hours({"plan"}, hour, {"--format", "json"}), 3),
        measure("compare, an hour", hours({"compare"}, hour, {}), 1),
        measure("plot --view wave, an hour", hours({"plot"}, hour, {"--view", "wave", "-o", picture}), 1),
        measure("render park2016-1", {"render", "park2016-1", "-o", "/dev/null"}, 5),
        measure("render, an hour", hours({"render"}, hour, nowhere), 3),
        measure("render, ten hours", hours({"render"}, ten, nowhere), 1),
        measure("render, an hour, continuous", hours({"render"}, hour, continuous), 1),
        measure("play park2016-1", {"play", "park2016-1", "-D", "null"}, 3),
        measure("play, an hour, interrupted at once", hours({"play"}, hour, null), 1, interrupt),
        measure("play, ten hours, interrupted at once", hours({"play"}, ten, null), 1, interrupt)};
    std::filesystem::remove(picture);
    return rows;
}
