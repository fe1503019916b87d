// SPDX-License-Identifier: MIT
#include "cli/check/walk_session.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "files/setup_text.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

error already_there(const std::string& name)
{
    return {error_kind::bad_input, name, "there is such a file already",
            "choose another name: it is not overwritten"};
}

} // namespace

void check_new_file(const std::string& name)
{
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(name, ignored)))
        throw already_there(name);
    const fs::path folder = fs::path(name).parent_path();
    if (!folder.empty() && !fs::is_directory(folder, ignored))
        throw error(error_kind::bad_input, name, fmt::format("there is no folder {}", folder.string()),
                    "make it first");
}

void write_channel_file(const std::string& name, const environment& e, const std::vector<unsigned>& channels)
{
    const setup besides = e.array_file.empty() ? setup{} : load_setup(e.array_file);
    array felt = e.tactors;
    for (std::size_t i = 0; i < channels.size(); ++i)
        felt.tactors[i].channel = channels[i];
    const std::string text = "# Channels as felt on a walk (tactor check --walk).\n" +
                             detail::array_text(felt, besides) +
                             (besides.calibration ? detail::origin_text(*besides.calibration) : "");
    // output_file would replace an existing one.
    std::FILE* const file = std::fopen(name.c_str(), "wxe");
    if (file == nullptr && errno == EEXIST)
        throw already_there(name);
    if (file == nullptr)
        throw error(error_kind::runtime, name, std::strerror(errno));
    const bool whole = std::fputs(text.c_str(), file) >= 0;
    const int code = errno;
    if (std::fclose(file) == 0 && whole)
        return;
    const int reason = whole ? errno : code;
    std::remove(name.c_str());
    throw error(error_kind::runtime, name, std::strerror(reason));
}

} // namespace tactor::cli
