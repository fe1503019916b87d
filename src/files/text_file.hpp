// SPDX-License-Identifier: MIT
/// \file
/// Text files that a user names, and the set of files that this process has read. This set prevents an output
/// from replacing an input by mistake. Sound, pictures, reports and logs cannot replace an input, even under
/// another name or through a link. A record can replace a record that the program read, because programs
/// update their records. Text that a caller of the library writes (Python's write()) can replace any input:
/// callers read a stroke, an array or a plan, change it and write it back.
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
    user,    ///< reads drawings, recordings, arrays; writes sound, pictures, reports
    program, ///< reads and writes its own records
    caller,  ///< writes text through the library
};

/// Returns true if `file` is open as this descriptor.
bool refers_to_file(int descriptor, const struct stat& file);

/// Protection of standard output and error. If true, a file is refused as an input if one of them writes to
/// it. A program sets this before it reads any file.
inline bool guards_standard_output = false;

/// Records that a file is read. The name of a descriptor is /dev/fd/N. Ignores pipes and devices. Any thread;
/// blocks on the file system.
/// \throws error (bad_input) if standard output or error is guarded and goes to this file.
void note_input(const std::filesystem::path& file, owner_kind owner = owner_kind::user);

/// Refuses to replace a file that has been read, unless this writer may replace it. Ignores inputs that have
/// since been deleted or replaced. Any thread; blocks on the file system.
/// \throws error (bad_input) with the name `output`.
void refuse_input(const struct stat& file, const std::filesystem::path& output,
                  owner_kind writer = owner_kind::user);

/// Greatest length of an array or configuration file. People write these files by hand.
inline constexpr std::size_t max_setup_bytes = std::size_t{16} << 20;

/// Bytes of a file. This is not a std::string, because a string copies itself when it grows and texts may
/// have 512 MB.
class whole_text {
public:
    operator std::string_view() const noexcept { return {bytes_.get(), size_}; }

private:
    friend whole_text read_text(int, std::string_view, std::size_t, std::string_view);

    std::unique_ptr<char, detail::deleter<std::free>> bytes_;
    std::size_t size_ = 0;
};

/// Hint for a text that is too long.
inline constexpr std::string_view right_file = "check that it is the right file";

/// Reads a descriptor up to its end. Uses little more memory than the text needs.
/// \throws error (bad_input) with `name` if the descriptor cannot be read, and with `hint` if it has more
/// than `max_bytes`.
whole_text read_text(int descriptor, std::string_view name, std::size_t max_bytes,
                     std::string_view hint = right_file);

/// Reads the bytes of a file, which may be a pipe or a device. From then on, refuse_input() protects the file
/// against outputs.
/// \throws error (bad_input) with the file's name if the file is missing, is a folder, cannot be read or is
///         longer than `max_bytes` (with `hint`).
whole_text read_text_file(const std::filesystem::path& file, std::size_t max_bytes,
                          owner_kind owner = owner_kind::user, std::string_view hint = right_file);

/// Refuses bytes that are not text: sound, pictures, archives, UTF-16 (which some editors write) and others.
/// Here and in the next functions, an empty `hint` stands for the hint about files that a user gives as an
/// array, a configuration or strokes.
/// \throws error (bad_input) that names the kind. The error of a reader would only name a byte.
void refuse_non_text(std::string_view text, const std::string& name, std::string_view hint = {});

/// Syntax of a text.
enum class text_form { toml, table, xml, json };

/// Returns the form of a text. The first line decides.
text_form find_text_form(std::string_view text);
/// Throws an error that explains why a text is not in the form `wanted`. Returns if the text may be in this
/// form.
/// \throws error (bad_input) for bytes that are not text, an empty text, and a text in another form.
void refuse_other_form(std::string_view text, const std::string& name, text_form wanted,
                       std::string_view hint = {});

/// Greatest length of a stroke file. Ten million timed points with all their digits fit. A longer file is not
/// a stroke file.
inline constexpr std::size_t max_stroke_bytes = std::size_t{512} << 20;

/// Greatest length of a text that is read as a tree. In TOML a byte of text takes about 40 bytes of memory,
/// so a million timed points need less than 2 GB.
inline constexpr std::size_t max_tree_bytes = std::size_t{48} << 20;

/// Greatest length of a file that another program wrote, such as .tact.
inline constexpr std::size_t max_foreign_bytes = std::size_t{16} << 20;

/// Checks the length of a text. \throws error (bad_input) if it is longer than `max_bytes`.
void check_size(std::string_view text, const std::string& name, std::size_t max_bytes, std::string_view hint);

/// Returns the text without its byte order mark, if it has one.
std::string_view strip_byte_order_mark(std::string_view text) noexcept;

/// Returns the file's name without folder and extension: "stroke" for "dir/stroke.csv".
std::string stem(const std::string& name);

/// Returns the line and column of an offset in a text.
source_place find_place(std::string_view text, std::size_t offset, const std::string& name);

} // namespace tactor::detail
