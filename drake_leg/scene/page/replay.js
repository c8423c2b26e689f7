// Moves the robot that Meshcat shows through the poses in #replay-data.
(() => {
  "use strict";
  const data = JSON.parse(document.getElementById("replay-data").textContent);
  const element = (name) => document.getElementById("replay-" + name);
  const scrub = element("scrub"), play = element("play"), clock = element("clock");

  if (typeof viewer === "undefined") {
    const message = document.createElement("p");
    message.id = "replay-message";
    message.textContent = "This page needs WebGL, which this browser has not or has switched off.";
    document.body.append(message);
    return;
  }

  // Poses: for each moment and each frame x, y, z [m] and the quaternion w, x, y, z.
  const bytes = Uint8Array.from(atob(data.poses), (letter) => letter.charCodeAt(0));
  const poses = new Float32Array(bytes.buffer);
  const frames = data.paths.length;
  const moments = poses.length / (7 * frames);

  function between(moment, share, frame) {
    const now = 7 * (moment * frames + frame);
    const next = Math.min(moment + 1, moments - 1) * 7 * frames + 7 * frame;
    const pose = new Array(7);
    let dot = 0;
    for (let i = 3; i < 7; i++) dot += poses[now + i] * poses[next + i];
    const sign = dot < 0 ? -1 : 1;
    for (let i = 0; i < 7; i++) {
      pose[i] = (1 - share) * poses[now + i] + (i < 3 ? 1 : sign) * share * poses[next + i];
    }
    return pose;
  }

  // Column by column, as Meshcat takes it.
  function matrix([x, y, z, ...quaternion]) {
    const norm = Math.hypot(...quaternion);
    const [a, b, c, d] = quaternion.map((part) => part / norm);
    return [
      1 - 2 * (c * c + d * d), 2 * (b * c + a * d), 2 * (b * d - a * c), 0,
      2 * (b * c - a * d), 1 - 2 * (b * b + d * d), 2 * (c * d + a * b), 0,
      2 * (b * d + a * c), 2 * (c * d - a * b), 1 - 2 * (b * b + c * c), 0,
      x, y, z, 1,
    ];
  }

  let time = 0, playing = false, before = null;

  function show(moment) {
    time = Math.min(Math.max(moment, 0), data.duration);
    const place = Math.min(time * data.rate, moments - 1);
    const whole = Math.floor(place);
    data.paths.forEach((path, frame) => {
      const pose = between(whole, place - whole, frame);
      viewer.handle_command({ type: "set_transform", path: path, matrix: matrix(pose) });
    });
    scrub.value = time;
    clock.textContent = time.toFixed(2) + " of " + data.duration.toFixed(1) + " s";
  }

  function setPlaying(wanted) {
    playing = wanted && data.duration > 0;
    if (playing && time >= data.duration) show(0);
    before = null;
    play.textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    if (before !== null) show(time + ((now - before) / 1000) * Number(element("speed").value));
    before = now;
    if (time >= data.duration) setPlaying(false);
    else requestAnimationFrame(tick);
  }

  play.addEventListener("click", () => setPlaying(!playing));
  scrub.addEventListener("input", () => { setPlaying(false); show(Number(scrub.value)); });
  document.addEventListener("keydown", (event) => {
    if (event.code === "Space" && !event.target.closest("button, select")) {
      event.preventDefault();
      setPlaying(!playing);
    }
  });

  // Views. Meshcat's camera has y up: x, y, z of the world are x, z, -y there.
  let view = null;
  const buttons = data.views.map((entry) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = entry.label;
    button.addEventListener("click", () => look(entry));
    element("views").append(button);
    return button;
  });

  function look(entry) {
    view = entry;
    mark();
    const pane = document.getElementById("meshcat-pane");
    const aspect = pane.offsetWidth / Math.max(pane.offsetHeight, 1);
    const slope = Math.tan(entry.field / 2);
    const away = entry.half_depth
      + data.margin * Math.max(entry.half_height, entry.half_width / aspect) / slope;
    const [x, y, z] = entry.target.map((part, i) => part + away * entry.towards[i]);
    const [u, v, w] = entry.target;
    Object.assign(viewer.camera, {
      fov: entry.field * 180 / Math.PI, near: away / 50, far: 4 * away, zoom: 1,
    });
    viewer.camera.position.set(x, z, -y);
    viewer.set_camera_target([u, w, -v]);
    viewer.controls.update();
    viewer.set_3d_pane_size();
  }

  function mark() {
    buttons.forEach((button, i) => button.setAttribute("aria-pressed", data.views[i] === view));
  }

  viewer.controls.addEventListener("start", () => { view = null; mark(); });
  new ResizeObserver(() => { if (view) look(view); else viewer.set_3d_pane_size(); })
    .observe(document.getElementById("meshcat-pane"));

  // Names of the frames' axes, written over the picture; one that would lie on another is left out.
  const pane = document.getElementById("meshcat-pane");
  const names = data.axes.flatMap((length, frame) => ["x", "y", "z"].map((letter, axis) => {
    const name = document.createElement("span");
    name.className = "replay-name replay-" + letter;
    name.append(letter);
    name.append(Object.assign(document.createElement("sub"), { textContent: frame }));
    name.setAttribute("aria-hidden", "true");
    pane.append(name);
    return { name, frame, axis, length };
  }));
  let named = true;

  // Times a matrix, column by column.
  function times(matrix, [x, y, z, w]) {
    return [0, 1, 2, 3].map(
      (i) => matrix[i] * x + matrix[i + 4] * y + matrix[i + 8] * z + matrix[i + 12] * w);
  }

  function seen(point) {
    const { matrixWorldInverse, projectionMatrix } = viewer.camera;
    const [x, y, , w] = times(projectionMatrix.elements, times(matrixWorldInverse.elements, point));
    const canvas = viewer.renderer.domElement;
    return [(1 + x / w) / 2 * canvas.clientWidth, (1 - y / w) / 2 * canvas.clientHeight];
  }

  function writeNames() {
    const taken = [];
    for (const { name, frame, axis, length } of names) {
      const path = data.shown.Frames[frame].split("/").slice(1);
      const world = viewer.scene_tree.find(path).object.matrixWorld.elements;
      const start = seen(times(world, [0, 0, 0, 1]));
      const end = seen(times(world, [0, 1, 2].map((i) => (i === axis ? length : 0)).concat(1)));
      const way = Math.hypot(end[0] - start[0], end[1] - start[1]);
      const [x, y] = end.map((part, i) => part + 11 * (part - start[i]) / way);
      const free = way > 14 && taken.every(([u, v]) => Math.abs(u - x) > 15 || Math.abs(v - y) > 13);
      name.hidden = !named || !free;
      if (!free) continue;
      taken.push([x, y]);
      name.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    }
  }

  const render = viewer.render.bind(viewer);
  viewer.render = () => { render(); writeNames(); };

  // What can be hidden.
  for (const [label, paths] of Object.entries(data.shown)) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", on);
      if (label === "Frames") named = on;
      for (const path of paths) {
        viewer.handle_command({ type: "set_property", path: path, property: "visible", value: on });
      }
    });
    element("shown").append(button);
  }

  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  function paint() {
    const style = getComputedStyle(document.documentElement);
    for (const edge of ["top", "bottom"]) {
      const hex = style.getPropertyValue("--" + edge).trim().slice(1);
      const colour = [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
      viewer.set_property(["Background", "<object>"], edge + "_color", colour);
    }
  }
  dark.addEventListener("change", paint);

  viewer.gui.domElement.style.display = "none";
  paint();
  show(0);
  look(data.views[data.first]);
})();
