// SPDX-License-Identifier: MIT
#include "files/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/stroke_format.hpp"

namespace tactor::detail {
namespace {

namespace fs = std::filesystem;
using std::string_view_literals::operator""sv;

/// A file that the process has read.
struct input {
    dev_t device = 0;
    ino_t inode = 0;
    owner_kind owner = owner_kind::user;

    bool is(const struct stat& s) const noexcept { return device == s.st_dev && inode == s.st_ino; }

    /// Returns false if the file has been deleted. Its inode number may then belong to a newer file.
    bool still_exists(const fs::path& name) const noexcept
    {
        struct stat now {};
        return ::stat(name.c_str(), &now) == 0 && is(now);
    }
};

struct inputs {
    std::mutex guard;
    std::map<fs::path, input> all; ///< by absolute name of the file
};

inputs& known_inputs()
{
    static inputs i;
    return i;
}

// Returns the first line that is neither blank nor a comment.
std::string_view find_first_line(std::string_view text)
{
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        std::size_t at = 0;
        skip_blanks(line, at);
        line.remove_prefix(at);
        if (!line.empty() && line.front() != '#')
            return line;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return {};
}

// Returns true for the header of a CSV file, even one without t_s. A line of TOML outside tables and lists
// has no comma unless it has '='.
bool looks_like_csv(std::string_view line)
{
    return line.find_first_of("=[{") == std::string_view::npos &&
           (line.find("t_s") != std::string_view::npos || line.find(',') != std::string_view::npos);
}

// Returns the caller's hint. If the hint is empty, returns the hint for a file of any kind.
std::string_view choose_hint(std::string_view hint)
{
    static const std::string kinds = fmt::format(
        "use {} for a stroke, TOML for an array or a configuration; give sound as waveform = \"FILE.wav\"",
        list_stroke_formats());
    return hint.empty() ? std::string_view(kinds) : hint;
}

[[noreturn]] void refuse(std::string_view name, int code)
{
    const char* hint = code == ENOENT ? "check the name" : code == EACCES ? "check the permissions" : "";
    throw_with_cause(error(error_kind::bad_input, source_place{std::string(name)},
                           std::generic_category().message(code), hint),
                     code);
}

// Refuses a text that begins like sound, a picture or an archive.
void refuse_binary_format(std::string_view text, const std::string& name, std::string_view hint)
{
    // In a pattern, ? stands for any byte.
    constexpr std::pair<std::string_view, std::string_view> others[] = {
        {"\x89PNG", "a PNG picture"},
        {"\xFF\xD8\xFF", "a JPEG picture"},
        {"GIF8", "a GIF picture"},
        {"II*\0"sv, "a TIFF picture"},
        {"MM\0*"sv, "a TIFF picture"},
        {"RIFF????WEBP", "a WebP picture"},
        {"????ftypheic", "a HEIC or AVIF picture"},
        {"????ftypheix", "a HEIC or AVIF picture"},
        {"????ftypmif1", "a HEIC or AVIF picture"},
        {"????ftypmsf1", "a HEIC or AVIF picture"},
        {"????ftypavif", "a HEIC or AVIF picture"},
        {"????ftyp????", "a film or sound in MP4"},
        {"RIFF????WAVE", "a WAV file"},
        {"RF64????WAVE", "a WAV file"},
        {"fLaC", "FLAC sound"},
        {"OggS", "Ogg sound"},
        {"ID3", "MP3 sound"},
        {"%PDF-", "a PDF document"},
        {"\xD0\xCF\x11\xE0", "an old Excel or Word document"},
        {"PK\x03\x04", "a ZIP archive or office document"},
        {"\x1F\x8B", "compressed by gzip"},
        {"\x93NUMPY", "an array of NumPy"},
        {"\x89HDF", "HDF5 data"},
        {"MATLAB 5.0", "data of MATLAB"}};
    const auto begins = [text](std::string_view pattern) {
        return text.size() >= pattern.size() && std::equal(pattern.begin(), pattern.end(), text.begin(),
                                                           [](char p, char c) { return p == '?' || p == c; });
    };
    for (const auto& [begin, what] : others)
        if (begins(begin))
            throw error(error_kind::bad_input, source_place{name}, fmt::format("it is {}, not text", what),
                        hint);
}

// Returns true if the descriptor is open for writing to this file.
bool writes_to(int descriptor, const struct stat& file)
{
    return refers_to_file(descriptor, file) && (::fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

} // namespace

bool refers_to_file(int descriptor, const struct stat& file)
{
    struct stat s {};
    return ::fstat(descriptor, &s) == 0 && s.st_dev == file.st_dev && s.st_ino == file.st_ino;
}

void note_input(const fs::path& file, owner_kind owner)
{
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode))
        return;
    if (guards_standard_output && (writes_to(STDOUT_FILENO, s) || writes_to(STDERR_FILENO, s)))
        throw error(error_kind::bad_input,
                    source_place{file == "/dev/fd/0" ? "standard input" : file.string()},
                    "it is the output of this program", "write to another file");
    std::error_code ignored;
    fs::path whole = fs::absolute(file, ignored);
    inputs& i = known_inputs();
    const std::lock_guard locked(i.guard);
    input& read = i.all.try_emplace(std::move(whole), input{.owner = owner}).first->second;
    read = {s.st_dev, s.st_ino, std::min(owner, read.owner)}; // an input of the user keeps this owner
}

void refuse_input(const struct stat& file, const fs::path& output, owner_kind writer)
{
    if (!S_ISREG(file.st_mode))
        return;
    inputs& i = known_inputs();
    const std::lock_guard locked(i.guard);
    for (const auto& [read, what] : i.all) {
        const bool own_record = writer == owner_kind::program && what.owner == owner_kind::program;
        if (writer == owner_kind::caller || own_record || !what.is(file) || !what.still_exists(read))
            continue;
        std::error_code ignored;
        const bool named_so = fs::absolute(output, ignored) == read || read.string().starts_with("/dev/fd/");
        throw error(error_kind::bad_input, source_place{output.string()},
                    named_so ? "it is also an input"
                             : fmt::format("it is the same file as {}, an input", read.string()),
                    "name another file for the output");
    }
}

whole_text read_text(int descriptor, std::string_view name, std::size_t max_bytes, std::string_view hint)
{
    constexpr std::size_t first_bytes = std::size_t{1} << 16;
    whole_text text;
    std::size_t capacity = 0;
    for (;;) {
        if (text.size_ == capacity) {
            // realloc() moves a large buffer by remapping its pages, without a second copy.
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
        check_size(text, std::string(name), max_bytes, hint);
    }
}

whole_text read_text_file(const fs::path& file, std::size_t max_bytes, owner_kind owner,
                          std::string_view hint)
{
    std::error_code ignored;
    if (fs::is_directory(file, ignored))
        throw error(error_kind::bad_input, source_place{file.string()}, "it is a folder", "name a file in it")
            .with_os_code(EISDIR);
    const owned_fd in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!in)
        refuse(file.string(), errno);
    note_input(file, owner);
    return read_text(in.get(), file.string(), max_bytes, hint);
}

void refuse_non_text(std::string_view text, const std::string& name, std::string_view hint)
{
    hint = choose_hint(hint);
    refuse_binary_format(text, name, hint);
    const std::string_view mark = text.substr(0, 2);
    const bool marked = mark == "\xFF\xFE" || mark == "\xFE\xFF";
    // In UTF-16 without a byte order mark, every other byte of ASCII text is 0.
    const bool bare = mark.size() == 2 && (mark[0] == '\0') != (mark[1] == '\0');
    if (marked || bare)
        throw error(error_kind::bad_input, source_place{name}, "it is UTF-16, not UTF-8",
                    "save it as UTF-8 in the editor, or convert it: iconv -f UTF-16 -t UTF-8 OLD > NEW");
    constexpr std::size_t longest_look = 4096;
    const std::string_view line = text.substr(0, std::min(text.find('\n'), longest_look));
    const auto* const odd = std::find_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' && !blank(c); });
    if (odd != line.end())
        throw error(error_kind::bad_input,
                    find_place(text, static_cast<std::size_t>(odd - line.begin()), name),
                    "it is binary, not text", hint);
}

text_form find_text_form(std::string_view text)
{
    const std::string_view line = find_first_line(strip_byte_order_mark(text));
    if (line.starts_with('<'))
        return text_form::xml;
    if (line.starts_with('{'))
        return text_form::json;
    return looks_like_csv(line) ? text_form::table : text_form::toml;
}

void refuse_other_form(std::string_view text, const std::string& name, text_form wanted,
                       std::string_view hint)
{
    hint = choose_hint(hint);
    refuse_non_text(text, name, hint);
    constexpr std::pair<text_form, std::string_view> forms[] = {{text_form::xml, "SVG, or other XML"},
                                                                {text_form::table, "a table (CSV)"},
                                                                {text_form::json, "JSON"}};
    if (without_blanks(strip_byte_order_mark(text)).empty())
        throw error(error_kind::bad_input, source_place{name}, "it is empty", hint);
    const text_form form = find_text_form(text);
    for (const auto& [other, words] : forms)
        if (other == form && other != wanted)
            throw error(
                error_kind::bad_input,
                find_place(text, static_cast<std::size_t>(find_first_line(text).data() - text.data()), name),
                fmt::format("it is {}", words), hint);
}

void check_size(std::string_view text, const std::string& name, std::size_t max_bytes, std::string_view hint)
{
    if (text.size() > max_bytes)
        throw error(error_kind::bad_input, source_place{name},
                    fmt::format("it is larger than {} MB", max_bytes >> 20), hint);
}

std::string_view strip_byte_order_mark(std::string_view text) noexcept
{
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.substr(0, mark.size()) == mark)
        text.remove_prefix(mark.size());
    return text;
}

std::string stem(const std::string& name)
{
    return fs::path(name).stem().string();
}

source_place find_place(std::string_view text, std::size_t offset, const std::string& name)
{
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const std::size_t line_start = before.rfind('\n') + 1; // 0 if there is no line feed
    return {name, static_cast<unsigned>(1 + std::count(before.begin(), before.end(), '\n')),
            static_cast<unsigned>(before.size() - line_start + 1)};
}

} // namespace tactor::detail
