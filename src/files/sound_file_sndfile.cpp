// SPDX-License-Identifier: MIT
// libsndfile brings eight libraries of other formats, which cost the tool half its start: it is loaded when a
// recording is read.
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>

#include <dlfcn.h>
#include <sndfile.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "files/sound_file.hpp"

namespace tactor::detail {
namespace {

struct library {
    decltype(&sf_open_virtual) open = nullptr;
    decltype(&sf_readf_float) read = nullptr;
    decltype(&sf_close) close = nullptr;
    decltype(&sf_strerror) message = nullptr;
};

// Stays loaded.
library load()
{
    void* handle = ::dlopen("libsndfile.so.1", RTLD_NOW | RTLD_LOCAL);
    library l;
    const auto find = [handle](const char* name, auto& function) {
        void* symbol = handle == nullptr ? nullptr : ::dlsym(handle, name);
        std::memcpy(&function, &symbol, sizeof symbol);
        return symbol != nullptr;
    };
    if (!find("sf_open_virtual", l.open) || !find("sf_readf_float", l.read) || !find("sf_close", l.close) ||
        !find("sf_strerror", l.message)) {
        const char* why = ::dlerror();
        throw error(error_kind::not_available, "libsndfile",
                    fmt::format("recordings need it: {}", why == nullptr ? "it cannot be loaded" : why),
                    "install the package libsndfile1");
    }
    return l;
}

/// Bytes that libsndfile reads as a file.
class memory_file {
public:
    explicit memory_file(std::string_view bytes) : bytes_(bytes) {}

    static SF_VIRTUAL_IO calls() noexcept
    {
        SF_VIRTUAL_IO io{};
        io.get_filelen = [](void* f) noexcept { return self(f).size(); };
        io.seek = [](sf_count_t by, int from, void* f) noexcept { return self(f).seek(by, from); };
        io.read = [](void* to, sf_count_t bytes, void* f) noexcept { return self(f).read(to, bytes); };
        io.write = [](const void*, sf_count_t, void*) noexcept { return sf_count_t{0}; };
        io.tell = [](void* f) noexcept { return self(f).at_; };
        return io;
    }

private:
    static memory_file& self(void* f) noexcept { return *static_cast<memory_file*>(f); }

    sf_count_t size() const noexcept { return static_cast<sf_count_t>(bytes_.size()); }

    sf_count_t seek(sf_count_t by, int from) noexcept
    {
        const sf_count_t base = from == SEEK_CUR ? at_ : from == SEEK_END ? size() : 0;
        at_ = std::clamp<sf_count_t>(by, -base, size() - base) + base;
        return at_;
    }

    sf_count_t read(void* to, sf_count_t bytes) noexcept
    {
        const sf_count_t n = std::clamp<sf_count_t>(bytes, 0, size() - at_);
        std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(n));
        at_ += n;
        return n;
    }

    std::string_view bytes_;
    sf_count_t at_ = 0;
};

/// Samples without a header: libsndfile's readers of headers do not survive a lack of memory.
int raw_format(const wav_format& f)
{
    constexpr std::array integers{SF_FORMAT_PCM_U8, SF_FORMAT_PCM_16, SF_FORMAT_PCM_24, SF_FORMAT_PCM_32};
    const int samples = f.tag == 3   ? (f.bits == 32 ? SF_FORMAT_FLOAT : SF_FORMAT_DOUBLE)
                        : f.tag == 6 ? SF_FORMAT_ALAW
                        : f.tag == 7 ? SF_FORMAT_ULAW
                                     : integers.at(f.bytes - 1U);
    return SF_FORMAT_RAW | SF_ENDIAN_LITTLE | samples;
}

/// Returns the three lower bytes of each four.
std::string lower_bytes(std::string_view samples)
{
    std::string s;
    s.reserve(samples.size() / 4 * 3);
    for (std::size_t i = 0; i + 4 <= samples.size(); i += 4)
        s += samples.substr(i, 3);
    return s;
}

/// Returns true if 24 bits are the upper three bytes of four (Microsoft); those of ALSA (S24_LE) and of what
/// records with it have the lower three and, above, their sign, zeros or anything.
bool is_in_upper_bytes(std::string_view samples)
{
    bool signs_only = true;
    for (std::size_t i = 0; i + 4 <= samples.size(); i += 4) {
        const bool negative = (static_cast<unsigned char>(samples[i + 2]) & 0x80U) != 0;
        if (samples[i] != '\0')
            return false;
        signs_only = signs_only && (samples[i + 3] == '\0' || (negative && samples[i + 3] == '\xFF'));
    }
    return !signs_only;
}

} // namespace

std::vector<float> decode_wav(const wav_parts& parts, std::size_t most, const std::string& name)
{
    static const library sndfile = load();
    wav_format f = parts.format;
    std::string_view samples = parts.samples.substr(0, most * f.bytes);
    std::string packed;
    if (f.tag == 1 && f.bytes == 4 && f.bits <= 24) {
        if (!is_in_upper_bytes(samples)) {
            packed = lower_bytes(samples);
            samples = packed;
            f.bytes = 3;
        }
    }
    memory_file file(samples);
    SF_VIRTUAL_IO calls = memory_file::calls();
    SF_INFO info{};
    info.format = raw_format(f);
    info.channels = 1;
    info.samplerate = 48000; // of no use here
    const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> in(sndfile.open(&calls, SFM_READ, &info, &file),
                                                         sndfile.close);
    if (!in) {
        const std::string_view why = sndfile.message(nullptr);
        if (why.find("malloc") != std::string_view::npos)
            throw std::bad_alloc();
        throw error(error_kind::bad_input, source_place{name}, fmt::format("libsndfile refuses it: {}", why),
                    "give a WAV file of one channel");
    }
    std::vector<float> x(std::min(samples.size() / f.bytes, most));
    const sf_count_t got = sndfile.read(in.get(), x.data(), static_cast<sf_count_t>(x.size()));
    x.resize(static_cast<std::size_t>(std::max<sf_count_t>(got, 0)));
    return x;
}

} // namespace tactor::detail
