// SPDX-License-Identifier: MIT
/// \file
/// A process that has few descriptors left.
#pragma once

#include <vector>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace tactor::test {

/// Leaves the process so many descriptors, as long as it lives.
class descriptors_left {
public:
    explicit descriptors_left(unsigned n)
    {
        REQUIRE(::getrlimit(RLIMIT_NOFILE, &before_) == 0);
        rlimit few = before_;
        few.rlim_cur = 256;
        REQUIRE(::setrlimit(RLIMIT_NOFILE, &few) == 0);
        for (int fd = ::dup(0); fd >= 0; fd = ::dup(0))
            taken_.push_back(fd);
        REQUIRE(taken_.size() > n);
        for (unsigned i = 0; i < n; ++i)
            release();
    }
    ~descriptors_left()
    {
        while (!taken_.empty())
            release();
        ::setrlimit(RLIMIT_NOFILE, &before_);
    }
    descriptors_left(const descriptors_left&) = delete;
    descriptors_left& operator=(const descriptors_left&) = delete;

private:
    void release()
    {
        ::close(taken_.back());
        taken_.pop_back();
    }

    rlimit before_{};
    std::vector<int> taken_;
};

} // namespace tactor::test
