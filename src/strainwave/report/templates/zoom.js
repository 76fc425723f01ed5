"use strict";
(function () {
  const figure = document.querySelector("figure.zoom");
  const canvas = figure.querySelector("canvas");
  const readout = figure.querySelector(".zoom-readout");
  const plot = JSON.parse(figure.dataset.plot);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const time = new Float64Array(bytes(plot.time));
  const low = plot.low.map((text) => new Float32Array(bytes(text)));
  const high = plot.high.map((text) => new Float32Array(bytes(text)));
  const rejected = new Uint8Array(bytes(plot.rejected));
  const count = time.length;
  if (count < 2 || !(time[count - 1] > time[0])) return;
  const colours = ["#7F7F7F", "#0072B2"];
  const names = ["as recorded", "ripple removed"];
  const whole = [time[0], time[count - 1]];
  const shortest = Math.max(4 * (whole[1] - whole[0]) / count, 1e-6);
  const shown = [true, true];
  let view = whole.slice();
  let selection = null;
  let cursor = null;
  const margin = { left: 52, right: 10, top: 10, bottom: 36 };
  let width = 0, height = 0;

  // First point that is no earlier than a time.
  function place(t) {
    let a = 0, b = count;
    while (a < b) { const m = (a + b) >> 1; if (time[m] < t) a = m + 1; else b = m; }
    return a;
  }
  function setView(from, to) {
    let span = Math.min(Math.max(to - from, shortest), whole[1] - whole[0]);
    const middle = 0.5 * (from + to);
    let start = Math.min(Math.max(middle - 0.5 * span, whole[0]), whole[1] - span);
    view = [start, start + span];
    draw();
  }
  const zoom = (factor, about) => {
    const t = about === undefined ? 0.5 * (view[0] + view[1]) : about;
    const span = Math.min(Math.max((view[1] - view[0]) * factor, shortest), whole[1] - whole[0]);
    const share = (t - view[0]) / (view[1] - view[0]);
    setView(t - share * span, t - share * span + span);
  };
  const shift = (share) => { const d = share * (view[1] - view[0]); setView(view[0] + d, view[1] + d); };
  const reset = () => setView(whole[0], whole[1]);
  const act = {
    left: () => shift(-0.25), right: () => shift(0.25), in: () => zoom(0.5), out: () => zoom(2), reset: reset,
  };

  function steps(from, to, about) {
    const raw = (to - from) / about, ten = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].find((n) => n * ten >= raw) * ten;
    const ticks = [];
    for (let n = Math.ceil(from / step - 1e-9); n * step <= to + 1e-9 * step; n++) ticks.push(n * step);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    return { ticks, text: (v) => (Math.abs(v) < 1e-9 * step ? 0 : v).toFixed(Math.min(digits, 9)).replace("-", "\u2212") };
  }
  const toX = (t) => margin.left + (t - view[0]) / (view[1] - view[0]) * (width - margin.left - margin.right);
  const toTime = (x) => view[0] + (x - margin.left) / (width - margin.left - margin.right) * (view[1] - view[0]);

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    width = canvas.clientWidth; height = canvas.clientHeight;
    if (!width) return;
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = "12px Helvetica, Arial, sans-serif";
    const first = Math.max(0, place(view[0]) - 1), last = Math.min(count - 1, place(view[1]));
    let bottom = Infinity, top = -Infinity;
    for (let s = 0; s < 2; s++) if (shown[s]) for (let i = first; i <= last; i++) {
      if (low[s][i] < bottom) bottom = low[s][i];
      if (high[s][i] > top) top = high[s][i];
    }
    if (!(top >= bottom)) { bottom = -1; top = 1; }
    const room = 0.06 * (top - bottom) || Math.max(1e-3, 0.1 * Math.abs(top));
    bottom -= room; top += room;
    const toY = (v) => height - margin.bottom - (v - bottom) / (top - bottom) * (height - margin.bottom - margin.top);
    const across = steps(view[0], view[1], Math.max(3, width / 110)), up = steps(bottom, top, Math.max(3, height / 60));
    pen.strokeStyle = "#E2E2E2"; pen.fillStyle = "#1d2329"; pen.lineWidth = 1;
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const t of across.ticks) {
      const x = toX(t);
      pen.beginPath(); pen.moveTo(x, margin.top); pen.lineTo(x, height - margin.bottom); pen.stroke();
      pen.fillText(across.text(t), x, height - margin.bottom + 4);
    }
    pen.fillText(plot.timeLabel, margin.left + 0.5 * (width - margin.left - margin.right), height - 15);
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const v of up.ticks) {
      const y = toY(v);
      pen.beginPath(); pen.moveTo(margin.left, y); pen.lineTo(width - margin.right, y); pen.stroke();
      pen.fillText(up.text(v), margin.left - 5, y);
    }
    pen.save(); pen.translate(11, 0.5 * (height - margin.bottom + margin.top)); pen.rotate(-Math.PI / 2);
    pen.textAlign = "center"; pen.fillText("torque (Nm)", 0, 0); pen.restore();
    pen.save(); pen.beginPath();
    pen.rect(margin.left, margin.top, width - margin.left - margin.right, height - margin.top - margin.bottom); pen.clip();
    pen.fillStyle = "#D55E00";
    for (let i = first; i <= last; i++) if (rejected[i]) pen.fillRect(toX(time[i]) - 1, height - margin.bottom - 7, 2, 7);
    for (let s = 0; s < 2; s++) if (shown[s]) trace(pen, s, first, last, toY);
    if (selection) {
      pen.fillStyle = "rgba(0, 114, 178, 0.15)";
      pen.fillRect(Math.min(selection[0], selection[1]), 0, Math.abs(selection[1] - selection[0]), height);
    }
    if (cursor !== null) { pen.strokeStyle = "#222222"; pen.lineWidth = 0.6; pen.beginPath(); pen.moveTo(cursor, 0); pen.lineTo(cursor, height); pen.stroke(); }
    pen.restore();
  }
  // Lowest and highest of every column of pixels: no spike is lost at any zoom.
  function trace(pen, s, first, last, toY) {
    pen.strokeStyle = colours[s]; pen.lineWidth = s ? 1.4 : 1; pen.lineJoin = "round"; pen.beginPath();
    let drawing = false, i = first;
    while (i <= last) {
      const x = toX(time[i]), column = Math.floor(x);
      let a = Infinity, b = -Infinity, begin = NaN, end = NaN, broken = false;
      while (i <= last && Math.floor(toX(time[i])) <= column) {
        if (low[s][i] <= high[s][i]) {
          if (Number.isNaN(begin)) begin = low[s][i];
          end = high[s][i];
          if (low[s][i] < a) a = low[s][i];
          if (high[s][i] > b) b = high[s][i];
        } else broken = true;
        i++;
      }
      if (!(b >= a)) { if (broken) drawing = false; continue; }
      if (drawing) pen.lineTo(x, toY(begin)); else pen.moveTo(x, toY(begin));
      if (b > a) { pen.lineTo(x, toY(a)); pen.lineTo(x, toY(b)); pen.lineTo(x, toY(end)); }
      drawing = true;
    }
    pen.stroke();
  }
  const number = (v) => v.toFixed(3).replace("-", "\u2212");
  function read(x) {
    cursor = Math.min(Math.max(x, margin.left), width - margin.right);
    const t = toTime(cursor);
    let i = Math.min(count - 1, place(t));
    if (i > 0 && t - time[i - 1] < time[i] - t) i--;
    const parts = [time[i].toFixed(4) + " s"];
    for (let s = 0; s < 2; s++) if (shown[s]) {
      const a = low[s][i], b = high[s][i];
      parts.push(names[s] + " " + (!(b >= a) ? "none" : b - a < 5e-4 ? number(a) + " Nm" : number(a) + " to " + number(b) + " Nm"));
    }
    if (rejected[i]) parts.push("not used");
    readout.textContent = parts.join(", ");
    draw();
  }

  const fingers = new Map();
  let pinch = null;
  const local = (event) => event.clientX - canvas.getBoundingClientRect().left;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    fingers.set(event.pointerId, local(event));
    canvas.setPointerCapture(event.pointerId);
    if (event.pointerType === "touch") {
      const xs = [...fingers.values()];
      pinch = { times: xs.map(toTime), view: view.slice() };
      selection = null;
    } else selection = [local(event), local(event)];
  });
  canvas.addEventListener("pointermove", (event) => {
    const x = local(event);
    if (!fingers.has(event.pointerId)) { if (event.pointerType !== "touch") read(x); return; }
    fingers.set(event.pointerId, x);
    if (selection) { selection[1] = x; draw(); return; }
    if (!pinch) return;
    // What was under each finger stays there.
    const xs = [...fingers.values()], inner = width - margin.left - margin.right;
    if (xs.length === 1) {
      const span = view[1] - view[0], from = pinch.times[0] - (x - margin.left) / inner * span;
      setView(from, from + span);
    } else {
      const apart = xs[1] - xs[0];
      if (Math.abs(apart) < 8) return;
      const span = Math.abs((pinch.times[1] - pinch.times[0]) / apart * inner);
      const from = pinch.times[0] - (xs[0] - margin.left) / inner * span;
      setView(from, from + span);
    }
  });
  function release(event) {
    fingers.delete(event.pointerId);
    if (selection) {
      const [a, b] = [Math.min(...selection), Math.max(...selection)];
      selection = null;
      if (b - a > 6 && event.type === "pointerup") setView(toTime(a), toTime(b)); else draw();
    }
    pinch = fingers.size ? { times: [...fingers.values()].map(toTime), view: view.slice() } : null;
  }
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointerleave", () => { if (cursor !== null) { cursor = null; readout.textContent = "\u00a0"; draw(); } });
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("wheel", (event) => {
    // With everything in view, the page scrolls on.
    if (event.deltaY > 0 && view[1] - view[0] >= 0.999 * (whole[1] - whole[0])) return;
    event.preventDefault();
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) shift(event.deltaX / width);
    else zoom(Math.pow(1.0015, Math.max(-400, Math.min(400, event.deltaY))), toTime(local(event)));
  }, { passive: false });
  const keys = { ArrowLeft: "left", ArrowRight: "right", "+": "in", "=": "in", "-": "out", "0": "reset", Home: "reset" };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault(); act[keys[event.key]]();
  });
  for (const button of figure.querySelectorAll("button[data-do]")) button.addEventListener("click", () => act[button.dataset.do]());
  for (const box of figure.querySelectorAll("input[data-series]")) {
    shown[+box.dataset.series] = box.checked;
    box.addEventListener("change", () => { shown[+box.dataset.series] = box.checked; draw(); });
  }
  figure.querySelector(".zoom-live").hidden = false;
  figure.querySelector(".zoom-help").hidden = false;
  figure.querySelector(".zoom-still").style.display = "none";
  new ResizeObserver(draw).observe(canvas);
  draw();
})();
