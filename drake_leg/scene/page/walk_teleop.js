// Walks the robot while keys or buttons are held, and shows what the guard makes of it.
if (live) (() => {
  "use strict";
  const { data, element } = stage;
  const SIGNS = [["back", "forward"], ["right", "left"], ["turn right", "turn left"]];
  const footing = makeFooting(data, stage);

  function speed(way) {
    const value = Number(element(way < 2 ? "box-speed" : "box-turning").value);
    return Number.isFinite(value) && value > 0 ? Math.min(value, data.fastest[way]) : 0;
  }

  const { makePad, tell } = makeHeld(live, stage, {
    keys: data.keys, driven: "the robot", stopped: "Fallen", speed,
  });
  for (const [way, sign] of [[2, 1], [0, 1], [2, -1], [1, 1], [0, -1], [1, -1]]) {
    const side = sign < 0 ? 0 : 1;
    makePad(element("walk-pads"), way, sign, `${data.keys[way][side]} ${SIGNS[way][side]}`);
  }

  const gaits = [...document.querySelectorAll("[data-gait]")];
  for (const button of gaits) {
    button.addEventListener("click", () => live.send({ do: "gait", gait: button.dataset.gait }));
  }
  element("box-height").addEventListener("input", (event) => {
    live.send({ do: "height", height: [Number(event.target.value)] });
  });

  const UNITS = ["mm/s forward", "mm/s left", "°/s left"];
  const write = (number) => number.toFixed(0).replace("-", "−");
  live.onState((told) => {
    tell(told, "nothing is in the way");
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
