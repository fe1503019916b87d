// SPDX-License-Identifier: MIT
/// \file
/// Support for tests of live strokes.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include "engine/live.hpp"
#include "rig.hpp"

namespace tactor::test {

inline const double live_level = std::pow(10.0, -12.0 / 20.0);

/// A rig with one live stroke.
class live_rig : public rig {
public:
    explicit live_rig(const live_options& o = {}, const rig_options& r = {}) : rig(r) { live = add(o); }

    std::shared_ptr<live_stroke::impl> add(const live_options& o = {})
    {
        const array a = palm();
        auto s = std::make_shared<live_stroke::impl>(next_id(), a, layout(a), out->setup(), o);
        feed.submit(last(), std::shared_ptr<engine::live_voice>(s, &s->voice));
        feed.pump(status().written, link.clock.load());
        return s;
    }

    /// Returns the rig's stroke and new ones, n in all.
    std::vector<std::shared_ptr<live_stroke::impl>> fill(std::size_t n, const live_options& o = {})
    {
        std::vector<std::shared_ptr<live_stroke::impl>> all{live};
        while (all.size() < n)
            all.push_back(add(o));
        return all;
    }

    /// Ends the rig's stroke, or another, and plays it out.
    stroke_report finish(engine::live_voice::action w = engine::live_voice::action::end)
    {
        return finish(*live, w);
    }
    stroke_report finish(live_stroke::impl& s, engine::live_voice::action w = engine::live_voice::action::end)
    {
        s.voice.request(w);
        play_out();
        return end(s.id);
    }

    std::shared_ptr<live_stroke::impl> live;
};

inline live_options bursts()
{
    live_options o;
    o.plan.algorithm = algorithm_kind::park2016;
    return o;
}

} // namespace tactor::test
