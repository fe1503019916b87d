// SPDX-License-Identifier: MIT
#include <tactor/alsa.hpp>

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "alsa/adopt.hpp"
#include "alsa/handle.hpp"
#include "alsa/library_messages.hpp"
#include "alsa/negotiate.hpp"
#include "alsa/pcm_sink.hpp"
#include "model/refused.hpp"

namespace tactor {
namespace pcm {
namespace {

std::unique_ptr<sink> configure(handle h, const alsa_options& o)
try {
    const library_messages silent;
    stream_setup s = negotiate(h.get(), o);
    set_software(h.get(), s);
    return std::make_unique<pcm_sink>(std::move(h), std::move(s));
} catch (const error&) {
    throw;
} catch (const std::system_error& e) {
    detail::refused_by_system(fmt::format("PCM \"{}\"", o.pcm), e.code().value(), e.what());
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
