// SPDX-License-Identifier: MIT
#include "alsa/error_text.hpp"

#include <cerrno>

#include <alsa/asoundlib.h>
#include <fmt/format.h>

namespace tactor::pcm {
namespace {

std::string thing(const std::string& name)
{
    return fmt::format("PCM \"{}\"", name);
}

} // namespace

std::string with_detail(const std::string& text, const std::string& detail)
{
    return detail.empty() ? text : fmt::format("{}: {}", text, detail);
}

error open_error(const std::string& name, int code, const std::string& detail)
{
    const std::string what = thing(name);
    switch (-code) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return {errc::not_available, what, with_detail("no such PCM", detail), "list them with aplay -L"};
    case EBUSY:
        return {errc::not_available, what, "it is busy: another program plays on it",
                "stop that program; fuser -v /dev/snd/* names it"};
    case EACCES:
    case EPERM:
        return {errc::not_available, what, "no permission to open it", "add the user to the group audio"};
    default:
        return {errc::not_available, what, with_detail(snd_strerror(code), detail),
                "list the PCMs with aplay -L"};
    }
}

error call_error(const std::string& name, const char* call, int code)
{
    return {errc::not_available, thing(name), fmt::format("{} failed: {}", call, snd_strerror(code))};
}

} // namespace tactor::pcm
