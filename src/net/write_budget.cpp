// SPDX-License-Identifier: MIT
#include "net/write_budget.hpp"

#include <algorithm>
#include <utility>

namespace tactor::net {

write_budget::share::share(const write_budget& all, std::function<void()> give_up)
    : all_(all.all_), give_up_(std::move(give_up))
{
    all_->shares.insert(this);
}

write_budget::share::~share()
{
    leave();
}

bool write_budget::share::add(std::size_t n)
{
    if (!all_->shares.contains(this))
        return false;
    const auto least = [&](const share* a, const share* b) {
        return a->waiting_ + (a == this ? n : 0) < b->waiting_ + (b == this ? n : 0);
    };
    while (all_->waiting + n > all_->most) {
        share* most = *std::max_element(all_->shares.begin(), all_->shares.end(), least);
        most->give_up();
        if (most == this)
            return false;
    }
    waiting_ += n;
    all_->waiting += n;
    return true;
}

void write_budget::share::take(std::size_t n) noexcept
{
    n = std::min(n, waiting_);
    waiting_ -= n;
    all_->waiting -= n;
}

void write_budget::share::give_up()
{
    leave();
    if (give_up_)
        std::exchange(give_up_, {})();
}

void write_budget::share::leave() noexcept
{
    take(waiting_);
    all_->shares.erase(this);
}

} // namespace tactor::net
