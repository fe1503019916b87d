// SPDX-License-Identifier: MIT
// The tool as a process: what it costs to start, and the memory that it needs at most.
#include <sys/resource.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <string>
#include <vector>

#include <benchmark/benchmark.h>

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

void tool(benchmark::State& state, const std::vector<std::string>& arguments)
{
    double most_mb = 0.0;
    for (auto _ : state) {
        rusage used{};
        if (!run(arguments, used)) {
            state.SkipWithError("the tool failed");
            break;
        }
        state.SetIterationTime(seconds(used.ru_utime) + seconds(used.ru_stime));
        most_mb = std::max(most_mb, static_cast<double>(used.ru_maxrss) / 1024.0);
    }
    state.counters["peak_MB"] = most_mb;
}

void add(const char* name, const std::vector<std::string>& arguments, int times)
{
    benchmark::RegisterBenchmark(name, [arguments](benchmark::State& s) { tool(s, arguments); })
        ->Iterations(1)
        ->Repetitions(times)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

const bool added = [] {
    add("tool/version", {"--version"}, 10);
    add("tool/plan_park2016-1", {"plan", "park2016-1"}, 10);
    add("tool/render_park2016-1", {"render", "park2016-1", "-o", "/dev/null"}, 5);
    add("tool/play_park2016-1_to_null", {"play", "park2016-1", "-D", "null"}, 3);
    return true;
}();

} // namespace
