// SPDX-License-Identifier: MIT
#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/commands.hpp"
#include "cli/input.hpp"
#include "cli/interrupt.hpp"

namespace tactor::cli {
namespace {

// A line that counts up on a terminal, from the second half second of work on.
class progress_line {
public:
    explicit progress_line(std::string name) : name_(std::move(name)), terminal_(isatty(STDERR_FILENO) != 0)
    {
    }

    ~progress_line()
    {
        if (shown_)
            fmt::print(stderr, "\r\033[K");
    }

    void update(std::uint64_t done, std::uint64_t all)
    {
        const auto now = std::chrono::steady_clock::now();
        if (!terminal_ || now - last_ < std::chrono::milliseconds(500))
            return;
        last_ = now;
        shown_ = true;
        fmt::print(stderr, "\r\033[K{}: {:.1f} %", name_,
                   100.0 * static_cast<double>(done) / static_cast<double>(all));
        std::fflush(stderr);
    }

private:
    std::string name_;
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

int render(settings& s, option_list& options, const std::string& file)
{
    const environment e = read_environment(s, options);
    const piece p = plan_one_piece(s, e);
    const score sc = make_score(p, e, settle_render(s, e));
    const sample_format format = s.format.value_or(sample_format::float32);
    for (const placed_plan& q : p.plans)
        for (const std::string& w : q.schedule.warnings)
            fmt::print(stderr, "tactor: warning: {}\n", w);
    interrupt stop;
    int signal = 0;
    {
        progress_line line(file);
        write_wav(sc, format, file, [&](std::uint64_t done, std::uint64_t all) {
            line.update(done, all);
            signal = stop.poll();
            return signal == 0;
        });
    }
    if (signal != 0)
        return interrupt::status(signal);
    fmt::print("{}: {} channels, {} Hz, {}, {} frames ({:.3f} s)\n", file, sc.channels(), sc.rate(),
               to_string(format), sc.frames(), static_cast<double>(sc.frames()) / sc.rate());
    return status_ok;
}

} // namespace

command add_render(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("render", "Write the samples to a WAV file, one channel per tactor");
    auto s = std::make_shared<settings>();
    auto options = std::make_shared<option_list>(*c, *s);
    auto file = std::make_shared<std::string>();
    options->add_stroke_options();
    options->add_sound_options();
    c->add_option("-o,--output", *file, "the file to write")->type_name("FILE.wav")->required();
    c->footer("Example: tactor render --path \"M 0 10 L 40 30\" --speed 80 -o stroke.wav");
    return [s, options, file] { return render(*s, *options, *file); };
}

} // namespace tactor::cli
