// SPDX-License-Identifier: MIT
// Returns true where a host's name, as a page's address has it, is each machine's own: another machine opens itself by it.
export const is_own_host = name => /^((.+\.)?localhost\.?|127\..*|0\.0\.0\.0|\[::1?\]|\[::ffff:7f.*)$/.test(name);
