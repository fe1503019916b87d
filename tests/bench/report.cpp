// SPDX-License-Identifier: MIT
// Runs all benchmarks, and the tool as a process, and prints the tables.
#include "report.hpp"

#include <sys/resource.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pieces.hpp"

using namespace tactor;

std::string bench::benchmark_name(const std::string& what, std::size_t bytes)
{
    return fmt::format("{}/{}_bytes", what, bytes);
}

std::string bench::synth_row::name() const
{
    return fmt::format("synth/{}_channels/{}_strokes/{}/{}", channels, strokes,
                       continuous ? "continuous" : "burst", to_string(format));
}

std::string bench::synth_row::plain_name() const
{
    return fmt::format("std_sin/{}_channels/{}_strokes/{}", channels, strokes,
                       continuous ? "continuous" : "burst");
}

std::vector<bench::synth_row>& bench::table()
{
    static std::vector<synth_row> rows;
    return rows;
}

namespace {

/// Time and memory of the tool as a process.
struct tool_row {
    std::string what;
    double cpu_ms = 0.0;
    double peak_mb = 0.0;
};

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
tool_row measure(const std::string& what, const std::vector<std::string>& arguments, int times,
                 bool (*how)(const std::vector<std::string>&, rusage&) = run)
{
    tool_row row{what, 1e9, 0.0};
    for (int i = 0; i < times; ++i) {
        rusage used{};
        if (!how(arguments, used))
            return {what + ": the tool failed", 0.0, 0.0};
        row.cpu_ms = std::min(row.cpu_ms, 1e3 * (seconds(used.ru_utime) + seconds(used.ru_stime)));
        row.peak_mb = std::max(row.peak_mb, static_cast<double>(used.ru_maxrss) / 1024.0);
    }
    return row;
}

/// Called first, while this process is small: the system counts its memory at the start of a child as the
/// child's.
std::vector<tool_row> measure_tool()
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

/// Keeps the best of each; a line for each benchmark while it runs would only be noise.
class reporter : public benchmark::BenchmarkReporter {
public:
    explicit reporter(const std::vector<tool_row>& tool) : tool_(tool) {}

    bool ReportContext(const Context& context) override
    {
        PrintBasicContext(&GetErrorStream(), context);
        return true;
    }

    void ReportRuns(const std::vector<Run>& runs) override
    {
        for (const Run& r : runs) {
            if (r.run_type != Run::RT_Iteration || r.error_occurred)
                continue;
            const std::string name =
                r.run_name.function_name + (r.run_name.args.empty() ? "" : "/" + r.run_name.args);
            auto [place, is_new] = found_.try_emplace(name);
            result& best = place->second;
            if (is_new) {
                order_.push_back(name);
                best.unit = benchmark::GetTimeUnitString(r.time_unit);
            }
            // The given time where a benchmark measures it itself; else the processor's, not the wall's.
            const bool manual = !r.run_name.time_type.empty();
            const double time = manual ? r.GetAdjustedRealTime() : r.GetAdjustedCPUTime();
            best.time = is_new ? time : std::min(best.time, time);
            for (const auto& [key, counter] : r.counters)
                best.counters[key] = std::max(best.counters[key], counter.value);
        }
    }

    void Finalize() override
    {
        synthesis();
        others();
    }

private:
    struct result {
        double time = 0.0;
        std::string unit;
        std::map<std::string, double> counters;
    };

    double time(const std::string& name) const
    {
        const auto i = found_.find(name);
        return i == found_.end() ? 0.0 : i->second.time;
    }

    static std::string ratio(double a, double b)
    {
        return a > 0.0 && b > 0.0 ? fmt::format("{:.2f}", a / b) : "-";
    }

    void synthesis() const
    {
        std::printf("\nSynthesis of 10 ms (%zu frames), in cache; best of the repetitions\n", bench::block);
        std::printf("%8s %8s %-11s %-7s %10s %10s %10s %10s %8s\n", "channels", "strokes", "algorithm",
                    "format", "ns", "x std::sin", "of memcpy", "of memset", "core %");
        for (const bench::synth_row& row : bench::table()) {
            const double ns = time(row.name());
            if (ns == 0.0)
                continue;
            const std::size_t bytes = bench::block * row.channels * sample_bytes(row.format);
            std::printf("%8u %8u %-11s %-7s %10.0f %10s %10s %10s %8.3f\n", row.channels, row.strokes,
                        row.strokes == 0 ? "silence"
                        : row.continuous ? "continuous"
                                         : "burst",
                        std::string(to_string(row.format)).c_str(), ns,
                        ratio(time(row.plain_name()), ns).c_str(),
                        ratio(time(bench::benchmark_name("memcpy", bytes)), ns).c_str(),
                        ratio(time(bench::benchmark_name("memset", bytes)), ns).c_str(), 100.0 * ns / 10e6);
        }
    }

    void others() const
    {
        std::printf("\n%-52s %12s\n", "Others", "best");
        for (const std::string& name : order_) {
            if (name.starts_with("synth/") || name.starts_with("std_sin/") || name.starts_with("mem"))
                continue;
            const result& r = found_.at(name);
            std::printf("%-52s %9.3f %s", name.c_str(), r.time, r.unit.c_str());
            for (const auto& [key, value] : r.counters)
                std::printf("  %s %.3g", key.c_str(), value);
            std::printf("\n");
        }
        std::printf("\n%-52s %12s %10s\n", "The tool as a process", "CPU ms", "peak MB");
        for (const tool_row& row : tool_)
            std::printf("%-52s %12.1f %10.1f\n", row.what.c_str(), row.cpu_ms, row.peak_mb);
    }

    const std::vector<tool_row>& tool_;
    std::map<std::string, result> found_;
    std::vector<std::string> order_;
};

} // namespace

int main(int argc, char** argv)
{
    const auto tool = measure_tool();
    bench::add_synth();
    std::vector<std::string> given(argv, argv + argc);
    given.insert(given.begin() + 1, "--benchmark_enable_random_interleaving=true");
    std::vector<char*> arguments;
    for (std::string& a : given)
        arguments.push_back(a.data());
    auto count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data()))
        return 2;
    reporter r(tool);
    benchmark::RunSpecifiedBenchmarks(&r);
    benchmark::Shutdown();
    return 0;
}
