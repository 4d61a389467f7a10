const unfold = () => document.querySelectorAll("details").forEach(part => part.open = true);
const unfoldTo = () => { const part = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (const one of [part?.querySelector("details"), part?.closest("details")]) if (one) one.open = true; part?.scrollIntoView(); };
addEventListener("beforeprint", unfold); addEventListener("hashchange", unfoldTo); if (location.hash) unfoldTo();
for (const table of document.querySelectorAll("table.sortable"))
  table.querySelectorAll("thead th").forEach((head, k) => {
    const button = document.createElement("button"), key = row => row.cells[k].dataset.value ?? row.cells[k].textContent;
    button.append(...head.childNodes); head.append(button); button.type = "button"; button.title = document.body.dataset.sort;
    button.onclick = () => {
      const down = head.getAttribute("aria-sort") === "ascending", body = table.tBodies[0];
      table.querySelectorAll("th").forEach(other => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const order = (a, b) => { const [x, y] = [key(a), key(b)], [p, q] = [parseFloat(x), parseFloat(y)];
        if (isNaN(p) !== isNaN(q)) return isNaN(p) ? 1 : -1;
        return (down ? -1 : 1) * (isNaN(p) ? x.localeCompare(y) : p - q); };
      body.append(...[...body.rows].sort(order));
    };
  });
