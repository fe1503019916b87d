// SPDX-License-Identifier: MIT
#include "study/session/session_keys.hpp"
#include "rt/clock.hpp"

#include <string>

#include <tactor/error.hpp>

namespace tactor::study {
namespace {

std::optional<operator_key> operator_key_of(char c)
{
    switch (c) {
    case 'r':
        return operator_key::repeat;
    case 'v':
        return operator_key::void_last;
    case 'p':
        return operator_key::pause;
    case 'g':
        return operator_key::go_on;
    case 'q':
        return operator_key::quit;
    default:
        return {};
    }
}

unsigned digit(char c)
{
    return c >= '1' && c <= '9' ? static_cast<unsigned>(c - '0') : 0;
}

std::optional<session_key> key_of(const std::optional<std::string>& said)
{
    if (!said)
        return {};
    session_key k{.at_ns = rt::monotonic_ns()};
    if (said->size() != 1)
        return k;
    k.character = said->front();
    k.asked = operator_key_of(k.character);
    k.answer = digit(k.character);
    return k;
}

} // namespace

session_keys::session_keys(stage& s, const answering& with)
    : stage_(s), page_(with.page), input_(with.keypads, page_ == nullptr ? -1 : page_->descriptor())
{
}

void session_keys::drop_pressed()
{
    while (input_.pressed())
        ;
}

std::optional<session_key> session_keys::poll()
{
    if (page_ == nullptr)
        return key_of(input_.next());
    while (const auto key = input_.pressed())
        page_->press(*key);
    while (const auto k = key_of(input_.typed()))
        if (k->asked)
            return session_key{.asked = k->asked, .at_ns = k->at_ns};
    if (const auto a = page_->poll())
        return session_key{a->key, {}, digit(a->key), a->at_ns};
    return {};
}

session_key session_keys::wait()
{
    for (;;) {
        if (const auto k = poll())
            return *k;
        if (page_ == nullptr && input_.ended())
            throw error(error_kind::runtime, "the session", "there is no answer any more",
                        "what was answered is kept; --resume goes on");
        stage_.wait_for(input_.descriptor());
    }
}

} // namespace tactor::study
