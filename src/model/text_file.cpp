// SPDX-License-Identifier: MIT
#include "model/text_file.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::detail {
namespace {

struct closer {
    void operator()(std::FILE* f) const noexcept { std::fclose(f); }
};

[[noreturn]] void refuse(const std::filesystem::path& file, int code)
{
    const char* hint = code == ENOENT ? "check the name" : code == EACCES ? "check the permissions" : "";
    throw error(errc::bad_input, file.string(), std::generic_category().message(code), hint);
}

} // namespace

std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw error(errc::bad_input, file.string(), "is a directory", "name a file in it");

    const std::unique_ptr<std::FILE, closer> in(std::fopen(file.c_str(), "rbe"));
    if (!in)
        refuse(file, errno);

    constexpr std::size_t block = std::size_t{1} << 16;
    std::string text;
    for (std::size_t got = block; got == block;) {
        const std::size_t had = text.size();
        text.resize(had + block);
        got = std::fread(text.data() + had, 1, block, in.get());
        text.resize(had + got);
        if (text.size() > max_bytes)
            throw error(errc::bad_input, file.string(), fmt::format("longer than {} MB", max_bytes >> 20),
                        "is it the right file?");
    }
    if (std::ferror(in.get()))
        refuse(file, errno);
    return text;
}

} // namespace tactor::detail
