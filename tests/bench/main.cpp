// SPDX-License-Identifier: MIT
#include "report.hpp"

int main(int argc, char** argv)
{
    const auto tool = bench::measure_tool();
    bench::add_synth();
    return bench::run(argc, argv, tool);
}
