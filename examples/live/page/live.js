"use strict";
// The live page: the body, charts of the last half minute, rates and faults.
(() => {
  const { element } = Charts, seconds = 30, deg = 180 / Math.PI;
  const root = document.getElementById("live");
  const stage = element("div", { class: "body3d", id: "body" });
  const cards = element("section", { class: "cards" });
  const charts = element("div");
  root.append(stage, cards);

  // ---- cards: the newest figures
  const card = (id, name) => {
    const value = element("div", { class: "value", id }), note = element("div", { class: "note" });
    cards.append(element("div", { class: "card" }, element("div", { class: "name" }, name), value, note));
    return (text, small = "") => { value.textContent = text; note.textContent = small; };
  };
  const show = { state: card("state", "State"), rate: card("rate", "Poses a second"),
                 samples: card("samples", "Samples a second"), bytes: card("bytes", "Bytes a second"),
                 delay: card("delay", "Age of the pose"), faults: card("faults", "Faults") };
  const bits = ["orientation", "position", "stale", "no data", "gap", "rest", "settling",
                "field disturbed", "clipped", "source lost", "out of step", "finished"];

  // ---- calibration: what is to be done, how far it is, and what was found
  const steps = element("div", { id: "calibration" }), found = element("pre", { id: "found" });
  const calibration = element("section", { class: "chart", id: "calibration-section" },
    element("header", {}, element("h2", {}, "Calibration")), steps, found);
  root.append(calibration, charts);
  const step = (id, name) => {
    const bar = element("progress", { id: "calibration-" + id, max: 100, value: 0 }), note = element("span");
    const line = element("p", {}, name + " ", bar, " ", note);
    steps.append(line);
    return (shown, percent, text) => { line.hidden = !shown; bar.value = percent; note.textContent = percent + " %, " + text; };
  };
  const progress = { gyro: step("gyro", "Gyroscope"), accel: step("accel", "Accelerometer"), mag: step("mag", "Magnetometer") };
  const faces = ["+x", "\u2212x", "+y", "\u2212y", "+z", "\u2212z"];
  function calibrate(v) {
    const sees = (k) => (v.sensors >> k & 1) === 1, done = (k) => (v.done >> k & 1) === 1;
    calibration.hidden = v.sensors === 0;  // a board on a serial line sends no readings
    const missing = faces.filter((_, k) => !(v.accel_faces >> k & 1));
    progress.gyro(sees(0), v.gyro_percent, done(0) ? "done" : "let it lie still");
    progress.accel(sees(1), Math.round(100 * (6 - missing.length) / 6), done(1) ? "done" : missing.length === 0
      ? "faces do not agree: begin anew, and lay it straighter" : "lay it on its faces; up are still to come " + missing.join(" "));
    progress.mag(sees(2), v.mag_percent, done(2) ? "done" : "turn it slowly through all directions");
    const list = (values) => "[" + values.map((x) => +x.toPrecision(6)).join(", ") + "]";
    const lines = [];
    if (done(0)) lines.push("gyro_offset_rad_s = " + list(v.gyro_offset));
    if (done(1)) lines.push("accel_offset_m_s2 = " + list(v.accel.slice(0, 3)), "accel_matrix = " + list(v.accel.slice(3)));
    if (done(2)) lines.push("mag_offset_uT = " + list(v.mag.slice(0, 3)), "mag_matrix = " + list(v.mag.slice(3)));
    const text = lines.length ? "# for the unit's calibration file\n" + lines.join("\n") : "";
    if (found.textContent !== text) found.textContent = text;  // a selection of the text is kept
    found.hidden = text === "";
  }

  // ---- charts that run
  const rows = { rotation: [], rate: [], position: [], age: [] }, graphs = {};
  const chart = (id, title, unit, names) => {
    const plot = element("div", { class: "plot" });
    charts.append(element("section", { class: "chart", id: "chart-" + id },
      element("header", {}, element("h2", {}, title)), plot));
    graphs[id] = new Dygraph(plot, [[0, ...names.map(() => null)]], {
      labels: ["t", ...names], colors: ["#2f7ed8", "#e0803a", "#2fa57c"], strokeWidth: 1.4,
      legend: "always", ylabel: unit, gridLineColor: Charts.css("--line"), rightGap: 6,
      axes: { x: { axisLabelFormatter: (t) => +t.toPrecision(6) + " s", valueFormatter: (t) => t.toFixed(2) + " s",
                   ticker: Dygraph.numericTicks }, y: { axisLabelWidth: 58 } },
    });
  };
  chart("rotation", "Orientation, rotation vector", "deg", ["x", "y", "z"]);
  chart("rate", "Angular rate", "deg/s", ["x", "y", "z"]);
  chart("position", "Position", "m", ["x", "y", "z"]);
  chart("age", "Age of the newest pose", "ms", ["age"]);

  function rotationVector([w, x, y, z]) {
    if (w < 0) [w, x, y, z] = [-w, -x, -y, -z];
    const n = Math.hypot(x, y, z), k = n > 1e-9 ? 2 * Math.atan2(n, w) / n : 2;
    return [x * k * deg, y * k * deg, z * k * deg];
  }

  // ---- the body
  let view = null;
  try {
    view = new Body.View(stage, { t: [], q: [], p: [] }, { t: [], q: [], p: [] });
    view.ghost.visible = false;
  } catch (error) {
    stage.append(element("p", {}, "The body in 3D needs WebGL, which this browser does not offer: " + error.message));
  }

  // ---- what comes in
  let start = null, last = null, newest = null, count = 0, moved = false, drawn = 0;
  const source = new EventSource("values");
  source.onmessage = (event) => { newest = JSON.parse(event.data); ++count; take(newest); };
  source.onerror = () => show.state("not connected", "the program does not answer; trying again");
  function take(v) {
    if (start === null) start = v.now;
    const t = v.now - start, has = (k) => (v.status >> k & 1) === 1;
    const put = (id, values) => {
      rows[id].push([t, ...values]);
      while (rows[id].length && rows[id][0][0] < t - seconds) rows[id].shift();
    };
    if (v.sequence > 0) {
      put("rotation", has(0) ? rotationVector(v.q) : [NaN, NaN, NaN]);
      put("rate", v.rate.map((r) => r * deg));
      put("position", has(1) ? v.p : [NaN, NaN, NaN]);
      put("age", [v.age * 1e3]);
    }
    if (view && has(0)) {
      view.solid.quaternion.set(v.q[1], v.q[2], v.q[3], v.q[0]);
      moved = true;
    }
    if (last === null || v.now - last.now >= 1) figures(v);
  }
  function figures(v) {
    const dt = last === null ? 0 : v.now - last.now;
    const per = (name) => dt > 0 ? ((v[name] - last[name]) / dt).toFixed(0) : "–";
    const on = bits.filter((_, k) => k > 1 && v.status >> k & 1);
    const known = v.sequence > 0;
    show.state(!known ? "waiting" : on.includes("source lost") ? "lost" : on.includes("finished") ? "finished"
      : on.includes("settling") ? "settling" : on.includes("rest") ? "at rest" : "moving", on.join(", "));
    show.rate(per("publications"), v.sequence + " in all");
    show.samples(v.samples > 0 ? per("samples") : "–", v.samples + " in all");
    show.bytes(per("bytes"), v.bytes + " in all, " + v.frames + " frames");
    show.delay(known ? (v.age * 1e3).toFixed(0) + " ms" : "–", "publishing took " + v.publish_us + " µs, at most " + v.publish_max_us);
    show.faults(v.faults + v.damaged, `${v.faults} samples, ${v.damaged} losses of step, ${v.breaks} breaks, ${v.gaps} gaps`);
    calibrate(v);
    last = v;
  }
  // drawing follows the screen, not the messages: a slow machine draws less often and keeps up
  const draw = (now) => {
    requestAnimationFrame(draw);
    if (moved && view) view.render();
    moved = false;
    if (now - drawn < 200) return;
    for (const [id, graph] of Object.entries(graphs)) {
      const data = rows[id];
      if (data.length === 0) continue;
      const end = data[data.length - 1][0];
      graph.updateOptions({ file: data, dateWindow: [Math.max(0, end - seconds), Math.max(end, 1)],
                            gridLineColor: Charts.css("--line") });
    }
    drawn = performance.now();  // after the work, so that there is always time between
  };
  requestAnimationFrame(draw);
  window.live = { rows, graphs, view, get newest() { return newest; }, get count() { return count; } };
  document.documentElement.dataset.ready = 1;
})();
