// SPDX-License-Identifier: MIT
// Returns true if a text answers an entry: any text, a whole number, or where it has a longest length an estimate with a point.
export function fits_entry(text, {lowest, greatest, longest, most}) {
  if (most) return true;
  const shape = longest ? /^(\d+\.?\d*|\.\d+)$/ : /^\d+$/;
  return shape.test(text) && text.length <= (longest ?? text.length) && Number(text) >= lowest && Number(text) <= greatest;
}
