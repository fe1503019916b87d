// SPDX-License-Identifier: MIT
// Returns true if a host's name, as in a page's address, means each machine itself, such as localhost: other machines
// cannot use it.
export const is_own_host = name => /^((.+\.)?localhost\.?|127\..*|0\.0\.0\.0|\[::1?\]|\[::ffff:7f.*)$/.test(name);
