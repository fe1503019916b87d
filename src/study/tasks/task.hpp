// SPDX-License-Identifier: MIT
/// \file
/// Tasks of a study. Each is one file in this folder with one object, which says all that is special about
/// its runs; list_tasks() has them. Objects without state, for any thread.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "study/data/dataset.hpp"

namespace tactor::study {

class task {
public:
    /// A task as definitions and descriptions have it.
    struct facts {
        std::string_view name;
        std::string_view trial;    ///< kind of a trial
        std::string_view response; ///< meaning of its response; {} is the range of ratings
        /// Usual questions about similarity, uniformity, another attribute; empty: none.
        std::array<std::string_view, 3> questions = {};
        bool measures = false; ///< a psychometric function, d' or an exponent is estimated from its trials
        bool varies = false;   ///< a value changes from trial to trial; detect may do without
    };

    virtual ~task() = default;
    task(const task&) = delete;
    task& operator=(const task&) = delete;

    std::string_view name() const noexcept { return facts_.name; }
    const facts& about() const noexcept { return facts_; }

protected:
    explicit task(const facts& f) noexcept : facts_(f) {}

private:
    facts facts_;
};

/// Returns all tasks, in the order of task_kind.
std::span<const task* const> list_tasks() noexcept;

const task& find_task(task_kind t) noexcept;

} // namespace tactor::study
