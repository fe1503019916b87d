// SPDX-License-Identifier: MIT
#include "sink/alsa/configuration.hpp"

#include <cerrno>

#include <sys/eventfd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "core/refused.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

// Returns the negative errno if no file can be opened, else 0. Trying one is enough: if libasound has one
// file open and fails to open another, it gives up the whole configuration.
int lack_of_descriptors() noexcept
{
    const detail::owned_fd one(::eventfd(0, EFD_CLOEXEC));
    return one ? 0 : -errno;
}

bool defines_pcms(snd_config_t* top)
{
    snd_config_t* pcms = nullptr;
    return top != nullptr && snd_config_search(top, "pcm", &pcms) == 0;
}

} // namespace

configuration parse(const std::string& text)
{
    const library_messages messages;
    snd_config_t* c = nullptr;
    const int code = snd_config_load_string(&c, text.c_str(), text.size());
    if (code < 0)
        detail::throw_caused(error(error_kind::bad_input, "ALSA configuration text",
                                   with_detail(snd_strerror(code), messages.first()),
                                   "see the ALSA documentation of .asoundrc"),
                             -code);
    return configuration(c);
}

system_configuration::system_configuration() : refused_(lack_of_descriptors())
{
    const library_messages silent;
    if (refused_ != 0)
        return;
    snd_config_update_ref(&top_);
    if (defines_pcms(top_))
        return;
    // The configuration was read without descriptors by another part of the program, or is really empty.
    if (top_ != nullptr)
        snd_config_unref(top_);
    top_ = nullptr;
    snd_config_update_free_global();
    const int code = snd_config_update_ref(&top_);
    if (code == -EMFILE || code == -ENFILE) // the first file was opened, but not one that it includes
        refused_ = code;
}

snd_config_t* system_configuration::read() const
{
    if (refused_ != 0)
        tactor::detail::refused_by_system("ALSA's configuration", -refused_, snd_strerror(refused_));
    return top_;
}

system_configuration::~system_configuration()
{
    if (top_ != nullptr)
        snd_config_unref(top_);
}

} // namespace tactor::alsa
