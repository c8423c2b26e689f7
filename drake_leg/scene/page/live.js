// What the pages of a running command share: its state, commands to it, dials.
const live = stage && (() => {
  "use strict";
  const { data, element } = stage;
  const drawTrace = makeTrace(data.pen, data.trace);
  const listeners = { state: [], lost: [] };
  let over = false, sending = false;
  let waiting = []; // commands, the latest of each kind

  async function send(command) {
    waiting = waiting.filter((other) => other.do !== command.do).concat(command);
    if (sending || over) return;
    sending = true;
    try {
      while (waiting.length) await post(waiting.shift());
    } catch {
      lose();
    } finally {
      waiting = [];
      sending = false;
    }
  }

  function post(command) {
    return fetch("/command", {
      method: "POST", headers: { "Content-Type": "application/json" }, keepalive: true,
      body: JSON.stringify(command),
    });
  }

  // Forgets what was about to be sent.
  function sendAtOnce(command) {
    waiting = [];
    send(command);
  }

  const source = new EventSource("/events");
  source.addEventListener("message", (event) => {
    const told = JSON.parse(event.data);
    if (told.session !== data.session) { location.reload(); return; }
    element("page-lost").hidden = true;
    const ends = drawTrace(told.trace);
    stage.place(told.poses, data.walk ? [] : ends); // the picture leaves old steps behind
    element("page-tip").textContent = told.tip.map(write).join(", ");
    for (const listener of listeners.state) listener(told);
  });
  source.addEventListener("error", () => lose());
  source.addEventListener("end", finish);

  function write(number) {
    return number.toFixed(1).replace("-", "−");
  }

  function lose() {
    if (over) return;
    for (const listener of listeners.lost) listener("No connection");
    element("page-lost").hidden = false;
    element("page-lost").textContent = "No connection to drake-leg; trying again. "
      + "If the command has ended in the terminal, this tab can be closed.";
  }

  function finish() {
    over = true;
    source.close();
    for (const listener of listeners.lost) listener("Ended");
    element("page-lost").hidden = true;
    element("page-over").hidden = false;
    for (const part of document.querySelectorAll("#page-panel input, #page-panel button")) {
      part.disabled = true;
    }
    element("over-words").focus();
  }

  // A slider and a box for one number; the box takes any number, the program clips it.
  function makeDial(row, { name, label, unit, low, high, change }) {
    const slider = Object.assign(document.createElement("input"), {
      type: "range", min: low, max: high, step: "any", value: 0,
    });
    const box = Object.assign(document.createElement("input"), {
      type: "number", step: "any", className: "number", id: "box-" + name, value: "0",
    });
    slider.setAttribute("aria-label", `${label} in ${unit}`);
    box.setAttribute("aria-label", `${label} in ${unit}, exactly`);
    let editing = false, touched = -Infinity, shown = 0;

    function draw() {
      if (performance.now() - touched < 250) return;
      slider.value = shown;
      slider.setAttribute("aria-valuetext", `${write(shown)} ${unit}`);
      if (!editing) box.value = String(Number(shown.toFixed(6)));
    }
    function touch() {
      touched = performance.now();
      setTimeout(draw, 260);
    }
    function take() {
      editing = false;
      const value = box.value.trim() === "" ? NaN : Number(box.value);
      if (Number.isFinite(value) && document.hasFocus()) change(value, true);
      touch();
    }
    slider.addEventListener("input", () => {
      const value = Number(Number(slider.value).toFixed(1));
      box.value = String(value);
      change(value, false);
      touch();
    });
    box.addEventListener("input", () => { editing = true; });
    box.addEventListener("change", take);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Escape") { editing = false; touched = -Infinity; draw(); }
    });
    const symbol = Object.assign(document.createElement("span"), { className: "unit" });
    symbol.textContent = unit;
    row.append(slider, box, symbol);
    return { show(value) { shown = value; draw(); } };
  }

  function makeRow(parent, text, name) {
    const row = Object.assign(document.createElement("div"), { className: "dial" });
    const label = Object.assign(document.createElement("label"), { htmlFor: "box-" + name });
    label.textContent = text;
    row.append(label);
    parent.append(row);
    return row;
  }

  element("do-quit").addEventListener("click", () => sendAtOnce({ do: "quit" }));
  element("do-start").addEventListener("click", () => sendAtOnce({ do: "start" }));
  element("do-clear").addEventListener("click", () => send({ do: "clear" }));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !stage.isTyped(event)) sendAtOnce({ do: "quit" });
  });

  return {
    send, sendAtOnce, makeDial, makeRow,
    onState: (listener) => listeners.state.push(listener),
    onLost: (listener) => listeners.lost.push(listener),
  };
})();
