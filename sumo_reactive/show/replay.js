// The replay of a run: a map that plays. Data: `payload_of` in replay.py; places in m, headings in rad, times in s.
"use strict";
(async () => {
  if (document.readyState === "loading") await new Promise((done) => addEventListener("DOMContentLoaded", done, { once: true }));
  const root = document.getElementById("replay-player"), data = await unpacked(stored("replay")[0].textContent).json();
  await figuresDrawn;
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const canvas = part("map"), pen = canvas.getContext("2d"), said = part("said"), about = part("about");
  const slider = part("time"), clock = part("clock"), play = part("play"), rate = part("rate");
  const last = data.times.length - 1, begin = data.times[0], end = data.times[last];
  const toggles = { follow: true, field: true, ground: true, shadows: true, names: false };
  let now = begin, playing = false, scale = 6, centre = [data.ego.x[0], data.ego.y[0]], chosen = null, before = 0, dirty = true;

  // Whatever holds from a time on: a list of [time, …] in order; the entry in force, or null.
  const inForce = (list, time) => {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle][0] <= time + 1e-6) low = middle + 1; else high = middle;
    }
    return low ? list[low - 1] : null;
  };
  const stepAt = (time) => {
    let low = 0, high = last;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (data.times[middle] <= time + 1e-6) low = middle; else high = middle - 1;
    }
    return low;
  };
  const between = (a, b, share) => a + share * (b - a);
  const turned = (a, b, share) => a + share * Math.atan2(Math.sin(b - a), Math.cos(b - a));

  // Who is there at a step: a map from user to [x, y, heading, speed, signals]. Tracks hold changes of changes.
  const there = data.times.map(() => []);
  for (const [user, first, ...columns] of data.users.tracks) {
    const values = columns.map((changes) => {
      let rate = 0, value = 0;
      return changes.map((change) => (value += (rate += change)));
    });
    values[0].forEach((_, k) => there[first + k].push([user, ...values.map((column) => column[k])]));
  }
  const seen = new Map();
  const usersAt = (step) => {
    if (!seen.has(step)) {
      if (seen.size > 64) seen.clear();
      seen.set(step, new Map(there[step].map(([user, x, y, heading, speed, signals]) => [user, [x / 100, y / 100, heading / 1000, speed / 100, signals]])));
    }
    return seen.get(step);
  };
  const scene = () => {
    const step = stepAt(now), next = Math.min(step + 1, last), span = data.times[next] - data.times[step];
    const share = span > 0 ? Math.min(1, (now - data.times[step]) / span) : 0, ego = data.ego, after = usersAt(next);
    const mine = [between(ego.x[step], ego.x[next], share), between(ego.y[step], ego.y[next], share),
      turned(ego.heading[step], ego.heading[next], share), ego.speed[step]];
    const users = [...usersAt(step)].map(([user, at]) => {
      const then = after.get(user) || at;
      return [user, [between(at[0], then[0], share), between(at[1], then[1], share), turned(at[2], then[2], share), at[3], at[4]]];
    });
    return { step, mine, users };
  };

  // Drawing: metres, y up.
  let colours = {};
  const readColours = () => {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["text", "soft", "back", "panel", "road", "mark", "bad", "link", "line"]) colours[name] = style.getPropertyValue(`--${name}`).trim();
  };
  const outline = (corners) => {
    pen.beginPath();
    for (let k = 0; k < corners.length; k += 2) pen.lineTo(corners[k], corners[k + 1]);
    pen.closePath();
  };
  const body = ([x, y, heading], length, width, fill, edge) => {
    pen.save();
    pen.translate(x, y);
    pen.rotate(heading);
    pen.fillStyle = fill;
    pen.beginPath();
    pen.roundRect(-length, -width / 2, length, width, Math.min(0.5, width / 4));
    pen.fill();
    if (edge) { pen.strokeStyle = edge; pen.lineWidth = 2.5 / scale; pen.stroke(); }
    pen.fillStyle = "rgba(255,255,255,.55)";
    pen.fillRect(-Math.min(1.6, length / 3), -width * 0.38, Math.min(0.6, length / 8), width * 0.76);
    pen.restore();
  };
  // SUMO's bits: 1 right, 2 left, which blink, and 8 brakes.
  const lamps = ([x, y, heading], length, width, signals) => {
    const blinks = Math.floor(now * 3) % 2 === 0, size = Math.min(0.7, width / 3);
    const lamp = (along, side, colour) => { pen.fillStyle = colour; pen.fillRect(along, side - size / 2, size, size); };
    pen.save();
    pen.translate(x, y);
    pen.rotate(heading);
    for (const [bit, side] of [[1, -1], [2, 1]]) {
      if (!(signals & bit) || !blinks) continue;
      for (const along of [-size, -length]) lamp(along, side * (width / 2 - size / 4), "#ffb000");
    }
    if (signals & 8) for (const side of [-1, 1]) lamp(-length, side * (width / 2 - size / 2), "#ff2d2d");
    pen.restore();
  };
  const across = (x, y, heading, reach, colour, width) => {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(x - reach * Math.sin(heading), y + reach * Math.cos(heading));
    pen.lineTo(x + reach * Math.sin(heading), y - reach * Math.cos(heading));
    pen.stroke();
  };
  const label = (x, y, text, colour, row = 0) => {
    pen.save();
    pen.translate(x, y);
    pen.scale(1 / scale, -1 / scale);
    pen.font = "12px system-ui, sans-serif";
    pen.lineWidth = 3;
    pen.strokeStyle = colours.back;
    pen.strokeText(text, 8, 4 + 15 * row);
    pen.fillStyle = colour;
    pen.fillText(text, 8, 4 + 15 * row);
    pen.restore();
  };
  const LIGHTS = { r: "#d32f2f", u: "#d32f2f", y: "#e6a700", Y: "#e6a700", g: "#2e9e4f", G: "#2e9e4f", s: "#d32f2f" };
  const STATES = { occupied: "rgba(211,47,47,.45)", "claimed by another": "rgba(230,159,0,.40)", "held by the ego": "rgba(0,114,178,.35)", free: "rgba(0,158,115,.16)" };

  const roomsNow = () => (inForce(data.rooms, now) || [0, []])[1];

  const draw = () => {
    const { step, mine, users } = scene(), ratio = devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(high * ratio)) {
      canvas.width = Math.round(wide * ratio);
      canvas.height = Math.round(high * ratio);
    }
    if (toggles.follow) centre = [mine[0], mine[1]];
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.fillStyle = colours.panel;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.setTransform(ratio * scale, 0, 0, -ratio * scale, ratio * (wide / 2 - centre[0] * scale), ratio * (high / 2 + centre[1] * scale));
    pen.fillStyle = colours.road;
    pen.strokeStyle = colours.mark;
    pen.lineWidth = 0.12;
    for (const lane of data.lanes) { outline(lane); pen.fill(); pen.stroke(); }
    for (const lane of data.inside) { outline(lane); pen.fill(); }
    if (toggles.ground) drawGround();
    if (toggles.shadows) drawShadows();
    const states = inForce(data.states, now);
    for (const [name, [state]] of Object.entries(states ? states[1] : {})) {
      if (!data.regions[name]) continue;
      pen.fillStyle = STATES[state] || STATES.free;
      outline(data.regions[name]);
      pen.fill();
    }
    for (const [line, state] of roomsNow()) {
      pen.strokeStyle = STATES[state] || STATES.free;
      pen.lineWidth = data.ego.width;
      pen.setLineDash([1.2, 0.8]);
      pen.beginPath();
      for (let k = 0; k < line.length; k += 2) pen.lineTo(line[k], line[k + 1]);
      pen.stroke();
      pen.setLineDash([]);
    }
    const curve = inForce(data.curves, now);
    if (curve) {
      pen.strokeStyle = data.colours[data.behaviours[data.ego.behaviour[step]]] || colours.link;
      pen.lineWidth = Math.max(0.25, 1.5 / scale);
      pen.beginPath();
      for (let k = 0; k < curve[1].length; k += 2) pen.lineTo(curve[1][k], curve[1][k + 1]);
      pen.stroke();
    }
    const letters = inForce(data.letters, now);
    for (const [light, index, x, y, heading, width] of letters ? data.lights : []) {
      const letter = (letters[1][light] || "")[index];
      if (letter) across(x, y, heading, width / 2, LIGHTS[letter] || colours.soft, 0.7);
    }
    for (const [user, at] of users) {
      const marked = chosen === user ? colours.link : data.ego.leader[step] === user ? colours.bad : null;
      body(at, data.users.length[user], data.users.width[user], colours.soft, marked);
      if (at[4]) lamps(at, data.users.length[user], data.users.width[user], at[4]);
      if (toggles.names || chosen === user) label(at[0], at[1], data.users.ids[user], colours.text);
    }
    body(mine, data.ego.length, data.ego.width, data.colours[data.behaviours[data.ego.behaviour[step]]] || colours.link, colours.text);
    const held = inForce(data.constraints, now);
    const rows = {};
    for (const [x, y, heading, , text] of held ? held[1] : []) {
      const place = `${x.toFixed(0)} ${y.toFixed(0)}`;
      rows[place] = 1 + (rows[place] ?? -1);
      across(x, y, heading, 3, colours.bad, Math.max(0.3, 2.5 / scale));
      label(x, y, text, colours.bad, rows[place]);
    }
    if (toggles.field) drawField(ratio, high);
    clock.textContent = `${now.toFixed(1)} s · ${mine[3].toFixed(1)} m/s · ${data.behaviours[data.ego.behaviour[step]] || ""}`;
    slider.value = now;
    tell();
  };

  // U on the ground around the ego at the last decision: clear where it is least, grey where there would be a contact.
  const drawGround = () => {
    const found = inForce(data.grounds, now);
    if (!found) return;
    const [, [x, y, heading], ahead, left, rows] = found, values = rows.flat().filter((u) => u !== null).sort((a, b) => a - b);
    const low = values[0], top = values[Math.floor(0.95 * (values.length - 1))], side = ahead.length > 1 ? ahead[1] - ahead[0] : 1;
    pen.save();
    pen.translate(x, y);
    pen.rotate(heading);
    rows.forEach((row, i) => row.forEach((u, j) => {
      const share = u === null || top <= low ? 1 : Math.min(1, (u - low) / (top - low));
      pen.fillStyle = u === null ? "rgba(90,90,90,.6)" : `hsla(${220 - 200 * share}, 80%, 50%, ${0.08 + 0.5 * share})`;
      pen.fillRect(ahead[i] - side / 2, left[j] - side / 2, side, side);
    }));
    pen.restore();
  };

  // The shadows of the others at the last decision, the denser the more each counts; they go with whom they belong to.
  const SHADOWS_S = 1;
  const drawShadows = () => {
    const found = inForce(data.shadows, now);
    if (!found || now - found[0] > SHADOWS_S) return;
    for (const [weight, corners] of found[1]) {
      pen.fillStyle = `rgba(123,80,190,${0.18 + 0.4 * Math.min(1, weight)})`;
      outline(corners);
      pen.fill();
    }
  };

  // The lattice of commands at the last decision: dark is low, the command chosen then is framed.
  const drawField = (ratio, high) => {
    const field = inForce(data.fields, now);
    if (!field) return;
    const [time, gains, rates, rows, gain, rate] = field, values = rows.flat().filter((u) => u !== null);
    const low = Math.min(...values), top = Math.max(...values), cell = 20, x0 = 56, y0 = high - 34 - cell * gains.length;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.fillStyle = colours.back;
    pen.globalAlpha = 0.88;
    pen.fillRect(8, y0 - 26, x0 + cell * rates.length + 4, cell * gains.length + 54);
    pen.globalAlpha = 1;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.fillStyle = colours.text;
    pen.fillText(`U over the commands, ${time.toFixed(1)} s`, 14, y0 - 10);
    const nearest = (list, value) => list.reduce((best, one, k) => (Math.abs(one - value) < Math.abs(list[best] - value) ? k : best), 0);
    rows.forEach((row, i) => row.forEach((u, j) => {
      const x = x0 + j * cell, y = y0 + (gains.length - 1 - i) * cell, share = u === null || top <= low ? 0 : (u - low) / (top - low);
      pen.fillStyle = u === null ? colours.line : `hsl(${210 - 170 * share} 75% ${34 + 46 * share}%)`;
      pen.fillRect(x, y, cell - 1, cell - 1);
    }));
    if (gain !== null) {
      pen.strokeStyle = colours.text;
      pen.lineWidth = 2;
      pen.strokeRect(x0 + nearest(rates, rate) * cell, y0 + (gains.length - 1 - nearest(gains, gain)) * cell, cell - 1, cell - 1);
    }
    pen.fillStyle = colours.soft;
    pen.textAlign = "right";
    gains.forEach((one, i) => pen.fillText(one.toFixed(1).replace("-0.0", "0.0"), x0 - 4, y0 + (gains.length - 1 - i) * cell + 14));
    pen.textAlign = "left";
    pen.fillText("m/s² up, rad/s across", x0 - 42, y0 + cell * gains.length + 16);
  };

  // Words: the decision in force, and whatever was decided about a road user.
  let told = null;
  const tell = () => {
    const entry = inForce(data.decisions, now);
    if (entry !== told) {
      told = entry;
      said.textContent = entry ? `${entry[0].toFixed(1)} s  ${entry[1]}` : "";
    }
  };
  const tellAbout = () => {
    about.replaceChildren();
    if (chosen === null) return;
    const name = data.users.ids[chosen], found = data.decisions.filter((entry) => entry[2].includes(name));
    const head = document.createElement("p");
    head.textContent = found.length ? `What was decided about ${name}:` : `Nothing was decided about ${name}.`;
    about.append(head);
    for (const [time, text] of found) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `${time.toFixed(1)} s  ${text}`;
      button.addEventListener("click", () => go(time));
      about.append(button);
    }
  };

  // What is said of the post-conflict regions at a place.
  const roomsAt = (x, y) => roomsNow().filter(([line]) => {
    for (let k = 0; k < line.length; k += 2) if (Math.hypot(x - line[k], y - line[k + 1]) < 1 + data.ego.width / 2) return true;
    return false;
  }).map(([, , told]) => Object.assign(document.createElement("p"), { textContent: told }));

  // Time, and the charts that show it.
  const chart = document.getElementById("plot-time");
  let marked = -1;
  const mark = () => {
    if (!chart || !chart.layout || typeof Plotly === "undefined" || Math.abs(marked - now) < 0.05) return;
    marked = now;
    const shapes = (chart.layout.shapes || []).filter((one) => one.name !== "now");
    const line = { name: "now", type: "line", xref: "x", yref: "paper", x0: now, x1: now, y0: 0, y1: 1, line: { color: "#d55e00", width: 1.5 } };
    Plotly.relayout(chart, { shapes: [...shapes, line] });
  };
  const go = (time) => { now = Math.min(end, Math.max(begin, time)); dirty = true; };
  const setPlaying = (on) => {
    playing = on;
    if (on && now >= end) go(begin);
    play.textContent = on ? "Pause" : "Play";
    dirty = true;
  };
  let sinceMark = 0;
  const FRAME_MS = 1000 / 60;
  const frame = () => {
    const at = performance.now();
    if (playing) {
      now = Math.min(end, now + Number(rate.value) * Math.min(0.25, (at - before) / 1000));
      dirty = true;
      if (now >= end) setPlaying(false);
    }
    if (dirty) {
      dirty = false;
      draw();
      root.dataset.frames = Number(root.dataset.frames || 0) + 1;
      if (at - sinceMark > 400 || !playing) { sinceMark = at; mark(); }
    }
    before = at;
    setTimeout(frame, FRAME_MS);
  };

  // Hands.
  const toggle = (name) => {
    toggles[name] = !toggles[name];
    part(name).setAttribute("aria-pressed", String(toggles[name]));
    dirty = true;
  };
  const zoom = (factor) => { scale = Math.min(60, Math.max(0.3, scale * factor)); dirty = true; };
  const jump = (way) => {
    const times = data.decisions.map((entry) => entry[0]);
    const found = way > 0 ? times.find((time) => time > now + 1e-3) : times.filter((time) => time < now - 1e-3).pop();
    if (found !== undefined) go(found);
  };
  play.addEventListener("click", () => setPlaying(!playing));
  for (const name of Object.keys(toggles)) part(name).addEventListener("click", () => toggle(name));
  part("back").addEventListener("click", () => jump(-1));
  part("on").addEventListener("click", () => jump(1));
  part("in").addEventListener("click", () => zoom(1.4));
  part("out").addEventListener("click", () => zoom(1 / 1.4));
  slider.addEventListener("input", () => { setPlaying(false); go(Number(slider.value)); });
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(-event.deltaY / 500)); }, { passive: false });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY, 0]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [dx, dy] = [event.clientX - held[0], event.clientY - held[1]];
    held = [event.clientX, event.clientY, held[2] + Math.abs(dx) + Math.abs(dy)];
    if (held[2] < 4) return;
    if (toggles.follow) toggle("follow");
    centre = [centre[0] - dx / scale, centre[1] + dy / scale];
    dirty = true;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (held && held[2] < 4) {
      const box = canvas.getBoundingClientRect();
      const x = centre[0] + (event.clientX - box.left - box.width / 2) / scale, y = centre[1] - (event.clientY - box.top - box.height / 2) / scale;
      const near = scene().users.map(([user, [ux, uy, heading]]) => {
        const half = data.users.length[user] / 2;
        return [Math.hypot(x - ux + half * Math.cos(heading), y - uy + half * Math.sin(heading)) - half, user];
      }).sort((a, b) => a[0] - b[0])[0];
      chosen = near && near[0] < Math.max(2, 12 / scale) ? near[1] : null;
      tellAbout();
      if (chosen === null) about.append(...roomsAt(x, y));
      dirty = true;
    }
    held = null;
  });
  const keys = { " ": () => setPlaying(!playing), ArrowLeft: () => go(data.times[Math.max(0, stepAt(now) - 1)]),
    ArrowRight: () => go(data.times[Math.min(last, stepAt(now) + 1)]), "+": () => zoom(1.4), "-": () => zoom(1 / 1.4),
    f: () => toggle("follow"), h: () => toggle("field"), g: () => toggle("ground"), s: () => toggle("shadows"), n: () => toggle("names"), ",": () => jump(-1), ".": () => jump(1) };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    setPlaying(event.key === " " ? playing : false);
    keys[event.key]();
  });
  if (chart && chart.on) chart.on("plotly_click", (event) => { setPlaying(false); go(event.points[0].x); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColours(); dirty = true; });
  new ResizeObserver(() => { dirty = true; }).observe(canvas);
  Object.assign(slider, { min: begin, max: end, step: "any", value: begin });
  readColours();
  for (const row of document.querySelectorAll("#decisions tbody tr")) row.addEventListener("click", () => {
    setPlaying(false);
    go(parseFloat(row.cells[0].textContent));
    canvas.scrollIntoView({ block: "nearest" });
  });
  // A run that has not ended: the page is written anew, and looked at from where it was left; at its end it moves on.
  const LEFT = `replay ${location.pathname}`, AGAIN_MS = 3000;
  const left = JSON.parse(sessionStorage.getItem(LEFT) || "null");
  sessionStorage.removeItem(LEFT);
  if (left) {
    ({ scale, centre } = left);
    rate.value = left.rate;
    for (const name of Object.keys(toggles)) if (toggles[name] !== left.toggles[name]) toggle(name);
    go(left.isLast ? end : left.now);
    setPlaying(left.playing && !left.isLast);
    scrollTo(0, left.scroll);
  } else if (data.is_under_way) go(end);
  if (data.is_under_way) setInterval(() => {
    if (document.hidden || held) return;
    const isLast = now >= end;
    sessionStorage.setItem(LEFT, JSON.stringify({ now, isLast, playing, scale, centre, toggles, rate: rate.value, scroll: scrollY }));
    location.reload();
  }, AGAIN_MS);
  if (matchMedia("(prefers-reduced-motion: no-preference)").matches && location.hash === "#play") setPlaying(true);
  root.dataset.ready = "yes";
  frame();
})();
