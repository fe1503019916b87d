// SPDX-License-Identifier: MIT
#include <tactor/alsa.hpp>

#include <utility>

#include "alsa/adopt.hpp"
#include "alsa/handle.hpp"
#include "alsa/library_messages.hpp"
#include "alsa/negotiate.hpp"
#include "alsa/pcm_sink.hpp"

namespace tactor {
namespace pcm {
namespace {

std::unique_ptr<sink> configure(handle h, const alsa_options& o)
{
    const library_messages silent;
    stream_setup s = negotiate(h.get(), o);
    set_software(h.get(), s);
    return std::make_unique<pcm_sink>(std::move(h), std::move(s));
}

} // namespace

std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o)
{
    handle h(p);
    check(o);
    return configure(std::move(h), o);
}

} // namespace pcm

std::unique_ptr<sink> open_alsa(const alsa_options& o)
{
    pcm::check(o);
    return pcm::configure(pcm::open(o), o);
}

} // namespace tactor
