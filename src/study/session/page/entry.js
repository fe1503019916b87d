// SPDX-License-Identifier: MIT
// Returns true if a text fits an entry: any text with `most`, an estimate in range with `longest`, else a whole number in range.
export function fits_entry(text, {lowest, greatest, longest, most}) {
  if (most) return true;
  const shape = longest ? /^(\d+\.?\d*|\.\d+)$/ : /^\d+$/;
  return shape.test(text) && text.length <= (longest ?? text.length) && Number(text) >= lowest && Number(text) <= greatest;
}
