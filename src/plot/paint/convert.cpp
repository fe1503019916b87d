// SPDX-License-Identifier: MIT
// Makes PNG and PDF with rsvg-convert, which converts the SVG. With Cairo linked in, starting the tool would
// take three times as long as starting aplay (tests/bench/start.py).
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "plot/paint/output.hpp"

namespace tactor::plot {
namespace {

constexpr const char* program = "rsvg-convert";

// Throws error (runtime) if `code`, an errno, is not 0.
void check(int code)
{
    if (code != 0)
        throw error(error_kind::runtime, program, std::strerror(code));
}

// A file in memory. With pipes, the two processes could wait for each other; with files they cannot.
class memory_file {
public:
    memory_file() : descriptor_(::memfd_create("picture", MFD_CLOEXEC)) { check(descriptor_ ? 0 : errno); }

    int descriptor() const noexcept { return descriptor_.get(); }
    void write(std::string_view bytes) const
    {
        if (::pwrite(descriptor_.get(), bytes.data(), bytes.size(), 0) != std::ssize(bytes))
            check(errno != 0 ? errno : EFBIG);
    }
    std::string read() const
    {
        struct stat of = {};
        check(::fstat(descriptor_.get(), &of) == 0 ? 0 : errno);
        std::string bytes(static_cast<std::size_t>(of.st_size), '\0');
        if (::pread(descriptor_.get(), bytes.data(), bytes.size(), 0) != of.st_size)
            check(errno != 0 ? errno : EFBIG);
        return bytes;
    }

private:
    detail::owned_fd descriptor_;
};

[[noreturn]] void refuse_missing()
{
    throw error(error_kind::runtime, "picture",
                fmt::format("{}, which makes PNG and PDF, is missing", program),
                "install librsvg2-bin, or write SVG");
}

// Starts the program with `files` as its standard input, output and error. All other descriptors are closed.
pid_t start(std::vector<std::string> arguments, const std::array<memory_file, 3>& files)
{
    posix_spawn_file_actions_t actions;
    check(::posix_spawn_file_actions_init(&actions));
    const std::unique_ptr<posix_spawn_file_actions_t, detail::deleter<posix_spawn_file_actions_destroy>>
        owner(&actions);
    for (int i = 0; i < 3; ++i)
        check(::posix_spawn_file_actions_adddup2(&actions, files.at(static_cast<std::size_t>(i)).descriptor(),
                                                 i));
    check(::posix_spawn_file_actions_addclosefrom_np(&actions, 3));
    std::vector<char*> argv;
    for (std::string& a : arguments)
        argv.push_back(a.data());
    argv.push_back(nullptr);
    std::string no_date = "SOURCE_DATE_EPOCH=0"; // makes output files reproducible
    std::vector<char*> environment{no_date.data()};
    for (char** e = environ; *e != nullptr; ++e)
        if (!std::string_view(*e).starts_with("SOURCE_DATE_EPOCH="))
            environment.push_back(*e);
    environment.push_back(nullptr);
    pid_t child = -1;
    const int failed = ::posix_spawnp(&child, program, &actions, nullptr, argv.data(), environment.data());
    if (failed == ENOENT)
        refuse_missing();
    check(failed);
    return child;
}

// Converts the SVG with the program, and returns its output.
// \throws error (runtime) if the program is missing or fails.
std::string convert(const canvas& c, std::initializer_list<std::string> options)
{
    const std::array<memory_file, 3> files; // input, output and error messages
    files[0].write(to_svg(c));
    std::vector<std::string> arguments{program, "--unlimited"};
    arguments.insert(arguments.end(), options);
    const pid_t child = start(std::move(arguments), files);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        check(errno == EINTR ? 0 : errno);
    // Under an emulator, a missing program appears as this exit status of the child.
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        refuse_missing();
    if (status != 0) {
        const std::string messages = files[2].read();
        throw error(error_kind::runtime, program,
                    messages.empty() ? WIFEXITED(status)
                                           ? fmt::format("it ended with exit status {}", WEXITSTATUS(status))
                                           : fmt::format("it was ended by signal {}", WTERMSIG(status))
                                     : clean(messages.substr(0, messages.find('\n'))),
                    "write SVG");
    }
    return files[1].read();
}

constexpr double most_pixels = 32767; // rsvg-convert's limit for a side
constexpr double most_area = 400e6;   // this needs 1.6 GB of memory

// Inserts two chunks after the header (8 + 25 bytes): the size of a pixel, and the mark of tactor. The
// program writes neither of them.
void add_resolution_and_mark(std::string& png, unsigned dpi)
{
    constexpr std::size_t after_header = 33;
    const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
    std::string resolution = "pHYs";
    add_big_endian(resolution, per_metre);
    add_big_endian(resolution, per_metre);
    resolution += '\1';
    png.insert(after_header, make_chunk(resolution) + make_chunk(std::string(png_mark)));
}

} // namespace

std::string to_png(const canvas& c, unsigned dpi)
{
    const double scale = dpi / 72.0;
    const double width = std::round(c.width * scale);
    const double height = std::round(c.height * scale);
    if (width > most_pixels || height > most_pixels || width * height > most_area)
        throw error(error_kind::bad_input, "--dpi",
                    fmt::format("{} dpi give {:.0f} x {:.0f} pixels, but at most {:.0f} a side and {:.0f} in "
                                "all can be drawn",
                                dpi, width, height, most_pixels, most_area),
                    "use fewer dpi, a smaller --width, SVG or PDF");
    std::string png = convert(c, {"--format=png", "--background-color=white",
                                  fmt::format("--width={}", width), fmt::format("--height={}", height)});
    add_resolution_and_mark(png, dpi);
    return png;
}

std::string to_pdf(const canvas& c)
{
    std::string pdf = convert(c, {"--format=pdf"});
    // Inserts the mark as a comment before "startxref", so that the offsets in the file stay valid.
    if (const std::size_t at = pdf.rfind("\nstartxref"); at != std::string::npos)
        pdf.replace(at, std::string_view("\nstartxref").size(), pdf_mark);
    return pdf;
}

} // namespace tactor::plot
