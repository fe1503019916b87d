// SPDX-License-Identifier: MIT
#include "sink/alsa/configuration.hpp"

#include <cerrno>
#include <string_view>

#include <fmt/format.h>
#include <sys/eventfd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
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

// Returns the error for files that cannot be read, from libasound's messages: "_toplevel_:LINE:COLUMN:WHY"
// comes first and "FILE may be old or corrupted: ..." after it.
error unreadable(int code, const library_messages& messages)
{
    constexpr std::string_view nameless = "_toplevel_:";
    std::string why = messages.first();
    std::string file;
    const std::string all = messages.all();
    for (const std::string_view line : tactor::detail::split(all, '\n'))
        if (const auto end = line.find(" may be old or corrupted"); end != line.npos && file.empty())
            file = line.substr(0, end);
    if (!file.empty() && why.rfind(nameless, 0) == 0) {
        why.erase(0, nameless.size());
        const auto line = why.find(':');
        const auto column = line == why.npos ? line : why.find(':', line + 1);
        if (column != why.npos) {
            file += ":" + why.substr(0, line);
            why.erase(0, column + 1);
        }
    }
    return {error_kind::not_available, file.empty() ? "ALSA's configuration" : file,
            with_detail("ALSA cannot read its configuration", why.empty() ? snd_strerror(code) : why),
            "mend or remove this file, or one that it includes; ALSA plays nothing until then"};
}

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

} // namespace

configuration read_configuration(const std::string& text)
{
    if (!text.empty())
        return parse(text);
    const library_messages messages;
    snd_config_t* top = nullptr;
    snd_config_update_t* files = nullptr;
    int code = lack_of_descriptors();
    if (code == 0)
        code = snd_config_update_r(&top, &files, nullptr);
    if (files != nullptr)
        snd_config_update_free(files);
    configuration c(top);
    if (code == -EMFILE || code == -ENFILE)
        tactor::detail::refused_by_system("ALSA's configuration", -code, snd_strerror(code));
    if (code < 0)
        detail::throw_caused(unreadable(code, messages), -code);
    return c;
}

} // namespace tactor::alsa
