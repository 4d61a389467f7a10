// Each figure that has numbers beside its picture is drawn from them instead, so that a stretch can be looked at closely.
for (const figure of document.querySelectorAll("figure[data-trace]")) {
  const given = JSON.parse(figure.querySelector("script").textContent), place = figure.querySelector(".live");
  const numbers = text => new Float32Array(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);
  const say = text => given.words[text] ?? text; // in the language of the page
  const dark = matchMedia("(prefers-color-scheme: dark)");
  let plots = [], shown = 0;

  // Columns: time; angle; fit, fit held out; residual, residual held out. Null where a series has no say, so that lines end there.
  function columns(one) {
    const [time, angle, fit] = [one.time, one.angle, one.fit].map(numbers), held = [], rows = [[], [], [], [], [], []];
    for (const [count, out] of one.parts) for (let k = 0; k < count; k++) held.push(out);
    for (let k = 0; k < time.length; k++) {
      const left = angle[k] - fit[k];
      rows[0].push(time[k]); rows[1].push(angle[k]);
      rows[2].push(held[k] ? null : fit[k]); rows[3].push(held[k] ? fit[k] : null);
      rows[4].push(held[k] ? null : left); rows[5].push(held[k] ? left : null);
    }
    return rows;
  }

  function draw() {
    plots.forEach(plot => plot.destroy());
    const style = getComputedStyle(document.body), colour = name => style.getPropertyValue(name).trim();
    const [ink, line, soft] = [colour("--ink"), colour("--line"), colour("--soft")];
    const [fitted, heldOut] = dark.matches ? ["#5cb0e6", "#3ccf9f"] : ["#0072B2", "#009E73"];
    const rows = columns(given.recordings[shown]), anyHeld = rows[3].some(value => value !== null);
    const written = text => text.replace("-", "−").replace(".", given.decimal);
    // as many digits as the step between two marks has
    const marks = (plot, places, axis, room, step) => places.map(place => written(place.toFixed((String(step).split(".")[1] ?? "").length)));
    const axis = label => ({ values: marks, stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, label: say(label), labelSize: 18, size: 52, labelFont: "13px sans-serif" });
    const number = digits => (plot, value) => value == null ? "–" : written(value.toFixed(digits));
    const time = { label: say("time (s)"), value: number(3) };
    const series = (label, stroke, more) => ({ label: say(label), stroke, width: 1, points: { show: false }, value: number(3), ...more });
    let busy = false;
    const together = plot => {
      if (busy || plots.length < 2) return;
      busy = true;
      const { min, max } = plot.scales.x;
      plots.forEach(other => { if (other !== plot) other.setScale("x", { min, max }); });
      busy = false;
    };
    const options = (height, list, label, more) => ({
      width: place.clientWidth, height, series: [time, ...list], scales: { x: { time: false }, ...more },
      axes: [{ ...axis(""), size: 30, labelSize: 0 }, axis(label)], cursor: { sync: { key: figure.id }, drag: { x: true, y: false } },
      hooks: { setScale: [(plot, key) => key === "x" && together(plot)] },
    });
    const held = label => anyHeld ? [series(label, heldOut)] : [];
    const some = (...which) => which.filter(k => anyHeld || (k !== 3 && k !== 5)).map(k => rows[k]);
    const spots = { paths: () => null, points: { show: true, size: 3, width: 0, fill: soft } };
    const upper = options(260, [series("measured", soft, spots), series("fit", fitted), ...held("model, held out")], given.what);
    const lower = options(200, [series("data − fit", fitted), ...held("data − model, held out")], given.left);
    lower.axes[0] = axis("time (s) since the first sample"); lower.axes[0].size = 34;
    if (given.noise) lower.hooks.drawClear = [plot => {
      const [top, bottom] = [2, -2].map(times => plot.valToPos(times * given.noise, "y", true));
      const { left, width, top: edge, height } = plot.bbox, from = Math.max(top, edge), to = Math.min(bottom, edge + height);
      plot.ctx.fillStyle = line; plot.ctx.globalAlpha = .6;
      if (to > from) plot.ctx.fillRect(left, from, width, to - from);
      plot.ctx.globalAlpha = 1;
    }];
    plots = [];
    plots = [new uPlot(upper, some(0, 1, 2, 3), box(0)), new uPlot(lower, some(0, 4, 5), box(1))];
  }

  const boxes = [0, 1].map(() => place.appendChild(document.createElement("div"))), box = k => boxes[k];
  const bar = place.insertBefore(document.createElement("div"), boxes[0]);
  bar.className = "bar";
  if (given.recordings.length > 1) {
    const choice = bar.appendChild(document.createElement("select"));
    choice.setAttribute("aria-label", say("recording"));
    given.recordings.forEach(one => choice.add(new Option(one.name)));
    choice.onchange = () => { shown = choice.selectedIndex; draw(); };
  }
  // Around the middle of what is seen: factor of its length, and shift in shares of it.
  const move = (factor, shift) => {
    const times = plots[0].data[0], [first, last] = [times[0], times[times.length - 1]], { min, max } = plots[0].scales.x;
    const length = Math.min((max - min) * factor, last - first), middle = (min + max) / 2 + shift * (max - min);
    const from = Math.min(Math.max(middle - length / 2, first), last - length);
    plots[0].setScale("x", { min: from, max: from + length });
  };
  for (const [text, title, act] of [
    ["+", "closer", () => move(.5, 0)], ["−", "farther", () => move(2, 0)], ["←", "earlier", () => move(1, -.5)],
    ["→", "later", () => move(1, .5)], ["all", "all of it", () => move(1e9, 0)],
  ]) {
    const button = bar.appendChild(document.createElement("button"));
    Object.assign(button, { type: "button", textContent: say(text), title: say(title), onclick: act });
    button.setAttribute("aria-label", say(title));
  }
  const thin = given.recordings.some(one => one.kept < one.samples);
  bar.appendChild(document.createElement("span")).textContent = [
    "drag over a stretch to see it closely, click twice for all of it", given.noise && "grey: ± 2 standard deviations of the noise",
    thin && "the samples that the fit misses most",
  ].filter(Boolean).map(say).join("; ");

  figure.classList.add("zoomable");
  draw();
  dark.addEventListener("change", draw);
  new ResizeObserver(() => plots.forEach(plot => plot.setSize({ width: place.clientWidth, height: plot.height }))).observe(place);
}
