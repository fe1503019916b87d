// SPDX-License-Identifier: MIT
/// \file
/// Lock-free ring between one producer thread and one consumer thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace tactor::rt {

/// Bytes of a cache line. clang 14 lacks std::hardware_destructive_interference_size; x86-64 and the Cortex-A
/// cores of all Raspberry Pis have 64.
inline constexpr std::size_t cache_line = 64;

/// Ring of trivially copyable elements. Each side reads its own index relaxed and the other side's index with
/// acquire, and publishes its own index with release. The indices run freely, so that no element is wasted to
/// tell full from empty. Only the constructor allocates. To flush the ring, the consumer pops until it is
/// empty.
template <typename T>
class spsc_ring {
    static_assert(std::is_trivially_copyable_v<T>);
    static_assert(std::atomic<std::size_t>::is_always_lock_free);

public:
    /// Makes a ring for `at_least` elements, rounded up to a power of two. `first_index` lets tests start
    /// near the wrap of the indices, which a 32-bit machine reaches.
    explicit spsc_ring(std::size_t at_least, std::size_t first_index = 0)
        : slots_(std::bit_ceil(std::max<std::size_t>(at_least, 1))),
          mask_(slots_.size() - 1),
          write_(first_index),
          read_seen_(first_index),
          read_(first_index),
          write_seen_(first_index)
    {
    }

    std::size_t capacity() const noexcept { return slots_.size(); }

    /// Producer: returns the number of elements that fit now. The consumer can only increase it.
    std::size_t available() noexcept
    {
        read_seen_ = read_.load(std::memory_order_acquire);
        return capacity() - (write_.load(std::memory_order_relaxed) - read_seen_);
    }

    /// Producer: appends, or returns false when full.
    bool push(const T& value) noexcept
    {
        const std::size_t w = write_.load(std::memory_order_relaxed);
        if (w - read_seen_ == capacity()) {
            read_seen_ = read_.load(std::memory_order_acquire);
            if (w - read_seen_ == capacity())
                return false;
        }
        slots_[w & mask_] = value;
        write_.store(w + 1, std::memory_order_release);
        return true;
    }

    /// Producer: appends as many as fit, in order, and returns their number.
    std::size_t push(std::span<const T> values) noexcept
    {
        const std::size_t n = std::min(values.size(), available());
        const std::size_t w = write_.load(std::memory_order_relaxed);
        for (std::size_t i = 0; i < n; ++i)
            slots_[(w + i) & mask_] = values[i];
        write_.store(w + n, std::memory_order_release);
        return n;
    }

    /// Consumer: returns the number of elements that wait now. The producer can only increase it.
    std::size_t size() noexcept
    {
        write_seen_ = write_.load(std::memory_order_acquire);
        return write_seen_ - read_.load(std::memory_order_relaxed);
    }

    /// Consumer: returns the oldest element, valid until drop_front(), or null when empty.
    const T* front() noexcept
    {
        const std::size_t r = read_.load(std::memory_order_relaxed);
        if (r == write_seen_) {
            write_seen_ = write_.load(std::memory_order_acquire);
            if (r == write_seen_)
                return nullptr;
        }
        return &slots_[r & mask_];
    }

    /// Consumer: removes the oldest element; there must be one.
    void drop_front() noexcept
    {
        read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }

    /// Consumer: takes the oldest element, or returns false when empty.
    bool pop(T& value) noexcept
    {
        const T* p = front();
        if (p == nullptr)
            return false;
        value = *p;
        drop_front();
        return true;
    }

private:
    std::vector<T> slots_;
    const std::size_t mask_;
    alignas(cache_line) std::atomic<std::size_t> write_; // written by the producer
    std::size_t read_seen_;                              // the producer's copy of read_
    alignas(cache_line) std::atomic<std::size_t> read_;  // written by the consumer
    std::size_t write_seen_;                             // the consumer's copy of write_
};

} // namespace tactor::rt
