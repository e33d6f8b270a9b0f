// The state of a flight: saved on this machine, restored, and shared as a link.

const STORED = "tetherfmu";

/** Bytes of numbers as text for a link, and back. */
export function packed(numbers) {
  const bytes = new Uint8Array(Float64Array.from(numbers).buffer);
  let text = "";
  for (const each of bytes) text += String.fromCharCode(each);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

export function unpacked(text) {
  const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (each) => each.charCodeAt(0));
  return Array.from(new Float64Array(bytes.buffer));
}

/** A saved flight as pairs of a link. */
export function pairsOf(saved) {
  const pairs = [
    ["t", String(saved.count)],
    ["driver", JSON.stringify(saved.driver)],
  ];
  for (const [name, [state, outputs]] of Object.entries(saved.tethers)) {
    pairs.push([`s.${name}`, packed(state)], [`o.${name}`, packed(outputs)]);
  }
  return pairs;
}

/** The saved flight in the pairs of a link; null if there is none, or a damaged one. */
export function savedIn(pairs) {
  const given = new Map(pairs);
  if (!given.has("t")) return null;
  try {
    const tethers = {};
    for (const [key, text] of given) {
      if (key.startsWith("s.")) tethers[key.slice(2)] = [unpacked(text), unpacked(given.get(`o.${key.slice(2)}`))];
    }
    return { count: Number(given.get("t")), driver: JSON.parse(given.get("driver")), tethers };
  } catch {
    return null;
  }
}

/** Pairs in the hash of an address. */
export const pairsIn = (hash) => [...new URLSearchParams(hash.replace(/^#/, ""))];

/** Address of this page with these pairs. */
export function addressWith(pairs) {
  return `${location.href.replace(/#.*/, "")}#${new URLSearchParams(pairs)}`;
}

/** Keep pairs on this machine, where the browser allows it. */
export function keep(pairs) {
  try {
    localStorage.setItem(STORED, JSON.stringify(pairs));
  } catch {
    // a browser that keeps nothing: the flight is still kept in the page
  }
}

/** What was kept; null if there is nothing. */
export function kept() {
  try {
    return JSON.parse(localStorage.getItem(STORED));
  } catch {
    return null;
  }
}
