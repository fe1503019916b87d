// SPDX-License-Identifier: MIT
/// \file
/// Triple buffer: it passes the newest value, of any size, from one writer to one reader. Neither waits for
/// the other, even if the other is preempted. Several readers need a buffer each.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace tactor::rt {

/// Three values: the writer's, the reader's, and one between them. A newer value replaces a value that was
/// not fetched.
template <typename T>
class triple_buffer {
    static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

public:
    triple_buffer() = default;
    explicit triple_buffer(const T& value) : values_{value, value, value} {}

    /// Writer: returns the value that publish() will hand over. It contains an older value.
    T& draft() noexcept { return values_[write_]; }
    void publish() noexcept { write_ = between_.exchange(write_ | fresh, std::memory_order_acq_rel) & place; }
    void store(const T& value) noexcept(std::is_nothrow_copy_assignable_v<T>)
    {
        draft() = value;
        publish();
    }

    /// Reader: takes the newest value. Returns false if the reader already has it.
    bool fetch() noexcept
    {
        if (!has_new_value())
            return false;
        read_ = between_.exchange(read_, std::memory_order_acq_rel) & place;
        return true;
    }
    /// Reader: returns true if fetch() would bring a newer value.
    bool has_new_value() const noexcept { return (between_.load(std::memory_order_relaxed) & fresh) != 0; }
    /// Reader: returns the fetched value, valid until the next fetch().
    const T& value() const noexcept { return values_[read_]; }
    /// Reader: returns the newest value, valid until the next load() or fetch().
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
