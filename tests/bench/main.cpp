// SPDX-License-Identifier: MIT
// The usual report, and what it means: how the mixer stands against a plain loop, memset and memcpy
// of as many floats.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace {

class reporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override
    {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& r : runs) {
            const auto worst = r.counters.find("worst_us");
            if (worst != r.counters.end()) {
                periods_.push_back({r.benchmark_name(), r.GetAdjustedRealTime(), worst->second.value,
                                    r.counters.at("period_us").value});
            }
            const auto rate = r.counters.find("items_per_second");
            if (rate != r.counters.end()) {
                frames_per_s_[r.benchmark_name()] = rate->second.value;
            }
        }
    }

    void Finalize() override
    {
        ConsoleReporter::Finalize();
        std::printf("\n%-24s %14s %10s %10s %10s\n", "", "frames/s", "x std_sin", "x memset", "x memcpy");
        for (const std::string piece : {"synth_9/", "synth_64/"}) {
            for (const std::string format : {"float", "s16", "s24", "s32"}) {
                line(piece, "mixer_" + format);
            }
        }
        std::printf("\n%-56s %10s %10s %10s %8s %8s\n", "cost of a period to the audio thread", "mean us",
                    "worst us", "period us", "mean %", "worst %");
        for (const period_cost& p : periods_) {
            std::printf("%-56s %10.2f %10.2f %10.1f %8.2f %8.2f\n", p.name.c_str(), p.mean_us, p.worst_us,
                        p.period_us, 100.0 * p.mean_us / p.period_us, 100.0 * p.worst_us / p.period_us);
        }
    }

private:
    struct period_cost {
        std::string name;
        double mean_us;
        double worst_us;
        double period_us;
    };

    void line(const std::string& piece, const std::string& name)
    {
        const double frames = frames_per_s_[piece + name];
        if (frames > 0.0) {
            std::printf("%-24s %14.0f", (piece + name).c_str(), frames);
            for (const char* other : {"std_sin", "memset", "memcpy"}) {
                std::printf(" %10.3f", frames / frames_per_s_[piece + other]);
            }
            std::printf("\n");
        }
    }

    std::map<std::string, double> frames_per_s_;
    std::vector<period_cost> periods_;
};

} // namespace

int main(int argc, char** argv)
{
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    reporter r;
    benchmark::RunSpecifiedBenchmarks(&r);
    benchmark::Shutdown();
    return 0;
}
