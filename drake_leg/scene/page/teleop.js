// Velocities of the foot, held or set, and what the guard makes of them.
if (live) (() => {
  "use strict";
  const { data, element } = stage;
  const hold = element("box-hold");

  function speed() {
    const value = Number(hold.value);
    return Number.isFinite(value) && value > 0 ? Math.min(value, data.fastest) : 0;
  }

  // By pads, keys, sliders and boxes [mm/s].
  const { drive, makePad, set, tell } = makeHeld(live, stage, {
    keys: data.keys, driven: "the foot", stopped: "Stopped", speed,
    isFree: (axis) => data.movable[axis],
  });

  function makeAxisPad(row, axis, sign, key) {
    const pad = makePad(row, axis, sign, `${sign < 0 ? "−" : "+"} ${key}`);
    pad.setAttribute("aria-label", `Hold: ${"xyz"[axis]} ${sign < 0 ? "less" : "more"}`);
    return pad;
  }

  const dials = data.keys.map(([less, more], axis) => {
    const letter = "xyz"[axis];
    const row = live.makeRow(element("drive"), letter, letter);
    makeAxisPad(row, axis, -1, less);
    const dial = live.makeDial(row, {
      name: letter, label: `Velocity along ${letter}`, unit: "mm/s",
      low: -data.fastest, high: data.fastest,
      change(value) { set[axis] = value; drive(); },
    });
    row.querySelector("input[type=range]").after(makeAxisPad(row, axis, 1, more));
    if (!data.movable[axis]) {
      row.classList.add("fixed");
      row.querySelectorAll("button, input").forEach((part) => { part.disabled = true; });
    }
    return dial;
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

  live.onState((told) => {
    const moving = told.share !== null;
    const free = moving ? "nothing is in the way" : "at rest, no singularity or limit is near";
    tell(told, free);
    element("guard-sigma").textContent = told.sigma.toFixed(2);
    element("guard-share").textContent = moving ? `speed ${Math.round(100 * told.share)} %` : "speed –";
    element("guard-level").style.width = share(told.sigma);
    material.color.setRGB(...data.ball.colours[told.state], THREE.SRGBColorSpace);
    viewer.set_dirty();
    dials.forEach((dial, axis) => dial.show(told.velocity[axis]));
  });
})();
