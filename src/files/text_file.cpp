// SPDX-License-Identifier: MIT
#include "files/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <new>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "core/refused.hpp"

namespace tactor::detail {
namespace {

[[noreturn]] void refuse(std::string_view name, int code)
{
    const char* hint = code == ENOENT ? "check the name" : code == EACCES ? "check the permissions" : "";
    throw_caused(error(error_kind::bad_input, source_place{std::string(name)},
                       std::generic_category().message(code), hint),
                 code);
}

} // namespace

whole_text read_text(int descriptor, std::string_view name, std::size_t max_bytes)
{
    constexpr std::size_t first_bytes = std::size_t{1} << 16;
    whole_text text;
    std::size_t capacity = 0;
    for (;;) {
        if (text.size_ == capacity) {
            // Large ones are moved by mapping their pages elsewhere, not by a copy beside them.
            capacity = std::min(std::max(capacity * 2, first_bytes), max_bytes + 1);
            void* moved = std::realloc(text.bytes_.get(), capacity);
            if (moved == nullptr)
                throw std::bad_alloc();
            static_cast<void>(text.bytes_.release());
            text.bytes_.reset(static_cast<char*>(moved));
        }
        const ssize_t got = ::read(descriptor, text.bytes_.get() + text.size_, capacity - text.size_);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            refuse(name, errno);
        if (got == 0)
            return text;
        text.size_ += static_cast<std::size_t>(got);
        if (text.size_ > max_bytes)
            throw error(error_kind::bad_input, source_place{std::string(name)},
                        fmt::format("longer than {} MB", max_bytes >> 20), "is it the right file?");
    }
}

whole_text read_text_file(const std::filesystem::path& file, std::size_t max_bytes, owner_kind owner)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw error(error_kind::bad_input, source_place{file.string()}, "is a folder", "name a file in it")
            .with_os_code(EISDIR);
    const owned_fd in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!in)
        refuse(file.string(), errno);
    note_input(file, owner);
    return read_text(in.get(), file.string(), max_bytes);
}

void refuse_other_kind(std::string_view text, const std::string& name, std::string_view hint)
{
    struct other_kind {
        std::string_view begin;
        std::string_view what;
    };
    constexpr other_kind others[] = {{"\x89PNG", "a PNG picture"},
                                     {"\xFF\xD8\xFF", "a JPEG picture"},
                                     {"%PDF-", "a PDF document"},
                                     {"PK\x03\x04", "a ZIP archive or office document"},
                                     {"\x1F\x8B", "compressed by gzip"},
                                     {"fLaC", "FLAC sound"},
                                     {"OggS", "Ogg sound"},
                                     {"ID3", "MP3 sound"}};
    std::string_view what;
    if ((text.starts_with("RIFF") || text.starts_with("RF64")) && text.substr(0, 12).ends_with("WAVE"))
        what = "a WAV file";
    for (const other_kind& o : others)
        if (text.starts_with(o.begin))
            what = o.what;
    if (!what.empty())
        throw error(error_kind::bad_input, source_place{name}, fmt::format("is {}, not text", what), hint);
}

void refuse_no_text(std::string_view text, const std::string& name, std::string_view hint)
{
    refuse_other_kind(text, name, hint);
    const std::string_view mark = text.substr(0, 2);
    const bool marked = mark == "\xFF\xFE" || mark == "\xFE\xFF";
    // Without a mark, every other byte of plain letters is 0.
    const bool bare = mark.size() == 2 && (mark[0] == '\0') != (mark[1] == '\0');
    if (marked || bare)
        throw error(error_kind::bad_input, source_place{name}, "is UTF-16, not UTF-8",
                    "save it as UTF-8 in the editor, or convert it: iconv -f UTF-16 -t UTF-8 OLD > NEW");
}

void check_size(std::string_view text, const std::string& name, std::size_t max_bytes, std::string_view hint)
{
    if (text.size() > max_bytes)
        throw error(error_kind::bad_input, source_place{name},
                    fmt::format("longer than {} MB", max_bytes >> 20), hint);
}

std::string_view without_mark(std::string_view text) noexcept
{
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.substr(0, mark.size()) == mark)
        text.remove_prefix(mark.size());
    return text;
}

std::string stem(const std::string& name)
{
    return std::filesystem::path(name).stem().string();
}

source_place find_place(std::string_view text, std::size_t offset, const std::string& name)
{
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const std::size_t line_start = before.rfind('\n') + 1; // 0 where there is none
    return {name, static_cast<unsigned>(1 + std::count(before.begin(), before.end(), '\n')),
            static_cast<unsigned>(before.size() - line_start + 1)};
}

} // namespace tactor::detail
