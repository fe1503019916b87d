// SPDX-License-Identifier: MIT
/// \file
/// One value from one writer that never waits to any number of readers.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactor::rt {

/// Readers retry while the writer is in the middle. The words are atomics, so that a torn read, which
/// is thrown away, is no data race. 32-bit words are lock-free on every machine.
template <typename T>
class seqlock {
    static_assert(std::is_trivially_copyable_v<T>);
    static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
    static constexpr std::size_t words = (sizeof(T) + 3) / 4;

public:
    seqlock() noexcept { store(T{}); }

    /// One thread only. Wait-free.
    void store(const T& value) noexcept
    {
        std::array<std::uint32_t, words> raw{};
        std::memcpy(raw.data(), &value, sizeof(T));
        const std::uint32_t s = sequence_.load(std::memory_order_relaxed);
        sequence_.store(s + 1, std::memory_order_relaxed);
        // Release stores instead of a fence, which ThreadSanitizer does not know: who sees one of
        // these words sees the odd number too.
        for (std::size_t i = 0; i < words; ++i)
            words_[i].store(raw[i], std::memory_order_release);
        sequence_.store(s + 2, std::memory_order_release);
    }

    T load() const noexcept
    {
        std::array<std::uint32_t, words> raw{};
        for (;;) {
            const std::uint32_t before = sequence_.load(std::memory_order_acquire);
            for (std::size_t i = 0; i < words; ++i)
                raw[i] = words_[i].load(std::memory_order_acquire);
            if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before)
                break;
        }
        T value;
        std::memcpy(static_cast<void*>(&value), raw.data(), sizeof(T));
        return value;
    }

private:
    std::atomic<std::uint32_t> sequence_{0};
    std::array<std::atomic<std::uint32_t>, words> words_{};
};

} // namespace tactor::rt
