"use strict";
// The report's page: charts, the body, playback, switches.
(async () => {
  const { element } = Charts;
  const root = document.getElementById("explorer");
  const data = JSON.parse(document.getElementById("data").textContent);
  const bytes = await Charts.unpack(document.getElementById("numbers").textContent);
  const group = new Charts.Group(data.end);
  const motion = (m) => ({ t: Charts.times(bytes, m.t), q: m.q.map((d) => Charts.values(bytes, d)),
                           p: m.p.map((d) => Charts.values(bytes, d)) });
  group.marks = data.marks.map((m) => ({ ...m, times: Charts.times(bytes, m.times), on: m.name !== "frames" }));
  group.bands = data.bands.map((b) => ({ ...b, from: Charts.times(bytes, b.from), to: Charts.times(bytes, b.to), on: true }));

  // ---- the bar: playback, zoom, marks and bands
  const button = (text, title) => element("button", { type: "button", title }, text);
  const play = button("▶", "play or pause (space)");
  play.id = "play";
  play.setAttribute("aria-label", "play");
  const scrub = element("input", { type: "range", id: "scrub", min: 0, max: data.end, step: "any", value: 0, "aria-label": "time" });
  const speed = element("select", { id: "speed", "aria-label": "speed" },
    ...[0.1, 0.25, 0.5, 1, 2, 4, 10].map((s) => element("option", { value: s }, s + " ×")));
  speed.value = "1";
  const clock = element("span", { class: "clock", id: "clock" });
  const all = button("Whole recording", "show all (double click)"), into = button("Zoom to 5 s", "five seconds about the cursor");
  all.id = "all";
  into.id = "into";
  const theme = button("◐", "dark or light");
  theme.id = "theme";
  const switches = element("div", { class: "marks" });
  const bar = element("div", { class: "bar" }, play, scrub, clock, speed, into, all, theme);
  const stage = element("div", { class: "body3d", id: "body" });
  root.replaceChildren(stage, bar, switches);
  for (const item of [...group.marks, ...group.bands]) {
    const input = element("input", { type: "checkbox" });
    input.checked = item.on;
    const label = element("label", { class: "switch" + (item.on ? "" : " off") }, input,
      element("i", { style: "background:" + item.color }), item.name);
    input.onchange = () => {
      item.on = input.checked;
      label.classList.toggle("off", !item.on);
      group.redraw();
    };
    switches.append(label);
  }

  // ---- charts
  for (const chart of data.charts) {
    chart.series = chart.series.map((s) => ({ ...s, step: s.y.step, x: Charts.times(bytes, s.x), y: Charts.values(bytes, s.y) }));
    group.add(root, chart);
  }

  // ---- the body
  let view = null;
  try {
    view = new Body.View(stage, motion(data.before), motion(data.after));
    stage.append(element("p", {}, "Solid: after. Transparent and grey: before. Drag to turn, wheel to come nearer."));
    group.listeners.push((t) => view.show(t));
  } catch (error) {
    stage.append(element("p", {}, "The body in 3D needs WebGL, which this browser does not offer: " + error.message));
  }
  group.listeners.push((t) => {
    scrub.value = t;
    clock.textContent = t.toFixed(3) + " s";
  });

  // ---- playback
  let playing = false, last = 0;
  const step = (now) => {
    if (!playing) return;
    const t = group.cursor + (now - last) * 1e-3 * Number(speed.value);
    last = now;
    const [from, to] = group.window;
    if (t > to && to < group.end)  // the window goes with the cursor
      group.setWindow(Math.min(t, group.end - (to - from)), Math.min(t + (to - from), group.end));
    group.setCursor(t);
    if (t >= group.end) setPlaying(false);
    requestAnimationFrame(step);
  };
  const setPlaying = (on) => {
    playing = on;
    play.textContent = on ? "⏸" : "▶";
    play.setAttribute("aria-pressed", on);
    if (!on) return;
    if (group.cursor >= group.end) group.setCursor(0);
    last = performance.now();
    requestAnimationFrame(step);
  };
  play.onclick = () => setPlaying(!playing);
  scrub.oninput = () => group.setCursor(Number(scrub.value));
  document.addEventListener("keydown", (event) => {
    if (event.code !== "Space" || ["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
    event.preventDefault();
    setPlaying(!playing);
  });
  all.onclick = () => group.setWindow(0, group.end);
  into.onclick = () => {
    const half = Math.min(2.5, group.end / 2);
    const middle = Math.min(Math.max(group.cursor, half), group.end - half);
    group.setWindow(middle - half, middle + half);
  };
  theme.onclick = () => {
    const dark = getComputedStyle(document.documentElement).colorScheme.includes("dark") &&
      (document.documentElement.dataset.theme === "dark" || matchMedia("(prefers-color-scheme: dark)").matches);
    const now = document.documentElement.dataset.theme || (dark ? "dark" : "light");
    document.documentElement.dataset.theme = now === "dark" ? "light" : "dark";
    group.redraw();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => group.redraw());
  group.setCursor(0);
  window.report = { group, view, data };
  document.documentElement.dataset.ready = Math.round(performance.now());  // ms since the page began to open
})().catch((error) => {
  document.getElementById("explorer").textContent = "The report cannot be shown: " + error.message;
  throw error;
});
