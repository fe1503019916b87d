// SPDX-License-Identifier: MIT
// The tool as a process: what it costs to start, and the memory that it needs at most.
#include <sys/resource.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "report.hpp"

namespace {

double seconds(const timeval& t)
{
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Runs the tool; false when it does not end well.
bool run(const std::vector<std::string>& arguments, rusage& used)
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
    pid_t child = 0;
    const int failed = posix_spawn(&child, TACTOR_TOOL, &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    int status = 0;
    return failed == 0 && wait4(child, &status, 0, &used) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
}

/// Least time and greatest memory of so many runs.
bench::tool_row measure(const std::string& what, const std::vector<std::string>& arguments, int times)
{
    bench::tool_row row{what, 1e9, 0.0};
    for (int i = 0; i < times; ++i) {
        rusage used{};
        if (!run(arguments, used)) {
            return {what + ": the tool failed", 0.0, 0.0};
        }
        row.cpu_ms = std::min(row.cpu_ms, 1e3 * (seconds(used.ru_utime) + seconds(used.ru_stime)));
        row.peak_mb = std::max(row.peak_mb, static_cast<double>(used.ru_maxrss) / 1024.0);
    }
    return row;
}

} // namespace

std::vector<bench::tool_row> bench::measure_tool()
{
    return {
        measure("--version", {"--version"}, 10),
        measure("plan park2016-1", {"plan", "park2016-1"}, 10),
        measure("render park2016-1 -o /dev/null", {"render", "park2016-1", "-o", "/dev/null"}, 5),
        measure("the same, an hour", {"render", "park2016-1", "--duration", "3600", "-o", "/dev/null"}, 3),
        measure("ten hours", {"render", "park2016-1", "--duration", "36000", "-o", "/dev/null"}, 1),
        measure(
            "an hour, continuous",
            {"render", "park2016-1", "--duration", "3600", "--algorithm", "continuous", "-o", "/dev/null"},
            3),
        measure("play park2016-1 -D null", {"play", "park2016-1", "-D", "null"}, 3)};
}
