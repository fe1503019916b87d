// SPDX-License-Identifier: MIT
const dark_wanted = matchMedia("(prefers-color-scheme: dark)");

// Follows the system's light or dark, now and later.
export function follow_theme() {
  document.documentElement.dataset.theme = dark_wanted.matches ? "dark" : "light";
  dark_wanted.onchange = follow_theme;
}
