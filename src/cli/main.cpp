// SPDX-License-Identifier: MIT
// The main function. It finds the command, completes words for shells, and determines the exit status.
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/stroke.hpp>
#include <tactor/version.hpp>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "cli/usage.hpp"
#include "core/split.hpp"
#include "files/text_file.hpp"
#include "options/resolve.hpp"
#include "session/process.hpp"
#include "study/experiment/read_definition.hpp"

namespace tactor::cli {
namespace {

struct command {
    std::string_view name;
    const char* summary;
    int (*run)(command_line&);
};
constexpr std::array commands{
    command{"plan", "Print which tactor plays when, and how strongly", run_plan},
    command{"render", "Write the samples to a WAV file, one channel per tactor", run_render},
    command{"play", "Play strokes on the array", run_play},
    command{"plot", "Draw the array, the path and the bursts over time", run_plot},
    command{"convert", "Write strokes as a file of another format", run_convert},
    command{"compare", "Predict how a stroke feels with several algorithms", run_compare},
    command{"calibrate", "Measure a participant's threshold at each tactor", run_calibrate},
    command{"experiment", "Run an experiment with a participant or a simulated one", run_experiment},
    command{"analyze", "Print the statistics of a study", run_analyze},
    command{"report", "Write the methods section of a study's paper", run_report},
    command{"devices", "List sound devices with their abilities, and GPIO lines", run_devices},
    command{"check", "Check array, device, rights, limits, lines and wiring", run_check},
    command{"off", "Switch the amplifier off", run_off},
    command{"serve", "Own the array and let other programs play on it", run_serve},
    command{"status", "Print what the server is doing", run_status},
    command{"stop", "Fade out all strokes of the server", run_stop}};

std::string version_text()
{
    return fmt::format("tactor {}\n{}", version(), build_facts());
}

const command* find_command(std::string_view name)
{
    const auto c =
        std::find_if(commands.begin(), commands.end(), [&](const command& x) { return x.name == name; });
    return c == commands.end() ? nullptr : &*c;
}

// Returns the first command that is named in the words, or null if there is none.
const command* find_command(const std::vector<std::string>& words)
{
    for (const std::string& w : words)
        if (const command* c = find_command(w))
            return c;
    return nullptr;
}

// Returns the arguments. Changes `tactor help plan` to `tactor plan --help`, for people without manual pages.
std::vector<std::string> arguments(int argc, char** argv)
{
    std::vector<std::string> all(argv + 1, argv + argc);
    if (all.empty() || all.front() != "help")
        return all;
    while (!all.empty() && all.front() == "help")
        all.erase(all.begin());
    if (all.size() == 1 && find_command(all.front()) == nullptr)
        return {"help", all.front()};
    if (all.empty() || find_command(all.front()) != nullptr) // other words cause an error
        all.emplace_back("--help");
    return all;
}

// Returns an error about a typing mistake in the words if there is one. Otherwise returns `e`.
error explain(const error& e, const std::vector<std::string>& words)
{
    if (e.kind() != error_kind::bad_input)
        return e;
    std::vector<std::string> names;
    for (const command& c : commands)
        names.emplace_back(c.name);
    return find_typing_mistake(words, names).value_or(e);
}

template <class F>
void show_options(const CLI::App& app, const command& c, F show)
{
    command_line line{*app.get_subcommand(std::string(c.name)), {}, show};
    try {
        c.run(line);
    } catch (const CLI::Success&) { // NOLINT(bugprone-empty-catch): it has shown them
    }
}

// Prints a word if it begins with `typed`. The shell gets a line with the word, a tab and the description.
void print_completion(const std::string& typed, const std::string& word, const std::string& description)
{
    if (word.starts_with(typed))
        fmt::print("{}{}{}\n", word, description.empty() ? "" : "\t", description);
}

// Returns the names of cards that stay the same after a reboot. Does not open devices, because completion
// must not affect them.
std::vector<std::string> pcm_names()
{
    std::vector<std::string> names{"null"};
    std::ifstream cards("/proc/asound/cards");
    for (std::string line; std::getline(cards, line);) {
        const std::size_t open = line.find('[');
        const std::size_t close = line.find_first_of(" ]", open);
        if (close != std::string::npos)
            names.push_back("hw:CARD=" + line.substr(open + 1, close - open - 1));
    }
    return names;
}

// Offers the values of an option or argument. Its type either lists the values, "a|b|c" or "a,b,c", or is the
// kind of value in capitals.
void suggest_values(const std::string& type, const std::string& typed, const std::string& before)
{
    const auto offer_all = [&](const auto& values) {
        for (const std::string_view v : values)
            if (!v.empty() && v != "..." &&
                std::none_of(v.begin(), v.end(), [](unsigned char c) { return std::isupper(c) != 0; }))
                print_completion(before + typed, before + std::string(v), "");
    };
    const auto means = [&](const char* word) { return type.find(word) != std::string::npos; };
    if (type == "NAME|FILE")
        offer_all(array_presets());
    else if (type == "PCM")
        offer_all(pcm_names());
    else if (type == "STROKE" || type == "IN")
        offer_all(stroke_presets());
    else if (type == "EXPERIMENT")
        offer_all(std::array{study::shipped_experiment});
    else if (!type.starts_with("FILE"))
        offer_all(detail::split(type, type.find('|') == std::string::npos ? ',' : '|'));
    if (means("FILE") || means("DIR") || means("PATH") || means("STROKE") || means("EXPERIMENT") ||
        type == "IN" || type == "OUT")
        fmt::print(":files\n");
}

void suggest_options(const CLI::App& command, const std::string& typed)
{
    for (const CLI::Option* o : command.get_options()) {
        const std::string help = spell_marks(o->get_description());
        for (const std::string& name : o->get_lnames())
            print_completion(typed, "--" + name, help);
        for (const std::string& name : o->get_snames())
            print_completion(typed, "-" + name, help);
    }
}

// Returns the option with a name, or null if there is none or if it takes no value.
const CLI::Option* find_option(const CLI::App& command, const std::string& name)
{
    const CLI::Option* o = name.starts_with('-') ? command.get_option_no_throw(name) : nullptr;
    return o != nullptr && o->get_type_size() != 0 ? o : nullptr;
}

void complete_command_line(const CLI::App& command, const std::vector<std::string>& words)
{
    const std::string& typed = words.back();
    const std::string head = typed.starts_with("--") ? typed.substr(0, typed.find('=') + 1) : "";
    if (const CLI::Option* o = words.size() > 1 ? find_option(command, words[words.size() - 2]) : nullptr)
        suggest_values(o->get_type_name(), typed, "");
    else if (!head.empty()) {
        if (const CLI::Option* named = find_option(command, head.substr(0, head.size() - 1)))
            suggest_values(named->get_type_name(), typed.substr(head.size()), head);
    } else if (typed.starts_with('-'))
        suggest_options(command, typed);
    else
        for (const CLI::Option* argument :
             command.get_options([](const CLI::Option* x) { return x->get_positional(); }))
            suggest_values(argument->get_single_name(), typed, "");
}

// Prints completions for a shell, which calls `tactor __complete WORD...`. `words` are the words after
// "tactor"; the last word may be incomplete. The line ":files" tells the shell to offer files and folders.
void print_completions(const CLI::App& app, const std::vector<std::string>& words)
{
    if (words.size() == 1) {
        for (const command& c : commands)
            print_completion(words[0], std::string(c.name), c.summary);
        if (words[0].starts_with('-'))
            suggest_options(app, words[0]);
    } else if (const command* c = words.empty() ? nullptr : find_command(words[0]))
        show_options(app, *c, [&](const CLI::App& options) {
            complete_command_line(options, {words.begin() + 1, words.end()});
        });
}

void print_all_help(const CLI::App& app)
{
    say_text(stdout, help_page(app, true));
    for (const command& c : commands)
        show_options(app, c, [](const CLI::App& a) { say_text(stdout, "\n" + help_page(a, true)); });
}

void print_option_help(const CLI::App& app, const std::string& name)
{
    option_help help(name);
    for (const command& c : commands)
        show_options(app, c, [&help](const CLI::App& shown) { help.add(shown); });
    say_text(stdout, help.text(app));
}

int run_command(const CLI::App& app, const command& c, const std::vector<std::string>& words)
{
    command_line line{*app.get_subcommand(std::string(c.name)), words};
    try {
        return c.run(line);
    } catch (const error& e) {
        throw options::locate_default_error(line.values, e);
    }
}

int run(const std::vector<std::string>& words)
{
    if (words.empty()) {
        say_error("tactor: {}\n\n{}", missing_command_error().what(), first_steps());
        return status_usage;
    }
    CLI::App app("Draws on skin: moving tactile strokes over sparse arrays of tactors.", "tactor");
    app.set_help_flag("-h,--help", "print the most important options and exit");
    app.set_help_all_flag("--help-all", "print all options and exit");
    app.set_version_flag("--version", version_text, "print version, build and libraries and exit");
    app.require_subcommand(1);
    app.footer("tactor plan park2016-1\ntactor help play\ntactor help soa");
    const std::string& first = words.front();
    const command* const named = find_command(words);
    for (const command& c : commands)
        if (named == nullptr || named == &c || first != named->name)
            app.add_subcommand(std::string(c.name), c.summary);
    if (first == "__complete")
        print_completions(app, {words.begin() + 1, words.end()});
    else if (first == "--help-all" && words.size() == 1)
        print_all_help(app);
    else if (first == "help" && words.size() == 2)
        print_option_help(app, words[1]);
    else if (named != nullptr)
        return run_command(app, *named, words);
    else
        parse_words(app, words);
    return status_ok;
}

// Exit status of a program that SIGPIPE has ended. If the reader needs only the first lines (| head), no
// message is printed.
constexpr int status_unread = 128 + SIGPIPE;

// Reports an error when output could not be written. Output that is cut because the disk is full must not
// look complete.
int report_output_error(int code)
{
    if (code == EPIPE)
        return status_unread;
    const bool full = code == ENOSPC || code == EDQUOT;
    say_error("tactor: standard output: {}{}\n", std::strerror(code),
              full            ? " (free some space, or write to another disk; the output is incomplete)"
              : code == EBADF ? " (send the output to a file or a pipe)"
                              : "");
    return status_failed;
}

// Returns true if an error means that the reader of standard output (-o -) has closed the pipe.
bool is_broken_pipe(const tactor::error& e)
{
    return e.os_code() == EPIPE && session::is_standard_output(std::string(e.subject()));
}

int finish_output(int status)
{
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)
        return status;
    return report_output_error(output_error() != 0 ? output_error() : errno);
}

// Opens /dev/null in place of each closed standard file. Otherwise the next file that is opened would get its
// number, and the output. Reading and writing still fail, as for a closed file.
void reserve_standard_files() noexcept
{
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(fd, F_GETFD) == -1 && errno == EBADF)
            ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

} // namespace
} // namespace tactor::cli

int main(int argc, char** argv)
{
    using namespace tactor::cli;
    // These signals would end the program when a file exceeds `ulimit -f` or when a pipe has no reader.
    // Ignoring them turns both cases into errors with a hint, and the program can clean up.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    reserve_standard_files();
    tactor::detail::guards_standard_output = true;
    try {
        int status = status_ok;
        try {
            status = run(arguments(argc, argv));
        } catch (const CLI::Success&) { // NOLINT(bugprone-empty-catch): help or a version is printed
        }
        return finish_output(status);
    } catch (const tactor::error& e) {
        if (is_broken_pipe(e))
            return status_unread;
        const tactor::error said = explain(reword_as_options(e), {argv + 1, argv + argc});
        // A name may be empty, or contain line ends with which it could imitate other messages.
        say_error("tactor: {}{}\n", said.subject().empty() ? R"("")" : "", make_printable(said.what()));
        return find_exit_status(e.kind());
    } catch (const std::system_error& e) {
        if (std::ferror(stdout) != 0) // set when fmt::print fails
            return report_output_error(output_error() != 0 ? output_error() : e.code().value());
        say_error("tactor: failed: {}\n", make_printable(e.what()));
    } catch (const std::bad_alloc&) {
        say_error("tactor: memory: not enough for this input (close other programs, or give a shorter "
                  "stroke or fewer channels)\n");
    } catch (const std::exception& e) {
        say_error("tactor: failed: {}\n", e.what());
    }
    return status_failed;
}
