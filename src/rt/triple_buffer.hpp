// SPDX-License-Identifier: MIT
/// \file
/// The newest value from one writer to one reader; neither waits for the other, not even for one that lost
/// its processor in the middle, and the value may be of any size. Several readers have a buffer each.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace tactor::rt {

/// Three values: one is written, one is read, and one lies between. What is not fetched in time is
/// overwritten by what is newer.
template <typename T>
class triple_buffer {
    static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

public:
    triple_buffer() = default;
    explicit triple_buffer(const T& value) : values_{value, value, value} {}

    /// Writer: what publish() will hand over. Holds an older value.
    T& draft() noexcept { return values_[write_]; }
    void publish() noexcept { write_ = between_.exchange(write_ | fresh, std::memory_order_acq_rel) & place; }
    void store(const T& value) noexcept(std::is_nothrow_copy_assignable_v<T>)
    {
        draft() = value;
        publish();
    }

    /// Reader: takes the newest value; false when it has it already.
    bool fetch() noexcept
    {
        if (!has_news())
            return false;
        read_ = between_.exchange(read_, std::memory_order_acq_rel) & place;
        return true;
    }
    /// Reader: whether fetch() would bring something.
    bool has_news() const noexcept { return (between_.load(std::memory_order_relaxed) & fresh) != 0; }
    /// Reader: valid until the next fetch().
    const T& value() const noexcept { return values_[read_]; }
    /// Reader: the newest value; valid until the next load() or fetch().
    const T& load() noexcept
    {
        fetch();
        return value();
    }

private:
    static constexpr std::uint32_t place = 3;
    static constexpr std::uint32_t fresh = 4;

    std::array<T, 3> values_{};
    alignas(64) std::atomic<std::uint32_t> between_{1};
    alignas(64) std::uint32_t write_ = 0;
    alignas(64) std::uint32_t read_ = 2;
};

} // namespace tactor::rt
