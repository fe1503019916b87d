// SPDX-License-Identifier: MIT
// The tool's own writer and reader of plans.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "cli/input.hpp"
#include "cli/plan/plan_file.hpp"
#include "cli/plan/plan_output.hpp"
#include "core/words.hpp"
#include "python/plan_handle.hpp"
#include "python/written.hpp"

namespace tactor::python {
namespace {

constexpr const char* plan_itself = "plan";

} // namespace

std::string written(const std::function<void(std::FILE*)>& write)
{
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* const out = ::open_memstream(&text, &size);
    if (out == nullptr)
        throw std::bad_alloc();
    const auto take = [&] {
        const bool whole = std::fclose(out) == 0;
        std::string all(text, whole ? size : 0);
        std::free(text);
        return std::pair(whole, std::move(all));
    };
    try {
        write(out);
    } catch (...) {
        take();
        throw;
    }
    auto [whole, all] = take();
    if (!whole)
        throw std::bad_alloc();
    return std::move(all);
}

render_options settled(const array& a, render_options o)
{
    const unsigned marker = o.marker_channel ? *o.marker_channel + 1 : 0;
    if (o.channels == 0)
        o.channels = std::max(a.channels(), marker);
    return o;
}

std::string json_of(const plan_handle& p)
{
    const without_lock free;
    cli::environment e;
    e.tactors = p.on->value();
    cli::piece piece{p.drawn.name, {p.drawn}, {p.placed}, p.fit};
    if (p.moved)
        piece.moved.push_back(*p.moved);
    const render_options sound = settled(e.tactors, p.sound);
    const score samples(e.tactors, piece.plans, sound);
    return written([&](std::FILE* out) { cli::print_json(out, piece, e, samples, sound); });
}

plan_handle plan_from_json(const std::string& text, const std::string& named)
{
    const without_lock free;
    cli::plan_file f = cli::read_plans(text, named);
    if (f.plans.size() != 1)
        throw error(error_kind::bad_input, named, "there are " + counted(f.plans.size(), "plan") + " in it",
                    "take one of its \"plans\"");
    plan_handle p{std::make_shared<array_handle>(std::move(f.tactors)), std::move(f.strokes.front()),
                  std::move(f.plans.front()), f.fit};
    if (!f.moved.empty())
        p.moved = std::move(f.moved.front());
    p.sound = f.render;
    return p;
}

void check_same_array(const plan_handle& p, const array& in_use)
{
    cli::check_same_array(plan_itself, p.on->value(), in_use);
}

} // namespace tactor::python
