// SPDX-License-Identifier: MIT
#include "cli/serve/plan_record.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <system_error>

#include "cli/plan/plan_output.hpp"

namespace tactor::cli {
namespace {

struct text_sink {
    std::string text = {};
    std::size_t most = 0;
};

ssize_t append(void* to, const char* bytes, std::size_t n)
{
    auto& sink = *static_cast<text_sink*>(to);
    if (sink.text.size() + n > sink.most) {
        errno = EFBIG;
        return 0;
    }
    try {
        sink.text.append(bytes, n);
    } catch (const std::bad_alloc&) {
        errno = ENOMEM;
        return 0;
    }
    return static_cast<ssize_t>(n);
}

} // namespace

std::string plan_record(const server::planned& p, const environment& e, std::size_t most_bytes)
{
    text_sink into;
    into.most = most_bytes;
    cookie_io_functions_t calls{};
    calls.write = append;
    std::FILE* out = ::fopencookie(&into, "w", calls);
    if (out == nullptr)
        throw std::bad_alloc();
    bool whole = true;
    try {
        const piece one{p.name, p.strokes, p.plans, {}, p.moved};
        print_json(out, one, e, make_score(one, e, p.render), p.render);
    } catch (const std::system_error&) { // of a write that was refused
        whole = false;
    } catch (...) {
        std::fclose(out);
        throw;
    }
    whole = std::fclose(out) == 0 && whole;
    if (!whole)
        throw std::bad_alloc();
    return std::move(into.text);
}

} // namespace tactor::cli
