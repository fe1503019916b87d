// SPDX-License-Identifier: MIT
#include "synth/mix/sample_ranges.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace sample_ranges_test {

using namespace tactor::synth;

TEST_CASE("the least and greatest sample of each channel do not depend on the block size")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> sample(-1.0F, 1.0F);
    for (const std::size_t channels : {1U, 2U, 3U, 9U, 16U, 64U, 300U, 5000U}) {
        CAPTURE(channels);
        sample_ranges ranges(channels);
        for (const std::size_t frames : {1U, 2U, 15U, 16U, 17U, 100U}) {
            CAPTURE(frames);
            std::vector<float> samples(frames * channels);
            std::generate(samples.begin(), samples.end(), [&] { return sample(random); });
            ranges.clear();
            const std::size_t first = frames / 3;
            ranges.add(samples.data(), first);
            ranges.add(samples.data() + first * channels, frames - first);
            bool same = true;
            for (std::size_t c = 0; c < channels; ++c) {
                float low = samples[c];
                float high = samples[c];
                for (std::size_t i = c; i < samples.size(); i += channels) {
                    low = std::min(low, samples[i]);
                    high = std::max(high, samples[i]);
                }
                const auto [least, most] = ranges.range_at(c);
                same = same && least == low && most == high;
            }
            CHECK(same);
        }
    }
}

} // namespace sample_ranges_test
