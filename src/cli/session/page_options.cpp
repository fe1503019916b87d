// SPDX-License-Identifier: MIT
#include "cli/session/page_options.hpp"

#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/say.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {

void add_page_options(CLI::App& command, page_options& o)
{
    add_text_option(command, "--display", "page|terminal",
                    "show the participant a page in a browser, or the terminal (default)",
                    [&o](const std::string& t) {
                        o.on_page = choose("--display", t, {"page", "terminal"}) == 0;
                    });
    add_text_option(command, "--page", "[HOST:]PORT",
                    "show the page at this address of this machine (default 127.0.0.1:0, a free port)",
                    [&o](const std::string& t) { o.at = net::parse_host(t, "--page"); });
}

void add_keypad_option(CLI::App& command, std::vector<std::string>& into)
{
    command
        .add_option("--keypad", into,
                    "also accept answers from this input device, and hide them from other programs")
        ->type_name("DEVICE")
        ->expected(1)
        ->take_all();
}

CLI::Option* add_masker_option(CLI::App& command, std::string& into, const std::string& help)
{
    return add_text_option(command, "--masker", "PCM", help, [&into](const std::string& t) {
        if (t.empty())
            refuse_option("--masker", "no device is named", "name one, such as hw:CARD=Phones");
        into = t;
    });
}

void check_page_options(const page_options& o, bool simulated)
{
    if (o.at && !o.on_page.value_or(true))
        refuse_option("--page", "the participant uses the terminal, not a page",
                      "leave out --display or --page");
    if (simulated && o.is_shown())
        refuse_option(o.at ? "--page" : "--display", "a simulated session has no page",
                      fmt::format("leave out {} or --simulate", o.at ? "--page" : "--display"));
}

net::owned_fd open_page(const page_options& o)
{
    if (!o.is_shown())
        return {};
    const net::host_and_port at = o.at.value_or(net::host_and_port{});
    net::owned_fd fd = net::listen_tcp(at, "--page");
    if (!net::is_loopback(fd.get()))
        refuse_option(
            "--page",
            fmt::format("other machines can reach {}: anybody on the network could answer", at.host),
            "use [127.0.0.1:]PORT, and run ssh -L PORT:127.0.0.1:PORT on the participant's machine");
    say(stderr, "tactor: the participant's page is at http://{}/\n", net::local_address(fd.get()));
    return fd;
}

} // namespace tactor::cli
