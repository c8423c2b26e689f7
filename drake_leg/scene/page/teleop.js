// Velocities of the foot, held or set, and what the guard makes of them.
if (live) (() => {
  "use strict";
  const { data, element } = stage;
  const tab = Math.random().toString(36).slice(2);
  const KEEP_UP = 150; // [ms] between words to the program while the foot is driven
  const WORDS = { free: "Free", near: "Careful", slowed: "Slowed", stopped: "Stopped" };
  const guard = element("guard"), hold = element("box-hold");
  let set = [0, 0, 0]; // [mm/s], by sliders and boxes
  const held = new Map(); // key or pointer → [axis, sign]
  let driving = false, halts = 0;

  function speed() {
    const value = Number(hold.value);
    return Number.isFinite(value) && value > 0 ? Math.min(value, data.fastest) : 0;
  }

  function wanted() {
    const velocity = [...set];
    for (const [axis, sign] of held.values()) velocity[axis] += sign * speed();
    return velocity;
  }

  function drive() {
    const velocity = wanted();
    driving = velocity.some((part) => part !== 0);
    live.send({ do: "drive", velocity, tab });
  }

  function forget() {
    set = [0, 0, 0];
    held.clear();
    driving = false;
    markPads();
  }

  function halt() {
    forget();
    live.sendAtOnce({ do: "halt" });
  }

  // A page that does not drive leaves the foot to the one that does.
  function leave() {
    if (driving) halt();
  }

  // The program halts the foot when it hears nothing.
  setInterval(() => { if (driving) live.send({ do: "alive", tab }); }, KEEP_UP);

  function press(source, axis, sign) {
    if (held.has(source) || !data.movable[axis]) return;
    held.set(source, [axis, sign]);
    set[axis] = 0;
    markPads();
    drive();
  }

  function release(source) {
    if (!held.delete(source)) return;
    markPads();
    drive();
  }

  const pads = [];
  function markPads() {
    const now = [...held.values()];
    for (const { pad, axis, sign } of pads) {
      pad.classList.toggle("held", now.some(([a, s]) => a === axis && s === sign));
    }
  }

  function makePad(row, axis, sign, key) {
    const pad = stage.makeButton(row, `${sign < 0 ? "−" : "+"} ${key}`, () => {});
    pad.className = "pad";
    pad.setAttribute("aria-label", `Hold: ${"xyz"[axis]} ${sign < 0 ? "less" : "more"}`);
    pad.setAttribute("aria-keyshortcuts", key);
    pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pad.setPointerCapture(event.pointerId);
      press("pointer " + event.pointerId, axis, sign);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      pad.addEventListener(end, (event) => release("pointer " + event.pointerId));
    }
    pad.addEventListener("contextmenu", (event) => event.preventDefault());
    pad.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && !event.repeat) press("key enter", axis, sign);
    });
    pad.addEventListener("blur", () => release("key enter"));
    pads.push({ pad, axis, sign });
    return pad;
  }

  const dials = data.keys.map(([less, more], axis) => {
    const letter = "xyz"[axis];
    const row = live.makeRow(element("drive"), letter, letter);
    makePad(row, axis, -1, less);
    const dial = live.makeDial(row, {
      name: letter, label: `Velocity along ${letter}`, unit: "mm/s",
      low: -data.fastest, high: data.fastest,
      change(value) { set[axis] = value; drive(); },
    });
    row.querySelector("input[type=range]").after(makePad(row, axis, 1, more));
    if (!data.movable[axis]) {
      row.classList.add("fixed");
      row.querySelectorAll("button, input").forEach((part) => { part.disabled = true; });
    }
    return dial;
  });

  const ways = new Map(data.keys.flatMap(([less, more], axis) =>
    [[less.toLowerCase(), [axis, -1]], [more.toLowerCase(), [axis, 1]]]));
  document.addEventListener("keydown", (event) => {
    if (stage.isTyped(event)) return;
    const key = event.key.toLowerCase();
    if (key === " ") {
      if (!event.target.closest?.("button:not(.pad)")) event.preventDefault();
      if (!event.repeat) halt();
    } else if (ways.has(key) && !event.repeat) {
      press("key " + key, ...ways.get(key));
    }
  });
  document.addEventListener("keyup", (event) => release("key " + event.key.toLowerCase()));

  element("do-halt").addEventListener("click", halt);
  element("do-start").addEventListener("click", forget);
  window.addEventListener("blur", leave);
  window.addEventListener("pagehide", leave);
  document.addEventListener("visibilitychange", () => { if (document.hidden) leave(); });
  live.onLost((word) => {
    forget();
    say("lost", word, "the foot halts");
  });

  // The ball at the foot has the color of the guard's state.
  const { THREE } = MeshCat;
  const material = new THREE.MeshLambertMaterial();
  const ball = new THREE.Mesh(new THREE.SphereGeometry(data.ball.radius, 24, 16), material);
  viewer.set_object(data.ball.path.split("/").slice(1), ball);
  if (data.region.length) stage.makeShown("Region", data.region);

  // Thin lines on a dark page are brighter.
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  function paintLines() {
    for (const [path, onLight, onDark] of data.lines) {
      const colour = new THREE.Color().setRGB(...(dark.matches ? onDark : onLight),
        THREE.SRGBColorSpace);
      viewer.set_property([...path.split("/").slice(1), "<object>"], "color",
        [...colour.toArray(), 1]);
    }
  }
  dark.addEventListener("change", paintLines);
  for (const delay of [0, 500, 2000, 8000]) setTimeout(paintLines, delay);  // objects may come late

  // The bar ends at twice the singular value at which the guard begins to slow.
  const share = (sigma) => `${Math.min(100, 50 * sigma / data.slow)}%`;
  element("guard-stop").style.left = share(data.stop);
  element("guard-slow").style.left = share(data.slow);

  function say(state, word, sentence) {
    guard.dataset.state = state;
    element("guard-state").textContent = word;
    const words = element("guard-words");
    if (words.textContent !== sentence) words.textContent = sentence;
  }

  live.onState((told) => {
    const moving = told.share !== null;
    if ((told.tab && told.tab !== tab) || told.halts !== halts) forget();
    halts = told.halts;
    const others = told.tab && told.tab !== tab ? " (driven from another page)" : "";
    const free = moving ? "nothing is in the way" : "at rest, no singularity or limit is near";
    say(told.state, WORDS[told.state], (told.sentence || free) + others);
    element("guard-sigma").textContent = told.sigma.toFixed(2);
    element("guard-share").textContent = moving ? `speed ${Math.round(100 * told.share)} %` : "speed –";
    element("guard-level").style.width = share(told.sigma);
    material.color.setRGB(...data.ball.colours[told.state], THREE.SRGBColorSpace);
    viewer.set_dirty();
    dials.forEach((dial, axis) => dial.show(told.velocity[axis]));
  });
})();
