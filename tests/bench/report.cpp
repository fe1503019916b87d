// SPDX-License-Identifier: MIT
#include "report.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pieces.hpp"

namespace bench {

using namespace tactor;

std::string benchmark_name(const std::string& what, std::size_t bytes)
{
    return fmt::format("{}/{}_bytes", what, bytes);
}

std::string synth_row::name() const
{
    return fmt::format("synth/{}_channels/{}_strokes/{}/{}", channels, strokes,
                       continuous ? "continuous" : "burst", to_string(format));
}

std::string synth_row::plain_name() const
{
    return fmt::format("std_sin/{}_channels/{}_strokes/{}", channels, strokes,
                       continuous ? "continuous" : "burst");
}

std::vector<synth_row>& table()
{
    static std::vector<synth_row> rows;
    return rows;
}

namespace {

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
        std::printf("\nSynthesis of 10 ms (%zu frames), in cache; best of the repetitions\n", block);
        std::printf("%8s %8s %-11s %-7s %10s %10s %10s %10s %8s\n", "channels", "strokes", "algorithm",
                    "format", "ns", "x std::sin", "of memcpy", "of memset", "core %");
        for (const synth_row& row : table()) {
            const double ns = time(row.name());
            if (ns == 0.0)
                continue;
            const std::size_t bytes = block * row.channels * sample_bytes(row.format);
            std::printf("%8u %8u %-11s %-7s %10.0f %10s %10s %10s %8.3f\n", row.channels, row.strokes,
                        row.strokes == 0 ? "silence"
                        : row.continuous ? "continuous"
                                         : "burst",
                        std::string(to_string(row.format)).c_str(), ns,
                        ratio(time(row.plain_name()), ns).c_str(),
                        ratio(time(benchmark_name("memcpy", bytes)), ns).c_str(),
                        ratio(time(benchmark_name("memset", bytes)), ns).c_str(), 100.0 * ns / 10e6);
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

int run(int argc, char** argv, const std::vector<tool_row>& tool)
{
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

} // namespace bench
