// Scores of the search. A row whose name was typed, in full or its last part, comes first.
var Scorer = {
  objNameMatch: 11, objPartialMatch: 6, objPrio: {0: 15, 1: 5, 2: -5}, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
  score: ([, title, , description, score, , kind]) => {
    if (kind !== "object" || description.startsWith("Python ")) return score;
    const typed = new URLSearchParams(location.search).get("q").trim().toLowerCase().replace(/\[.*/, "");
    const name = title.toLowerCase().replace(/\[.*/, "");
    return name === typed ? 300 : name.endsWith(`.${typed}`) || name.endsWith(` ${typed}`) ? 200 : score;
  },
};
