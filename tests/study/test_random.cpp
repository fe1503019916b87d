// SPDX-License-Identifier: MIT
#include "study/random/random.hpp"

#include <array>
#include <numeric>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/sha256.hpp"

namespace tactor::study::test_random {
namespace {

TEST_CASE("SHA-256 is that of FIPS 180-4")
{
    CHECK(detail::sha256_text("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(detail::sha256_text("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(detail::sha256_text("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(detail::sha256_text(std::string(1000000, 'a')) ==
          "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    // Around the length at which the end needs another block.
    CHECK(detail::sha256_text(std::string(55, 'a')) ==
          "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
    CHECK(detail::sha256_text(std::string(56, 'a')) ==
          "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
}

TEST_CASE("xoshiro256** draws the numbers of its authors' program")
{
    random_numbers r(std::array<std::uint64_t, 4>{1, 2, 3, 4});
    for (const std::uint64_t known : {11520ULL, 0ULL, 1509978240ULL, 1215971899390074240ULL})
        CHECK(r.next() == known);
}

TEST_CASE("each text gives its own seed")
{
    random_numbers a("1/park2016/01/similarity");
    random_numbers again("1/park2016/01/similarity");
    random_numbers b("1/park2016/01/uniformity");
    const std::uint64_t first = a.next();
    CHECK(first == again.next());
    CHECK(first != b.next());
}

// Returns the chi-square of a fixed seed, the same each time.
double chi_square(const std::vector<unsigned>& counts)
{
    const double mean =
        std::accumulate(counts.begin(), counts.end(), 0.0) / static_cast<double>(counts.size());
    double sum = 0.0;
    for (const unsigned c : counts)
        sum += (c - mean) * (c - mean) / mean;
    return sum;
}

TEST_CASE("no number below n is favoured")
{
    random_numbers r("below");
    std::vector<unsigned> counts(7);
    for (int i = 0; i < 70000; ++i)
        ++counts.at(r.below(7));
    CHECK(chi_square(counts) < 22.5); // p = 0.001 with 6 degrees of freedom
    // 3 * 2^30: without Lemire's rejections, the lowest quarter comes twice as often as the others.
    const std::uint32_t n = 3U << 30;
    std::vector<unsigned> thirds(3);
    for (int i = 0; i < 30000; ++i)
        ++thirds.at(r.below(n) % 3);
    CHECK(chi_square(thirds) < 13.8);
    CHECK(r.below(1) == 0);
}

TEST_CASE("all orders are equally likely")
{
    random_numbers r("shuffle");
    std::vector<unsigned> counts(24);
    for (int i = 0; i < 24000; ++i) {
        std::array<unsigned, 4> v{0, 1, 2, 3};
        shuffle(std::span<unsigned>(v), r);
        unsigned rank = 0; // of the order, by its inversions
        for (std::size_t k = 0; k < v.size(); ++k) {
            unsigned smaller = 0;
            for (std::size_t m = k + 1; m < v.size(); ++m)
                smaller += v[m] < v[k] ? 1 : 0;
            rank = rank * static_cast<unsigned>(v.size() - k) + smaller;
        }
        ++counts.at(rank);
    }
    CHECK(chi_square(counts) < 49.7); // p = 0.001 with 23
}

TEST_CASE("normal numbers have mean 0 and variance 1")
{
    random_numbers r("normal");
    double sum = 0.0;
    double squares = 0.0;
    constexpr int n = 40000;
    for (int i = 0; i < n; ++i) {
        const double x = r.normal();
        sum += x;
        squares += x * x;
    }
    CHECK(std::abs(sum / n) < 0.02);
    CHECK(std::abs(squares / n - 1.0) < 0.03);
}

} // namespace
} // namespace tactor::study::test_random
