// SPDX-License-Identifier: MIT
// Packets of OSC: what is read can be written and read again, and asks for something or is refused in words.
#include <cmath>
#include <string>
#include <variant>

#include "holds.hpp"
#include "net/osc.hpp"
#include "server/faults.hpp"
#include "server/osc.hpp"

using namespace tactor;

namespace {

bool same(const net::osc_value& a, const net::osc_value& b)
{
    if (const auto* s = std::get_if<std::string>(&a))
        return *s == std::get<std::string>(b);
    if (const auto* x = std::get_if<double>(&a)) {
        const double y = std::get<double>(b);
        return static_cast<float>(*x) == static_cast<float>(y) || std::isnan(*x);
    }
    return std::holds_alternative<std::int64_t>(b);
}

void check_message(const net::osc_message& m)
{
    HOLDS(m.address.starts_with('/'));
    std::vector<net::osc_value> known;
    for (const net::osc_value& v : m.values)
        if (!std::holds_alternative<net::osc_other>(v))
            known.push_back(v);
    const auto again = net::parse_osc(net::osc_packet(m.address, known));
    HOLDS(again.size() == 1);
    HOLDS(again.front().address == m.address);
    HOLDS(again.front().values.size() == known.size());
    for (std::size_t i = 0; i < known.size(); ++i)
        HOLDS(same(known[i], again.front().values[i]));
}

void check_request(const net::osc_message& m)
{
    try {
        const server::osc_request r = server::read_osc(m);
        HOLDS(!server::is_server_message(m.address));
        HOLDS(r.method.empty() || m.address == "/tactor/" + r.method);
        HOLDS(r.params.is_object());
        HOLDS(!net::json_line(net::reply_json(r.params)).empty());
    } catch (const server::fault_error& e) {
        HOLDS(!e.fault().what.empty() && !e.fault().why.empty());
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const auto all = fuzz::accepted([&] { return net::parse_osc(fuzz::as_text(data, size)); });
    HOLDS(all.size() <= 256);
    for (const net::osc_message& m : all) {
        check_message(m);
        check_request(m);
    }
    return 0;
}
