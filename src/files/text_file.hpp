// SPDX-License-Identifier: MIT
/// \file
/// Whole texts that a user named, places in them, and the files that this process has read, which an output
/// must not replace by chance. Sound, pictures, reports and logs replace none of them, under any name or
/// link. A record replaces a record, which the program updates. Text that a caller of the library writes
/// (Python's write()) replaces any: that caller reads a stroke, an array or a plan, changes it and writes it
/// again.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

#include "core/owned.hpp"

struct stat;

namespace tactor::detail {

/// Owner of the content of a file that is read or written.
enum class owner_kind {
    user,    ///< reads a drawing, a recording, an array; writes sound, a picture, a report
    program, ///< reads and writes its records
    caller,  ///< writes text through the library
};

/// Returns true if a descriptor is open to that file.
bool is_open_to(int descriptor, const struct stat& file);

/// Protection of standard output and error against going into an input. A program sets it before it reads
/// anything.
inline bool guards_standard_output = false;

/// Remembers a file that is read; a descriptor's name is /dev/fd/N. Pipes and devices do not count. Any
/// thread; blocks on the file system.
/// \throws error (bad_input) if a guarded output would go into it.
void note_input(const std::filesystem::path& file, owner_kind owner = owner_kind::user);

/// Refuses to replace a file that was read, if this writer may not replace it. Ignores inputs that have been
/// deleted or replaced since. Any thread; blocks on the file system.
/// \throws error (bad_input) with the name `output`.
void refuse_input(const struct stat& file, const std::filesystem::path& output,
                  owner_kind writer = owner_kind::user);

/// Longest array or configuration file: they are written by hand.
inline constexpr std::size_t max_setup_bytes = std::size_t{16} << 20;

/// Bytes of a file. Not a std::string, which copies itself as it grows: texts may have 512 MB.
class whole_text {
public:
    operator std::string_view() const noexcept { return {bytes_.get(), size_}; }

private:
    friend whole_text read_text(int descriptor, std::string_view name, std::size_t max_bytes);

    std::unique_ptr<char, detail::deleter<std::free>> bytes_;
    std::size_t size_ = 0;
};

/// Reads a descriptor up to its end. Needs little more memory than the text.
/// \throws error (bad_input) with `name` when it cannot be read or gives more than `max_bytes`.
whole_text read_text(int descriptor, std::string_view name, std::size_t max_bytes);

/// Reads the bytes of a file. No output replaces that file from then on. Also reads pipes and devices, up to
/// `max_bytes`.
/// \throws error (bad_input) naming the file when it is missing, a folder, not readable or longer.
whole_text read_text_file(const std::filesystem::path& file, std::size_t max_bytes,
                          owner_kind owner = owner_kind::user);

/// Refuses sound, pictures, archives, UTF-16 (which some editors save) and other bytes that are not text.
/// `hint`, here and below: empty for a file that a user named for an array, a configuration or strokes.
/// \throws error (bad_input) that names the kind; a reader's own error would be about bytes.
void refuse_no_text(std::string_view text, const std::string& name, std::string_view hint = {});

/// Syntax of a text.
enum class text_form { toml, table, xml, json };

/// Returns the form of a text by its first line.
text_form find_text_form(std::string_view text);
/// Explains why a text cannot be read as `wanted`. Returns if it may be.
/// \throws error (bad_input) for bytes that are not text, an empty text, and another form.
void refuse_other_form(std::string_view text, const std::string& name, text_form wanted,
                       std::string_view hint = {});

/// Longest stroke file: ten million timed points with all their digits. A longer one is the wrong file.
inline constexpr std::size_t max_stroke_bytes = std::size_t{512} << 20;

/// Longest text that is kept as a tree while it is read. TOML takes some 40 bytes of memory for a byte of
/// text, so a million timed points fit into 2 GB.
inline constexpr std::size_t max_tree_bytes = std::size_t{48} << 20;

/// Checks the length. \throws error (bad_input) for text longer than `max_bytes`.
void check_size(std::string_view text, const std::string& name, std::size_t max_bytes, std::string_view hint);

/// Returns the text without a byte order mark.
std::string_view without_mark(std::string_view text) noexcept;

/// Returns "stroke" for "dir/stroke.csv".
std::string stem(const std::string& name);

/// Returns line and column of an offset.
source_place find_place(std::string_view text, std::size_t offset, const std::string& name);

} // namespace tactor::detail
