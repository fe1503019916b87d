// SPDX-License-Identifier: MIT
// Plays so many blocks of one stroke on nine channels, and nothing else: for bench/instructions, which counts
// instructions where clocks mean nothing.
//   tactor-count mixer|std_sin BLOCKS
#include <span>
#include <string>

#include "pieces.hpp"

int main(int argc, char** argv)
{
    if (argc != 3)
        return 2;
    const int blocks = std::atoi(argv[2]);
    const tactor::score s = bench::piece(9, 1, tactor::algorithm_kind::park2016);
    std::vector<float> out(bench::block * s.channels());
    if (std::string(argv[1]) == "std_sin") {
        bench::plain_loop plain(s, bench::plans(9, 1, tactor::algorithm_kind::park2016), 0.2);
        for (int i = 0; i < blocks; ++i)
            plain.process(bench::block, out.data());
    } else {
        tactor::renderer mixer(s, tactor::format_kind::float32);
        for (int i = 0; i < blocks; ++i)
            mixer.process(std::as_writable_bytes(std::span(out)));
    }
    return 0;
}
