// SPDX-License-Identifier: MIT
/// \file
/// What waits to be read by all peers together. One thread: the context's.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <set>

namespace tactor::net {

/// Where more waits than may, the peer for which most does is given up, not the one that is sent to next.
class write_budget {
public:
    explicit write_budget(std::size_t most = 64U << 20) : all_(std::make_shared<sum>()) { all_->most = most; }

    class share;
    std::size_t waiting() const noexcept { return all_->waiting; }

private:
    struct sum {
        std::size_t most = 0;
        std::size_t waiting = 0;
        std::set<share*> shares = {}; ///< of peers that were not given up
    };
    std::shared_ptr<sum> all_; ///< connections outlive their server: until its context ends
};

/// One peer's part of it.
class write_budget::share {
public:
    /// `give_up` is called once at most, from within anybody's add(): it must not end a share.
    share(const write_budget& all, std::function<void()> give_up);
    ~share();
    share(const share&) = delete;
    share& operator=(const share&) = delete;

    /// So many bytes more wait. False: this peer was given up instead.
    bool add(std::size_t n);
    /// The peer has taken so many.
    void take(std::size_t n) noexcept;
    /// What waits for it counts no more.
    void give_up();
    std::size_t waiting() const noexcept { return waiting_; }

private:
    void leave() noexcept;

    std::shared_ptr<sum> all_;
    std::function<void()> give_up_;
    std::size_t waiting_ = 0;
};

} // namespace tactor::net
