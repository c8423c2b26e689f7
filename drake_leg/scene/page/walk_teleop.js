// Walks the robot while keys or buttons are held, and shows what the guard makes of it.
if (live) (() => {
  "use strict";
  const { data, element } = stage;
  const tab = Math.random().toString(36).slice(2);
  const KEEP_UP = 150; // [ms] between words to the program while the robot is driven
  const WORDS = { free: "Free", near: "Careful", slowed: "Slowed", stopped: "Fallen" };
  const SIGNS = [["back", "forward"], ["right", "left"], ["turn right", "turn left"]];
  const guard = element("guard"), footing = makeFooting(data, stage);
  const held = new Map(); // key or pointer → [way, sign]
  let driving = false, halts = 0;

  function speed(way) {
    const value = Number(element(way < 2 ? "box-speed" : "box-turning").value);
    return Number.isFinite(value) && value > 0 ? Math.min(value, data.fastest[way]) : 0;
  }

  function drive() {
    const velocity = [0, 0, 0];
    for (const [way, sign] of held.values()) velocity[way] += sign * speed(way);
    driving = velocity.some((part) => part !== 0);
    live.send({ do: "drive", velocity, tab });
  }

  function forget() {
    held.clear();
    driving = false;
    markPads();
  }

  function halt() {
    forget();
    live.sendAtOnce({ do: "halt" });
  }

  // A page that does not drive leaves the robot to the one that does.
  function leave() {
    if (driving) halt();
  }

  setInterval(() => { if (driving) live.send({ do: "alive", tab }); }, KEEP_UP);

  function press(source, way, sign) {
    if (held.has(source)) return;
    held.set(source, [way, sign]);
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
    for (const { pad, way, sign } of pads) {
      pad.classList.toggle("held", now.some(([a, s]) => a === way && s === sign));
    }
  }

  function makePad(way, sign) {
    const key = data.keys[way][sign < 0 ? 0 : 1], words = SIGNS[way][sign < 0 ? 0 : 1];
    const pad = stage.makeButton(element("walk-pads"), `${key} ${words}`, () => {});
    pad.className = "pad";
    pad.setAttribute("aria-keyshortcuts", key);
    pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pad.setPointerCapture(event.pointerId);
      press("pointer " + event.pointerId, way, sign);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      pad.addEventListener(end, (event) => release("pointer " + event.pointerId));
    }
    pad.addEventListener("contextmenu", (event) => event.preventDefault());
    pads.push({ pad, way, sign });
  }
  for (const [way, sign] of [[2, 1], [0, 1], [2, -1], [1, 1], [0, -1], [1, -1]]) makePad(way, sign);

  const ways = new Map(data.keys.flatMap(([less, more], way) =>
    [[less.toLowerCase(), [way, -1]], [more.toLowerCase(), [way, 1]]]));
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
    say("lost", word, "the robot halts");
  });

  const gaits = [...document.querySelectorAll("[data-gait]")];
  for (const button of gaits) {
    button.addEventListener("click", () => live.send({ do: "gait", gait: button.dataset.gait }));
  }
  element("box-height").addEventListener("input", (event) => {
    live.send({ do: "height", height: [Number(event.target.value)] });
  });

  function say(state, word, sentence) {
    guard.dataset.state = state;
    element("guard-state").textContent = word;
    const words = element("guard-words");
    if (words.textContent !== sentence) words.textContent = sentence;
  }

  const UNITS = ["mm/s forward", "mm/s left", "°/s left"];
  const write = (number) => number.toFixed(0).replace("-", "−");
  live.onState((told) => {
    if ((told.tab && told.tab !== tab) || told.halts !== halts) forget();
    halts = told.halts;
    const others = told.tab && told.tab !== tab ? " (driven from another page)" : "";
    say(told.state, WORDS[told.state], (told.sentence || "nothing is in the way") + others);
    footing.show(told.footing);
    element("walk-limit").textContent = told.limit;
    element("walk-greatest").textContent =
      `at most ${told.greatest.map((one, way) => write(one) + (way < 2 ? " mm/s" : "°/s")).join(", ")}`;
    element("guard-share").textContent =
      told.share === null ? "at rest" : `speed ${Math.round(100 * told.share)} %`;
    element("walk-moves").textContent = told.moves.map((one, way) => `${write(one)} ${UNITS[way]}`).join(", ");
    element("walk-high").textContent = `${told.height.toFixed(0)} mm`;
    for (const button of gaits) {
      button.setAttribute("aria-pressed", button.dataset.gait === told.gait);
    }
  });
})();
