// SPDX-License-Identifier: MIT
/// \file
/// From settings to plain values: configuration, array, strokes, plans.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/settings.hpp"

namespace tactor::cli {

/// The configuration that applies, and the array file's own [output], [amplifier] and [sync] over it.
struct environment {
    setup config;
    std::string config_name; ///< file it came from; empty: none
    array tactors;
    std::string array_file; ///< that the array came from; empty: it is a preset of its name
};

/// Reads the configuration (--config, $TACTOR_CONFIG, the user's, the system's: the first that exists),
/// feeds its [defaults] to the options and finds the array. \throws error.
environment read_environment(settings& s, option_list& options);

/// One piece: what one STROKE argument makes.
struct piece {
    std::string name;
    std::vector<stroke> strokes;
    std::vector<placed_plan> plans;
    std::optional<fitting> fit = {}; ///< what --fit did
};

/// Reads and plans all STROKE arguments. \throws error.
std::vector<piece> plan_pieces(const settings& s, const environment& e);

/// Reads the only STROKE argument without planning it; `faces` is what --fit puts it on. \throws error.
piece read_one_piece(const settings& s, const layout& faces);

/// Reads and plans where only one STROKE is taken.
piece plan_one_piece(const settings& s, const environment& e);

/// The score of a piece with `render.rate` and channels settled; the plans go with it, so that there is one
/// of each. \throws error.
score take_score(piece& p, const environment& e, const render_options& render);

/// The same of a piece that keeps its plans.
score make_score(const piece& p, const environment& e, const render_options& render);

/// Rate and channel count from the options, the configuration, then the defaults.
render_options settle_render(const settings& s, const environment& e);

/// What play limits the array to: [limits], and the defaults for what that does not say.
drive_limits settle_limits(const environment& e);

} // namespace tactor::cli
