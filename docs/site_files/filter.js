// Show the rows of the tables of variables that have all words of the filter, and the tables that have such rows.
const field = document.querySelector("p.filter input");
const tables = [...document.querySelectorAll("table.variables")];
field.addEventListener("input", () => {
  const words = field.value.toLowerCase().split(/\s+/);
  for (const table of tables) {
    const rows = [...table.querySelectorAll("tbody tr")];
    for (const row of rows) row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word));
    table.hidden = rows.every(row => row.hidden);
  }
});
// On a phone, where a row is a card, its numbers say what they are.
for (const table of tables) {
  table.classList.add("labelled");
  const heads = [...table.querySelectorAll("th")].map(head => head.textContent);
  for (const row of table.querySelectorAll("tbody tr"))
    [...row.cells].forEach((cell, k) => cell.dataset.label = heads[k]);
}
