// SPDX-License-Identifier: MIT
// Options of the take, and the rows of the table that describe them.
import {state, current_take} from "../state.js";
import {with_side} from "../takes/takes.js";

export const row = name => state.options.find(o => o.name === name);
export const value = name => with_side(current_take())?.options[name] ?? row(name)?.default ?? null;
export const algorithm = () => value("algorithm") ?? "park2016";
