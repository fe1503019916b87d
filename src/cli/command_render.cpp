// SPDX-License-Identifier: MIT
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "session/environment.hpp"
#include "session/interrupt.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

// Returns true for a file that may be replaced: an empty one, or a WAV file.
bool holds_wav(const fs::path& file)
{
    std::array<char, 12> head{};
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), head.size());
    const std::string_view begin(head.data(), static_cast<std::size_t>(in.gcount()));
    return begin.empty() ||
           ((begin.starts_with("RIFF") || begin.starts_with("RF64")) && begin.ends_with("WAVE"));
}

// "-" is standard output. A slip of the keyboard must not replace somebody's thesis.
fs::path checked_output(const std::string& name)
{
    constexpr const char* standard_output = "/dev/stdout";
    fs::path file = name == "-" ? standard_output : name;
    if (file == standard_output) {
        if (isatty(STDOUT_FILENO) != 0)
            throw error(error_kind::bad_input, "-o",
                        "standard output is a terminal, which samples would garble",
                        "name a file, or pipe it into another program");
        return file;
    }
    std::error_code none;
    const fs::file_status there = fs::status(file, none);
    if (name.empty() || fs::is_directory(there) || (fs::exists(there) && !fs::is_regular_file(there)))
        return file;
    if (in_small_letters(file.extension().string()) != ".wav")
        throw error(error_kind::bad_input, name, "the name of a WAV file ends in .wav",
                    "name it so, or write -o - > FILE");
    if (fs::exists(there) && !holds_wav(file))
        throw error(error_kind::bad_input, name, "there is such a file, which is not a WAV file",
                    "choose another name, or remove it first");
    return file;
}

int render(settings& s, const std::string& name)
{
    const fs::path file = checked_output(name); // before the work
    const environment e = session::read_environment(s);
    const layout faces(e.tactors);
    piece p = std::move(open_pieces(s, e, faces).front());
    const render_options how = session::settle_render(s, e);
    const score sc = plan_and_score(p, s, e, faces, how);
    const format_kind format = s.format.value_or(format_kind::float32);
    say_warnings(collect_warnings(sc.plans()));
    session::tell_of_other_carrier(e, how, std::span(&sc, 1));
    session::tell_of_pipe_to_write(file.string());
    session::interrupt stop;
    int signal = 0;
    {
        progress_line line(name);
        write_wav(sc, format, file, [&](std::uint64_t done, std::uint64_t all) {
            line.update(done, all);
            signal = stop.poll();
            return signal == 0;
        });
    }
    if (signal != 0)
        return session::interrupt::status(signal);
    say(file == "/dev/stdout" ? stderr : stdout, "{}: {}, {} Hz, {}, {} ({:.3f} s)\n", name,
        counted(sc.channels(), "channel"), sc.rate(), to_string(format), counted(sc.frames(), "frame"),
        static_cast<double>(sc.frames()) / sc.rate());
    return status_ok;
}

} // namespace

int run_render(command_line& line)
{
    std::string file;
    add_strokes(line);
    settings& s = add_options(line, options::on_render);
    line.app.add_option("-o,--output", file, "the file to write; - is standard output")
        ->type_name("FILE.wav")
        ->required();
    line.app.footer("tactor render park2016-3 -o stroke.wav\n"
                    "tactor render --path \"M 0 10 L 40 30\" --speed 80 -o line.wav\n"
                    "tactor render --shape circle --duration 2 --sample-format s16 -o circle.wav");
    line.parse();
    return render(s, file);
}

} // namespace tactor::cli
