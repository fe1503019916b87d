// SPDX-License-Identifier: MIT
#include "net/web_page.hpp"

#include <random>

#include <fmt/format.h>
#include <sys/socket.h>

namespace tactor::net {
namespace {

constexpr std::string_view place_of_nonce = "NONCE";

// What a page that was slipped in between could not guess.
std::string make_nonce()
{
    std::random_device chance;
    return fmt::format("{:08x}{:08x}{:08x}{:08x}", chance(), chance(), chance(), chance());
}

// A whole reply.
std::string unavailable(std::string_view why)
{
    const std::string text = fmt::format("{}, try again later\n", why);
    return fmt::format("HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\n"
                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
                       text.size(), text);
}

} // namespace

web_reply make_page(std::string_view document, std::string_view host)
{
    const std::string nonce = make_nonce();
    std::string text(document);
    for (std::size_t at = text.find(place_of_nonce); at != std::string::npos;
         at = text.find(place_of_nonce, at))
        text.replace(at, place_of_nonce.size(), nonce);
    return {200, "text/html; charset=utf-8", std::move(text),
            fmt::format("default-src 'none'; script-src 'nonce-{0}'; style-src 'nonce-{0}'; img-src data:; "
                        "connect-src 'self' ws://{1}; frame-ancestors 'none'; base-uri 'none'; "
                        "form-action 'none'",
                        nonce, host)};
}

void turn_away(int socket)
{
    const std::string why = unavailable("there is no place");
    static_cast<void>(::send(socket, why.data(), why.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

std::string no_descriptors_for_browsers()
{
    return unavailable("the server has as many files open as it may");
}

} // namespace tactor::net
