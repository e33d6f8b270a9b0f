// Scores of the search. A row whose name was typed comes first, of a single tether before others; then rows whose last part it is.
var Scorer = {
  objNameMatch: 11, objPartialMatch: 6, objPrio: {0: 15, 1: 5, 2: -5}, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
  score: ([page, title, , description, score, , kind]) => {
    if (kind !== "object" || description.startsWith("Python ")) return score;
    const typed = new URLSearchParams(location.search).get("q").trim().toLowerCase().replace(/\[.*/, "");
    const words = typed.replace(/\s+/g, "_");  // "drag coefficient" is drag_coefficient
    const name = title.toLowerCase().replace(/\[.*/, "");
    if (name === typed || name === words) return page === "reference/variables" ? 310 : 300;
    return (typed.includes("_") && name.endsWith(`.${typed}`)) || name.endsWith(` ${typed}`) ? 200 : score;
  },
};
