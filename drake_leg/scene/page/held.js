// Drives while keys or buttons are held, one page at a time. ``options`` has the keys [less, more]
// of each way, who is driven (in a sentence), ``speed(way)``, and optionally ``isFree(way)``; ``set``
// is a velocity that is wanted besides.
function makeHeld(live, stage, options) {
  "use strict";
  const KEEP_UP = 150; // [ms] between words to the program while something is driven
  const WORDS = { free: "Free", near: "Careful", slowed: "Slowed", stopped: options.stopped };
  const { element } = stage;
  const tab = Math.random().toString(36).slice(2);
  const guard = element("guard");
  const set = options.keys.map(() => 0);
  const held = new Map(); // key or pointer → [way, sign]
  const pads = [];
  let driving = false, halts = 0;

  function drive() {
    const velocity = [...set];
    for (const [way, sign] of held.values()) velocity[way] += sign * options.speed(way);
    driving = velocity.some((part) => part !== 0);
    live.send({ do: "drive", velocity, tab });
  }

  function forget() {
    set.fill(0);
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

  // The program halts when it hears nothing.
  setInterval(() => { if (driving) live.send({ do: "alive", tab }); }, KEEP_UP);

  function press(source, way, sign) {
    if (held.has(source) || !(options.isFree?.(way) ?? true)) return;
    held.set(source, [way, sign]);
    set[way] = 0;
    markPads();
    drive();
  }

  function release(source) {
    if (!held.delete(source)) return;
    markPads();
    drive();
  }

  function markPads() {
    const now = [...held.values()];
    for (const { pad, way, sign } of pads) {
      pad.classList.toggle("held", now.some(([w, s]) => w === way && s === sign));
    }
  }

  // A button that drives while it is held, by a pointer or by Enter.
  function makePad(parent, way, sign, label) {
    const pad = stage.makeButton(parent, label, () => {});
    pad.className = "pad";
    pad.setAttribute("aria-keyshortcuts", options.keys[way][sign < 0 ? 0 : 1]);
    pad.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pad.setPointerCapture(event.pointerId);
      press("pointer " + event.pointerId, way, sign);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      pad.addEventListener(end, (event) => release("pointer " + event.pointerId));
    }
    pad.addEventListener("contextmenu", (event) => event.preventDefault());
    pad.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && !event.repeat) press("key enter", way, sign);
    });
    pad.addEventListener("blur", () => release("key enter"));
    pads.push({ pad, way, sign });
    return pad;
  }

  const ways = new Map(options.keys.flatMap(([less, more], way) =>
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
    say("lost", word, `${options.driven} halts`);
  });

  function say(state, word, sentence) {
    guard.dataset.state = state;
    element("guard-state").textContent = word;
    const words = element("guard-words");
    if (words.textContent !== sentence) words.textContent = sentence;
  }

  // Shows what the guard says, and yields to another page that drives.
  function tell(told, otherwise) {
    const isOther = told.tab && told.tab !== tab;
    if (isOther || told.halts !== halts) forget();
    halts = told.halts;
    const others = isOther ? " (driven from another page)" : "";
    say(told.state, WORDS[told.state], (told.sentence || otherwise) + others);
  }

  return { drive, makePad, set, tell };
}
