// SPDX-License-Identifier: MIT
// import and export: planners make them.
#include <utility>

#include "server/files/export_strokes.hpp"
#include "server/files/import_strokes.hpp"
#include "server/service_impl.hpp"

namespace tactor::server {

using net::json;

void service::import_file(client& c, json&& params, const answer& to, std::size_t bytes)
{
    check_import(params);
    plan_job job{.to = to, .bytes = bytes};
    job.make_text = [this](const json& p, const go_on_check&) {
        return import_strokes(options_.plans, faces_, p, most_file_bytes);
    };
    job.params = std::move(params);
    admit_job(c, std::move(job));
}

void service::export_file(client& c, json&& params, const answer& to, std::size_t bytes)
{
    check_export(options_.plans, params);
    plan_job job{.to = to, .bytes = bytes};
    job.make_text = [this](const json& p, const go_on_check& go_on) {
        return export_strokes({options_.plans, faces_, options_.named, options_.plan_text, most_file_bytes},
                              p, go_on);
    };
    job.params = std::move(params);
    admit_job(c, std::move(job));
}

} // namespace tactor::server
