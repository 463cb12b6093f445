"use strict";
// Charts over one axis of time: they zoom and pan together, share one cursor, and show every peak
// at every zoom. Drawn by dygraphs.
const Charts = (() => {
  // ---- numbers as the program packs them (host_sim/report/packed.cpp)
  async function unpack(text) {
    const packed = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }
  function words(bytes, at, n, planes) {
    const out = new Uint32Array(n);
    for (let p = 0; p < planes; ++p)
      for (let i = 0; i < n; ++i) out[i] |= bytes[at + p * n + i] << (8 * p);
    return out;
  }
  function values(bytes, d) {
    const w = words(bytes, d.at, d.n, 2), out = new Float64Array(d.n);
    let level = 0;
    for (let i = 0; i < d.n; ++i) {
      level = (level + w[i]) & 65535;
      out[i] = level === 65535 ? NaN : d.zero + d.step * level;
    }
    return out;
  }
  function times(bytes, d) {
    const w = words(bytes, d.at, d.n, 4), out = new Float64Array(d.n);
    let step = 0, us = 0;
    for (let i = 0; i < d.n; ++i) {
      step += w[i] | 0;
      us += step;
      out[i] = us * 1e-6;
    }
    return out;
  }

  /** The first index whose time is not before t. */
  function lower(x, t) {
    let a = 0, b = x.length;
    while (a < b) {
      const m = (a + b) >> 1;
      if (x[m] < t) a = m + 1; else b = m;
    }
    return a;
  }
  /** The value at the point nearest to t; NaN where there is none. */
  function valueAt(s, t) {
    if (s.x.length === 0) return NaN;
    let i = lower(s.x, t);
    if (i > 0 && (i === s.x.length || t - s.x[i - 1] < s.x[i] - t)) --i;
    return s.y[i];
  }

  /** Rows [t, y...] of the visible part: every point where there are few, else the least and the
      largest value of each stretch. NaN breaks a line, null is passed over. */
  function decimated(series, from, to, buckets) {
    const rows = new Map();
    const put = (t, k, y) => {
      let row = rows.get(t);
      if (!row) rows.set(t, row = [t, ...series.map(() => null)]);
      row[k + 1] = y;
    };
    series.forEach((s, k) => {
      const n = s.x.length;
      const first = Math.max(0, lower(s.x, from) - 1), end = Math.min(n, lower(s.x, to) + 1);
      if (n > 0) { put(s.x[0], k, s.y[0]); put(s.x[n - 1], k, s.y[n - 1]); }
      if (end - first <= 2 * buckets) {
        for (let i = first; i < end; ++i) put(s.x[i], k, s.y[i]);
        return;
      }
      const width = (to - from) / buckets;
      for (let i = first; i < end;) {
        const b = Math.floor((s.x[i] - from) / width);
        let low = NaN, high = NaN, broken = false;
        for (; i < end && Math.floor((s.x[i] - from) / width) === b; ++i) {
          const y = s.y[i];
          if (Number.isNaN(y)) { broken = true; continue; }
          if (!(y >= low)) low = y;
          if (!(y <= high)) high = y;
        }
        if (!Number.isNaN(low)) {
          put(from + (b + 0.25) * width, k, low);
          put(from + (b + 0.75) * width, k, high);
        }
        if (broken) put(from + (b + 0.999) * width, k, NaN);
      }
    });
    return [...rows.values()].sort((a, b) => a[0] - b[0]);
  }

  function css(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }
  function element(tag, attributes = {}, ...children) {
    const e = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
    e.append(...children);
    return e;
  }
  function save(name, type, text) {
    const link = element("a", { download: name, href: URL.createObjectURL(new Blob([text], { type })) });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  function digits(v) {
    if (Number.isNaN(v)) return "–";
    const a = Math.abs(v);
    return a !== 0 && (a < 1e-3 || a >= 1e5) ? v.toExponential(2) : v.toPrecision(5);
  }

  /** All charts of a page: the window that they share, the cursor, marks and bands. */
  class Group {
    constructor(end) {
      this.end = end;
      this.window = [0, end];
      this.cursor = 0;
      this.charts = [];
      this.marks = [];   // {name, color, times, on}
      this.bands = [];   // {name, color, from, to, on}
      this.listeners = [];
    }
    add(parent, chart) {
      this.charts.push(new Chart(this, parent, chart));
    }
    setWindow(from, to) {
      const least = 1e-4;
      if (!(to - from >= least)) to = from + least;
      this.window = [from, to];
      for (const c of this.charts) c.draw();
      this.setCursor(this.cursor);
    }
    setCursor(t) {
      this.cursor = Math.min(Math.max(t, 0), this.end);
      for (const c of this.charts) c.showCursor();
      for (const f of this.listeners) f(this.cursor);
    }
    redraw() { for (const c of this.charts) c.draw(); }
  }

  class Chart {
    constructor(group, parent, data) {
      this.group = group;
      this.data = data;
      this.on = data.series.map(() => true);
      this.box = element("section", { class: "chart", id: "chart-" + data.id });
      const csv = element("button", { type: "button", class: "csv" }, "CSV");
      const svg = element("button", { type: "button", class: "svg" }, "SVG");
      csv.onclick = () => save(data.id + ".csv", "text/csv", this.csv());
      svg.onclick = () => save(data.id + ".svg", "image/svg+xml", this.svg());
      this.legend = element("div", { class: "legend" });
      this.plot = element("div", { class: "plot" });
      this.line = element("div", { class: "cursor" });
      const steps = data.series.filter((s) => s.step > 0).map((s) => s.step);
      const step = steps.length ? ` Values in steps of ${Math.max(...steps).toPrecision(2)} ${data.unit}.` : "";
      this.box.append(
        element("header", {}, element("h2", {}, data.title), element("span", { class: "tools" }, csv, svg)),
        element("div", { class: "caption" }, data.caption + step), this.legend, this.plot);
      parent.append(this.box);
      this.outputs = data.series.map((s, k) => this.addSwitch(s, k));
      this.make();
    }
    addSwitch(s, k) {
      const value = element("output", {});
      const input = element("input", { type: "checkbox" });
      input.checked = true;
      const name = s.name || "series " + (k + 1);
      const label = element("label", { class: "switch" }, input,
        element("i", { style: "background:" + s.color }), name, value);
      input.onchange = () => {
        this.on[k] = input.checked;
        label.classList.toggle("off", !input.checked);
        this.graph.setVisibility(k, input.checked);
      };
      this.legend.append(label);
      return value;
    }
    make() {
      const d = this.data, series = {};
      d.series.forEach((s, k) => {
        series["s" + k] = {
          color: s.color, strokeWidth: s.width,
          ...(s.style === "dashed" ? { strokePattern: [6, 4] } : {}),
          ...(s.style === "dots" ? { drawPoints: true, strokeWidth: 0, pointSize: 2 } : {}),
        };
      });
      this.graph = new Dygraph(this.plot, this.rows(), {
        labels: ["t", ...d.series.map((_, k) => "s" + k)], series,
        dateWindow: this.group.window, valueRange: d.min < d.max ? [d.min, d.max] : null,
        connectSeparatedPoints: true, logscale: d.log, legend: "never", labelsDiv: element("div"),
        ylabel: d.unit, gridLineColor: css("--line"), axisLineColor: css("--line"),
        axes: { x: { valueFormatter: (t) => t, axisLabelFormatter: (t) => +t.toPrecision(7) + " s",
                     ticker: Dygraph.numericTicks },
                y: { axisLabelWidth: 58 } },
        highlightCircleSize: 0, animatedZooms: false, rightGap: 6,
        underlayCallback: (canvas, area, g) => this.underlay(canvas, area, g),
        interactionModel: this.interaction(),
        zoomCallback: (from, to) => this.group.setWindow(from, to),
        drawCallback: (g, first) => {
          if (first || this.drawing) return;
          const [from, to] = g.xAxisRange();
          if (from !== this.group.window[0] || to !== this.group.window[1])
            this.group.setWindow(from, to);  // a pan
        },
      });
      this.plot.append(this.line);
      new ResizeObserver(() => { this.graph.resize(); this.showCursor(); }).observe(this.plot);
    }
    /** Drag: zoom; with shift: pan; wheel: zoom about the cursor; double click: all. Two fingers
        zoom, one moves the cursor or scrolls the page. */
    interaction() {
      const usual = Dygraph.defaultInteractionModel, group = this.group;
      const at = (event, g) => {
        const touch = event.touches ? event.touches[0] : event;
        return g.toDataXCoord(touch.clientX - this.plot.getBoundingClientRect().left);
      };
      const several = (event) => event.touches.length > 1;
      return {
        ...usual,
        mousemove: (event, g) => group.setCursor(at(event, g)),
        dblclick: () => group.setWindow(0, group.end),
        wheel: (event, g) => {
          if (!event.ctrlKey && !event.shiftKey) return;  // the page scrolls
          event.preventDefault();
          const t = at(event, g), f = event.deltaY > 0 ? 1.25 : 0.8, [a, b] = group.window;
          group.setWindow(Math.max(0, t - (t - a) * f), Math.min(group.end, t + (b - t) * f));
        },
        touchstart: (event, g, context) => {
          if (several(event)) usual.touchstart(event, g, context);
          else group.setCursor(at(event, g));
        },
        touchmove: (event, g, context) => {
          if (several(event)) usual.touchmove(event, g, context);
          else group.setCursor(at(event, g));
        },
        touchend: (event, g, context) => {
          if (context.touchDirections) usual.touchend(event, g, context);
        },
      };
    }
    rows() {
      const [from, to] = this.group.window;
      const width = this.plot.clientWidth || 800;
      const rows = decimated(this.data.series, from, to, Math.max(200, Math.round(width)));
      return rows.length ? rows : [[0, ...this.data.series.map(() => null)]];
    }
    draw() {
      this.drawing = true;
      this.graph.updateOptions({ file: this.rows(), dateWindow: this.group.window,
                                 gridLineColor: css("--line"), axisLineColor: css("--line") });
      this.drawing = false;
    }
    underlay(canvas, area, g) {
      const x = (t) => g.toDomXCoord(t), right = area.x + area.w;
      for (const b of this.group.bands) {
        if (!b.on) continue;
        canvas.fillStyle = b.color + "2e";
        for (let i = 0; i < b.from.length; ++i) {
          const left = Math.max(area.x, x(b.from[i])), end = Math.min(right, x(b.to[i]));
          if (end < area.x || left > right) continue;
          canvas.fillRect(left, area.y, Math.max(1, end - left), area.h);
        }
      }
      let row = 0;
      for (const m of this.group.marks) {
        if (!m.on) continue;
        canvas.fillStyle = m.color;
        let last = -1;  // one tick a pixel
        for (let i = lower(m.times, this.group.window[0]); i < m.times.length; ++i) {
          const px = Math.round(x(m.times[i]));
          if (px > right) break;
          if (px !== last) canvas.fillRect(px, area.y + area.h - 8 - 9 * row, 1, 8);
          last = px;
        }
        ++row;
      }
    }
    showCursor() {
      const t = this.group.cursor, [from, to] = this.group.window;
      this.line.style.display = t >= from && t <= to ? "block" : "none";
      this.line.style.left = this.graph.toDomXCoord(t) + "px";
      this.data.series.forEach((s, k) => { this.outputs[k].textContent = digits(valueAt(s, t)); });
    }
    csv() {
      const [from, to] = this.group.window, lines = [];
      const shown = this.data.series.filter((_, k) => this.on[k]);
      lines.push(["t [s]", ...shown.map((s, k) => `${s.name || "series " + (k + 1)} [${this.data.unit}]`)]
        .map((n) => '"' + n.replaceAll('"', '""') + '"').join(","));
      const stamps = new Set();
      for (const s of shown)
        for (let i = lower(s.x, from); i < s.x.length && s.x[i] <= to; ++i) stamps.add(s.x[i]);
      for (const t of [...stamps].sort((a, b) => a - b))
        lines.push([t.toFixed(6), ...shown.map((s) => {
          const i = lower(s.x, t);
          return i < s.x.length && s.x[i] === t && !Number.isNaN(s.y[i]) ? s.y[i].toPrecision(8) : "";
        })].join(","));
      return lines.join("\n") + "\n";
    }
    svg() {
      const w = 1000, h = 320, left = 70, right = 15, top = 34, bottom = 40;
      const [t0, t1] = this.group.window, [y0, y1] = this.graph.yAxisRange();
      const scale = this.data.log ? Math.log10 : (v) => v;
      const X = (t) => left + (t - t0) / (t1 - t0) * (w - left - right);
      const Y = (v) => h - bottom - (scale(v) - scale(y0)) / (scale(y1) - scale(y0)) * (h - top - bottom);
      const text = (s) => s.replace(/[<>&"]/g, (c) => `&#${c.charCodeAt(0)};`);
      let out = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${w} ${h}" font-family="sans-serif" font-size="12">` +
        `<rect width="${w}" height="${h}" fill="#fff"/><text x="${left}" y="20" font-size="15">${text(this.data.title)}</text>` +
        `<text x="${left}" y="${top - 2}" fill="#667085">${text(this.data.unit)}</text>` +
        `<clipPath id="c"><rect x="${left}" y="${top}" width="${w - left - right}" height="${h - top - bottom}"/></clipPath>`;
      const axis = (a, b, n, f) => {
        for (const tick of Dygraph.numericTicks(a, b, n, (o) => this.graph.getOptionForAxis(o, "y"), this.graph))
          if (tick.v >= a && tick.v <= b) f(tick.v, tick.label);
      };
      axis(t0, t1, 900, (v) => { out += `<path d="M${X(v)} ${top}V${h - bottom}" stroke="#e3e7ee"/><text x="${X(v)}" y="${h - bottom + 16}" text-anchor="middle">${+v.toPrecision(7)} s</text>`; });
      axis(y0, y1, 250, (v, label) => { if (!this.data.log || v > 0) out += `<path d="M${left} ${Y(v)}H${w - right}" stroke="#e3e7ee"/><text x="${left - 6}" y="${Y(v) + 4}" text-anchor="end">${label}</text>`; });
      const rows = this.rows();
      let legend = left + 300;
      this.data.series.forEach((s, k) => {
        if (!this.on[k]) return;
        let d = "", pen = false;
        for (const row of rows) {
          const v = row[k + 1];
          if (v === null || row[0] < t0 || row[0] > t1) continue;
          if (Number.isNaN(v) || (this.data.log && v <= 0)) { pen = false; continue; }
          d += (pen ? "L" : "M") + X(row[0]).toFixed(2) + " " + Y(v).toFixed(2);
          pen = true;
        }
        const dash = s.style === "dashed" ? ' stroke-dasharray="6 4"' : "";
        out += `<path d="${d}" fill="none" stroke="${s.color}" stroke-width="${s.width}"${dash} clip-path="url(#c)"/>`;
        out += `<text x="${legend}" y="20" fill="${s.color}">${text(s.name)}</text>`;
        legend += 20 + 7 * s.name.length;
      });
      return out + "</svg>\n";
    }
  }
  return { Group, unpack, values, times, lower, element, css };
})();
