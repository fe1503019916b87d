// SPDX-License-Identifier: MIT
#include "report.hpp"

int main(int argc, char** argv)
{
    bench::add_synth();
    return bench::run(argc, argv);
}
