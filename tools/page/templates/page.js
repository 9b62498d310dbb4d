"use strict";
let data;
const byId = (id) => document.getElementById(id);
const STATUS = ["", "no steady state was found", "the only equilibrium found is one that the machine leaves by itself",
  "the model cannot be evaluated at the start", "the warm-up cannot go on: a state leaves its range",
  "a value is out of its range", "an implicit equation has no solution", "values contradict each other"];
const NEEDED = "Chromium 91, Firefox 113, Safari 16.4 or later, with WebAssembly switched on";
const DAMAGED = "the file is damaged on its way. Copy it again, or write it anew with gearheat page";
const TOLERANCE = 1e-4, POINTS = 240, GRID = 21, LONGEST = 1e7, LETTER = 7.5;

const shown = (q, si) => (si - q.offset) / q.factor;
const inSi = (q, value) => value * q.factor + q.offset;
const digits = (value) => (value === null || !Number.isFinite(value) ? "–" : String(Number(value.toPrecision(5))));
const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

/* A machine: its module of WebAssembly, called with rows of numbers in SI. */
class Machine {
  constructor(instance, about) {
    Object.assign(this, about);
    this.c = instance.exports;
    this.place = {};
    for (const kind of ["states", "inputs", "parameters", "outputs"])
      this[kind].forEach((q, i) => { this.place[q.name] = { kind, i, q }; });
    this.width = this.outputs.length + this.checks.length;
  }

  start(kind) { return Float64Array.from(this[kind], (q) => q.start); }

  /* Copies arrays into the module's memory, calls a function with their addresses, reads the results, frees all. */
  call(arrays, run) {
    const sizes = arrays.map((a) => Math.max(8, a.byteLength));
    const at = sizes.map((size) => this.c.malloc(size));
    arrays.forEach((a, i) => new a.constructor(this.c.memory.buffer, at[i], a.length).set(a));
    run(at);
    arrays.forEach((a, i) => a.set(new a.constructor(this.c.memory.buffer, at[i], a.length)));
    at.forEach((address) => this.c.free(address));
  }

  /* What forbids values, in words, or null. */
  problem(u, p) {
    for (const [group, values] of [[this.inputs, u], [this.parameters, p]])
      for (const [i, q] of group.entries()) {
        const v = values[i], [lowOpen, highOpen] = q.open;
        const low = q.low === null || (lowOpen ? v > q.low : v >= q.low);
        const high = q.high === null || (highOpen ? v < q.high : v <= q.high);
        if (!Number.isFinite(v) || !low || !high) return `${q.name} is out of its range`;
      }
    if (!this.relations.length) return null;
    const broken = new Int32Array(1), own = p.slice();
    this.call([own, broken], ([a, b]) => this.c.batch_relations(1n, a, BigInt(own.length), b));
    return broken[0] < 0 ? null : this.relations[broken[0]];
  }

  /* Steady states of rows of inputs. */
  steady(n, u, p) {
    const [N, M] = [this.states.length, this.width + 4];
    const x = new Float64Array(n * N), y = new Float64Array(n * M), status = new Int32Array(n);
    const arrays = [u, p.slice(), this.start("states"), this.start("inputs"), x, y, status, new Int32Array(n)];
    this.call(arrays, ([u_, p_, s_, home, ...results]) =>
      this.c.batch_steady(BigInt(n), u_, BigInt(this.inputs.length), p_, 0n, s_, 0n, home, ...results));
    return { x, y, status, stride: M };
  }

  /* A warm-up at constant inputs: rows at `times`, the first of which is the start. */
  warmup(u, p, start, times) {
    const m = times.length - 1, NU = this.inputs.length, n = times.length;
    const length = Float64Array.from({ length: m }, (_, k) => times[k + 1] - times[k]);
    const after = new Int32Array(m + 1).fill(1), before = new Int32Array(m + 1);
    after[m] = 0;
    before[m] = 1;
    const x = new Float64Array(n * this.states.length), y = new Float64Array(n * this.width), status = new Int32Array(1);
    const duty = new ArrayBuffer(40);
    const arrays = [length, new Float64Array(m * NU), new Float64Array(m * NU), new Int32Array(NU), before, after,
      new Uint8Array(duty), u.slice(), p.slice(), start, x, y, new Float64Array(4), status, new Int32Array(1)];
    this.call(arrays, (at) => {
      const view = new DataView(this.c.memory.buffer, at[6], 40);
      view.setBigInt64(0, BigInt(m), true);
      for (let k = 0; k < 6; k++) view.setUint32(8 + 4 * k, at[k], true);
      view.setFloat64(32, TOLERANCE, true);
      this.c.batch_warmup(1n, at[6], at[7], 0n, at[8], 0n, at[9], 0n, BigInt(n), ...at.slice(10));
    });
    return { x, y, status: status[0], stride: this.width };
  }

  /* A quantity of row k of a result. */
  value(result, k, name) {
    const { kind, i } = this.place[name];
    return kind === "states" ? result.x[k * this.states.length + i] : result.y[k * result.stride + i];
  }
}

/* What a step gives, or an error that says why the model does not run. */
const reason = (step, why) => step.catch((error) => { throw new Error(why(error)); });

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

async function unpack(text) {
  if (!globalThis.WebAssembly || !globalThis.DecompressionStream) throw new Error(`this browser has no WebAssembly. It takes ${NEEDED}`);
  const code = await reason(inflated(text), () => DAMAGED);
  const { instance } = await reason(WebAssembly.instantiate(code, {}), (error) => `this browser refuses the module (${error.message}). It takes ${NEEDED}`);
  instance.exports._initialize?.();
  return instance;
}

/* Settings: values in SI by name, those that differ from the machine's own. */
let machines, machine, set = {}, kept = null, plot = null, timer = 0, widest = 0;

function vectors(values) {
  const u = machine.start("inputs"), p = machine.start("parameters");
  for (const [name, v] of Object.entries(values)) {
    const at = machine.place[name];
    if (at?.kind === "inputs") u[at.i] = v;
    if (at?.kind === "parameters") p[at.i] = v;
  }
  return [u, p];
}

function solve(values) {
  const [u, p] = vectors(values), wrong = machine.problem(u, p);
  if (wrong) return { wrong, u, p };
  const result = machine.steady(1, u, p);
  if (result.status[0]) return { wrong: STATUS[result.status[0]], u, p };
  return { u, p, read: (name) => (machine.place[name].kind === "inputs" ? u[machine.place[name].i] : machine.value(result, 0, name)), result };
}

function outside(result) {
  const first = machine.outputs.length;
  return machine.checks.flatMap(([text, low, high], i) => {
    const v = result.y[first + i];
    const range = `${low === null ? "" : digits(low)} .. ${high === null ? "" : digits(high)}`;
    return (low !== null && v < low) || (high !== null && v > high) ? [`${text} = ${digits(v)}, range ${range}`] : [];
  });
}

function drawFields() {
  const form = byId("fields"), groups = new Map();
  form.textContent = "";
  if (machines.length > 1) {
    form.insertAdjacentHTML("beforeend", `<fieldset><legend>machine</legend>${machines.map((m, i) =>
      `<label><input type="radio" name="machine" value="${i}" ${m === machine ? "checked" : ""}> ${escaped(m.label)}</label> `).join("")}</fieldset>`);
    form.querySelectorAll("[name=machine]").forEach((radio) => radio.addEventListener("change", () => {
      machine = machines[Number(radio.value)];
      drawFields();
      update();
    }));
  }
  for (const field of machine.fields) {
    if (!groups.has(field.group)) {
      const wrap = document.createElement(field.group === "other inputs" ? "details" : "fieldset");
      wrap.innerHTML = field.group === "other inputs" ? `<summary>${field.group}</summary>` : `<legend>${field.group}</legend>`;
      groups.set(field.group, form.appendChild(wrap));
    }
    const { q } = machine.place[field.name], ends = field.ends.map((v) => shown(q, v)).sort((a, b) => a - b);
    const value = shown(q, set[q.name] ?? q.start), row = document.createElement("div"), id = `f-${q.name}`;
    row.className = "field";
    row.innerHTML = `<label for="${id}" title="${escaped(q.doc)}">${escaped(q.name)}</label>
      <input type="number" id="${id}" step="any" value="${Number(value.toPrecision(8))}"><span>${escaped(q.unit)}</span>
      <input type="range" min="${ends[0]}" max="${ends[1]}" step="${(ends[1] - ends[0]) / 400}" value="${value}"
       aria-label="${escaped(q.doc || q.name)}, ${escaped(q.unit)}">`;
    const [number, range] = row.querySelectorAll("input");
    const take = (from, to) => from.addEventListener("input", () => {
      to.value = from.value;
      set[q.name] = from.value === "" ? NaN : inSi(q, Number(from.value));
      update();
    });
    take(number, range);
    take(range, number);
    groups.get(field.group).append(row);
  }
}

function drawValues(now, then) {
  const head = `<tr><th>name</th><th>value</th>${then ? "<th>kept</th><th>difference</th>" : ""}<th class="text">unit</th><th class="text">meaning</th></tr>`;
  byId("values").innerHTML = head + machine.shown.map((name) => {
    const { q } = machine.place[name], v = now.read ? shown(q, now.read(name)) : NaN, w = then?.read ? shown(q, then.read(name)) : NaN;
    const hot = name === machine.leading[0] && now.read?.(name) > data.limit ? ' class="wrong"' : "";
    return `<tr><td>${escaped(name)}</td><td${hot} data-name="${escaped(name)}" data-si="${now.read ? now.read(name) : ""}">${digits(v)}</td>${
      then ? `<td class="kept">${digits(w)}</td><td>${digits(v - w)}</td>` : ""}<td class="text">${escaped(q.unit)}</td><td class="text">${escaped(q.doc)}</td></tr>`;
  }).join("");
}

function drawBars(now, then) {
  const rows = (state) => [...Object.entries(machine.losses).map(([part, names]) => [`loss: ${part}`, names]),
    ...machine.heat.map((name) => [`heat out: ${name.replace(/\.Q_flow_?/, " ").trim()}`, [name]])]
    .map(([label, names]) => [label, state?.read ? names.reduce((sum, name) => sum + state.read(name), 0) : 0]);
  const own = rows(now), other = then ? rows(then) : [], high = then ? 30 : 20;
  const most = Math.max(1e-9, ...[...own, ...other].map((row) => Math.abs(row[1])));
  const bar = (v, y, style) => `<rect class="bar ${style}" x="230" y="${y}" height="10" width="${(260 * Math.abs(v)) / most}"/><text x="${236 + (260 * Math.abs(v)) / most}" y="${y + 9}">${digits(v)} W</text>`;
  byId("bars").innerHTML = `<svg viewBox="0 0 600 ${own.length * high + 4}" role="img" aria-label="${escaped(own.map(([l, v]) => `${l} ${digits(v)} W`).join(", "))}">${
    own.map(([label, v], i) => `<text x="224" y="${i * high + 13}" text-anchor="end">${escaped(label)}</text>${bar(v, i * high + 4, "")}${then ? bar(other[i][1], i * high + 15, "kept") : ""}`).join("")}</svg>`;
}

/* Heat from where it arises to where it leaves, as wide as its flow; the largest sum seen so far sets the scale. */
function drawFlows(now) {
  const place = byId("flows"), sum = (names) => names.reduce((all, name) => all + now.read(name), 0);
  if (!now.read) return void (place.textContent = "");
  const own = [Object.entries(machine.losses), machine.heat.map((name) => [name.replace(/\.Q_flow_?/, " ").trim(), [name]])]
    .map((side) => side.map(([label, names]) => [label, sum(names)]));
  const sides = [0, 1].map((i) => [...own[i].filter(([, v]) => v > 0), ...own[1 - i].filter(([, v]) => v < 0).map(([l, v]) => [l, -v])]);
  const totals = sides.map((side) => side.reduce((all, [, v]) => all + v, 0));
  widest = Math.max(widest, ...totals);
  const scale = 170 / (widest || 1), tall = Math.max(...sides.map((side) => side.reduce((all, [, v]) => all + Math.max(v * scale, 12) + 4, 0)), 20);
  const bands = sides.map((side, i) => {
    const [outer, inner, label, anchor] = i ? [400, 310, 406, "start"] : [170, 270, 164, "end"], half = (outer + inner) / 2;
    let y = 2, at = (tall - totals[i] * scale) / 2;
    return side.map(([name, v]) => {
      const h = v * scale, from = y, to = at;
      y += Math.max(h, 12) + 4;
      at += h;
      return `<path d="M${outer} ${from}C${half} ${from} ${half} ${to} ${inner} ${to}v${h}C${half} ${to + h} ${half} ${from + h} ${outer} ${from + h}z"/>`
        + `<text x="${label}" y="${from + Math.max(h, 12) / 2 + 4}" text-anchor="${anchor}">${escaped(name)} ${digits(v)} W</text>`;
    }).join("");
  });
  const longest = sides.map((side) => LETTER * Math.max(0, ...side.map(([name, v]) => `${name} ${digits(v)} W`.length)));
  const left = Math.min(0, 164 - longest[0]), right = Math.max(600, 406 + longest[1]);
  place.innerHTML = `<svg viewBox="${left} 0 ${right - left} ${tall + 4}" role="img" aria-label="Heat flows: ${digits(totals[0])} W arise, ${digits(totals[1])} W leave">${
    bands.join("")}<rect class="bar" x="270" width="40" y="${(tall - totals[0] * scale) / 2}" height="${totals[0] * scale}"/></svg>`;
}

/* A course from the room's temperature, as long as it takes to come near its end. */
function course(state) {
  const start = machine.start("states"), room = machine.room ? machine.place[machine.room] : null;
  machine.states.forEach((q, i) => { if (room && q.unit === room.q.unit && q.unit === "degC") start[i] = state.u[room.i]; });
  const near = () => machine.states.every((q, i) => q.unit !== "degC" || Math.abs(found.x[(POINTS) * machine.states.length + i] - state.read(q.name)) < 0.5);
  let length = 3600, found;
  for (; ; length *= 2) {
    const times = Float64Array.from({ length: POINTS + 1 }, (_, k) => (length * k) / POINTS);
    found = machine.warmup(state.u, state.p, start, times);
    if (found.status || length > LONGEST || near()) return { times, found };
  }
}

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function drawCourse(now, then) {
  const warm = machine.states.filter((q) => q.unit === "degC"), place = byId("plot");
  place.textContent = "";
  if (!now.read) return;
  const one = course(now);
  byId("warm").textContent = one.found.status ? STATUS[one.found.status] : "";
  if (one.found.status) return;
  const colours = [css("--mark"), "#3a9d4b", "#9b59b6", "#888", "#c0392b", "#d4a017"];
  const series = [{ label: "time [min]" }], columns = [Array.from(one.times, (t) => t / 60)];
  warm.forEach((q, j) => {
    series.push({ label: `${q.name} [degC]`, stroke: colours[j % colours.length], width: 2 });
    columns.push(Array.from(one.times, (_, k) => shown(q, machine.value(one.found, k, q.name))));
  });
  const lead = machine.place[machine.leading[0]]?.q;
  if (then?.read && lead && machine.place[lead.name].kind === "states") {
    const other = course(then), i = machine.place[lead.name].i, N = machine.states.length;
    series.push({ label: `${lead.name} kept`, stroke: css("--kept"), width: 2, dash: [6, 4] });
    columns.push(Array.from(one.times, (t) => {
      const k = Math.min(POINTS, Math.floor((t / other.times[POINTS]) * POINTS + 1e-9)), next = Math.min(POINTS, k + 1);
      const part = next === k ? 0 : (t - other.times[k]) / (other.times[next] - other.times[k]);
      return shown(lead, other.found.x[k * N + i] * (1 - part) + other.found.x[next * N + i] * part);
    }));
  }
  series.push({ label: "limit", stroke: css("--warn"), dash: [2, 4] });
  columns.push(columns[0].map(() => data.limit - 273.15));
  let table = columns;
  const m = data.measured, t = m ? m.names.indexOf("time") : -1;
  if (t >= 0) {
    const read = warm.filter((q) => m.names.includes(q.name)).map((q) => [{ label: `${q.name} measured`, paths: () => null,
      stroke: colours[warm.indexOf(q) % colours.length], points: { show: true, size: 7 } },
    [m.rows.map((row) => row[t] / 60), m.rows.map((row) => { const v = row[m.names.indexOf(q.name)]; return v === null ? null : shown(q, v); })]]);
    read.forEach(([line]) => series.push(line));
    table = uPlot.join([columns, ...read.map(([, points]) => points)]);
    series.forEach((line) => { line.spanGaps = !line.paths; });
  }
  const axis = { stroke: css("--text"), grid: { stroke: css("--line"), width: 0.5 } };
  plot = new uPlot({ width: Math.max(200, place.clientWidth), height: 340, scales: { x: { time: false } },
    axes: [{ ...axis, label: "time [min]" }, { ...axis, label: "temperature [degC]" }], series }, table, place);
}

function drawMap(now) {
  const name = byId("mapped").value, [speed, torque] = machine.axes, place = byId("map");
  if (!speed || !torque || !name) return void (place.textContent = "Speed and torque are not both given at a shaft end.");
  const ends = [speed, torque].map((axis) => machine.fields.find((f) => f.name === axis).ends);
  const at = ends.map(([a, b]) => Array.from({ length: GRID }, (_, k) => a + ((b - a) * k) / (GRID - 1)));
  const n = GRID * GRID, NU = machine.inputs.length, u = new Float64Array(n * NU);
  for (let i = 0; i < GRID; i++) for (let j = 0; j < GRID; j++) {
    const row = (i * GRID + j) * NU;
    u.set(now.u, row);
    u[row + machine.place[speed].i] = at[0][j];
    u[row + machine.place[torque].i] = at[1][i];
  }
  if (machine.problem(now.u, now.p)) return void (place.textContent = "");
  const found = machine.steady(n, u, now.p), q = machine.place[name].q, qs = machine.place[speed].q, qt = machine.place[torque].q;
  const v = Array.from({ length: n }, (_, k) => (found.status[k] ? NaN : shown(q, machine.value(found, k, name))));
  const known = v.filter(Number.isFinite), low = Math.min(...known), high = Math.max(...known), cell = 420 / GRID;
  const colour = (x) => (Number.isFinite(x) ? `hsl(${230 - (220 * (x - low)) / (high - low || 1)} 70% 50%)` : "#8886");
  const flipped = at[1][0] + at[1][GRID - 1] < 0;
  const X = (s) => 70 + ((s - at[0][0]) / (at[0][GRID - 1] - at[0][0])) * (420 - cell) + cell / 2;
  const Y = (t) => { const part = (t - at[1][0]) / (at[1][GRID - 1] - at[1][0]); return 430 - (flipped ? 1 - part : part) * (420 - cell) - cell / 2; };
  const cells = v.map((x, k) => `<rect x="${X(at[0][k % GRID]) - cell / 2}" y="${Y(at[1][Math.floor(k / GRID)]) - cell / 2}" width="${cell + 0.3}" height="${cell + 0.3}" fill="${colour(x)}"><title>${digits(shown(qs, at[0][k % GRID]))} ${qs.unit}, ${digits(shown(qt, at[1][Math.floor(k / GRID)]))} ${qt.unit}: ${digits(x)} ${q.unit}</title></rect>`);
  const over = name === machine.leading[0] ? v.flatMap((x, k) => {
    const edges = [], limit = shown(q, data.limit), i = Math.floor(k / GRID), j = k % GRID, half = cell / 2;
    const crossed = (other) => Number.isFinite(x) && Number.isFinite(v[other]) && (x > limit) !== (v[other] > limit);
    const cx = X(at[0][j]), cy = Y(at[1][i]), up = Y(at[1][Math.min(i + 1, GRID - 1)]) < cy ? -half : half;
    if (j + 1 < GRID && crossed(k + 1)) edges.push(`<path d="M${cx + half} ${cy - half}v${cell}"/>`);
    if (i + 1 < GRID && crossed(k + GRID)) edges.push(`<path d="M${cx - half} ${cy + up}h${cell}"/>`);
    return edges;
  }) : [];
  const m = data.measured, columns = m ? [speed, torque].map((axis) => m.names.indexOf(axis)) : [-1];
  const points = columns.includes(-1) ? [] : m.rows.filter((row) => columns.every((c) => row[c] !== null)).map((row) => {
    const c = m.names.indexOf(name), reads = c < 0 || row[c] === null ? "" : `: ${digits(shown(q, row[c]))} ${q.unit} measured`;
    return `<circle cx="${X(row[columns[0]])}" cy="${Y(row[columns[1]])}" r="4" fill="none" stroke="#fff" stroke-width="2"><title>${digits(shown(qs, row[columns[0]]))} ${qs.unit}, ${digits(shown(qt, row[columns[1]]))} ${qt.unit}${reads}</title></circle>`;
  });
  const text = (x, y, words, anchor) => `<text x="${x}" y="${y}" text-anchor="${anchor}">${escaped(words)}</text>`;
  place.innerHTML = `<svg viewBox="0 0 600 480" style="max-width: 44rem" role="img" aria-label="${escaped(name)} from ${digits(low)} to ${digits(high)} ${q.unit} over ${escaped(speed)} and ${escaped(torque)}">
    ${cells.join("")}<g stroke="#fff" stroke-width="2.5" fill="none">${over.join("")}</g>${points.join("")}
    <circle cx="${X(now.u[machine.place[speed].i])}" cy="${Y(now.u[machine.place[torque].i])}" r="6" fill="#fff" stroke="#000" stroke-width="2"/>
    ${[0, GRID - 1].map((k) => text(X(at[0][k]), 446, digits(shown(qs, at[0][k])), "middle") + text(64, Y(at[1][k]) + 4, digits(shown(qt, at[1][k])), "end")).join("")}
    ${text(280, 466, `${speed} [${qs.unit}]`, "middle")}<text transform="translate(14 220) rotate(-90)" text-anchor="middle">${escaped(torque)} [${qt.unit}]</text>
    ${[0, 0.25, 0.5, 0.75, 1].map((f) => `<rect x="505" y="${20 + 40 * (4 - 4 * f)}" width="18" height="40" fill="${colour(low + f * (high - low))}"/>${text(528, 44 + 40 * (4 - 4 * f), digits(low + f * (high - low)), "start")}`).join("")}
    ${text(505, 14, q.unit, "start")}</svg>`;
}

/* The state in the address: name=value in the units shown; what is kept has a tilde before its name. */
function writeLink() {
  const parts = [...(machine === machines[0] ? [] : [`machine=${machines.indexOf(machine)}`])];
  for (const [mark, values] of [["", set], ["~", kept ?? {}]])
    for (const [name, v] of Object.entries(values))
      if (machine.place[name] && Number.isFinite(v)) parts.push(`${mark}${encodeURIComponent(name)}=${Number(shown(machine.place[name].q, v).toPrecision(12))}`);
  if (kept && !Object.keys(kept).length) parts.push("~");
  history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname + location.search);
}

function readLink() {
  const values = {}, before = {};
  let keeps = false;
  for (const part of location.hash.slice(1).split("&").filter(Boolean)) {
    const marked = part.startsWith("~"), [name, text] = decodeURIComponent(marked ? part.slice(1) : part).split("=");
    keeps ||= marked;
    if (name === "machine" && machines[Number(text)]) machine = machines[Number(text)];
    else if (["inputs", "parameters"].includes(machine.place[name]?.kind) && text !== "" && Number.isFinite(Number(text)))
      (marked ? before : values)[name] = inSi(machine.place[name].q, Number(text));
  }
  set = values;
  kept = keeps ? before : null;
}

function update() {
  const begun = performance.now(), now = solve(set), then = kept && solve(kept), status = byId("status");
  drawValues(now, then);
  drawFlows(now);
  drawBars(now, then);
  const laws = now.read ? outside(now.result) : [];
  byId("validity").innerHTML = laws.length ? laws.map((text) => `<li class="wrong">${escaped(text)}</li>`).join("") : "<li>All laws are inside the ranges of their sources.</li>";
  const hot = now.read && machine.leading[0] && now.read(machine.leading[0]) > data.limit;
  status.className = now.wrong || hot ? "wrong" : "";
  status.textContent = now.wrong ? `No result: ${now.wrong}.` : hot ? `${machine.leading[0]} is above the limit of ${digits(data.limit - 273.15)} degC.`
    : laws.length ? `${laws.length} law arguments are outside the range of their source, see Validity.` : "";
  document.body.dataset.drag = (performance.now() - begun).toFixed(2);
  writeLink();
  clearTimeout(timer);
  timer = setTimeout(() => {
    drawCourse(now, then);
    drawMap(now);
    document.body.dataset.ready = "1";
  }, 60);
}

async function main() {
  const begun = performance.now();
  data = await reason((async () => JSON.parse(byId("data").textContent))(), () => DAMAGED);
  const instances = await Promise.all(data.modules.map(unpack));
  machines = data.machines.map((about) => new Machine(instances[about.module], about));
  machine = machines[0];
  readLink();
  byId("mapped").innerHTML = machine.leading.map((name) => `<option>${escaped(name)}</option>`).join("");
  drawFields();
  update();
  document.body.dataset.first = (performance.now() - begun).toFixed(1);
  byId("mapped").addEventListener("change", update);
  byId("keep").addEventListener("click", () => { kept = { ...set }; update(); });
  byId("drop").addEventListener("click", () => { kept = null; update(); });
  byId("reset").addEventListener("click", () => { set = {}; drawFields(); update(); });
  byId("link").addEventListener("click", () => navigator.clipboard?.writeText(location.href).then(() => { byId("status").textContent = "The link is copied."; }));
  window.addEventListener("hashchange", () => { readLink(); drawFields(); update(); });
  window.addEventListener("resize", () => plot?.setSize({ width: Math.max(200, byId("plot").clientWidth), height: 340 }));
  byId("fields").addEventListener("submit", (event) => event.preventDefault());
}

main().catch((error) => {
  byId("status").className = "wrong";
  byId("status").textContent = `The model does not run: ${error.message}.`;
});
