// SPDX-License-Identifier: MIT
// Time within which the key that answered a question cannot begin the next text. The key may be held, or pressed twice.
const SAME_KEY_MS = 1000;

// Returns a function that takes each key with its time, ms, and returns true if the same key came shortly before.
export function make_key_guard() {
  let last = "", last_ms = 0;
  return (key, now_ms) => {
    const again = key === last && now_ms - last_ms < SAME_KEY_MS;
    [last, last_ms] = [key, now_ms];
    return again;
  };
}
