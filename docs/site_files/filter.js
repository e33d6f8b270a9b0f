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
