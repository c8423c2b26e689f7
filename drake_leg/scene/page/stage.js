// The robot that Meshcat shows: where its frames are, their names, views, light and dark.
const stage = (() => {
  "use strict";
  const data = JSON.parse(document.getElementById("page-data").textContent);
  const element = (name) => document.getElementById(name);
  const pane = element("meshcat-pane");

  if (typeof viewer === "undefined") {
    const message = document.createElement("p");
    message.id = "page-message";
    message.textContent = "This page needs WebGL, which this browser lacks or has turned off.";
    document.body.append(message);
    return null;
  }

  // Column by column, as Meshcat takes it, of x, y, z [m] and the quaternion w, x, y, z.
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

  // A matrix times a vector.
  function times(matrix, [x, y, z, w]) {
    return [0, 1, 2, 3].map(
      (i) => matrix[i] * x + matrix[i + 4] * y + matrix[i + 8] * z + matrix[i + 12] * w);
  }

  // A picture goes with a robot that walks: all is moved so that its body is over the origin.
  let following = data.walk !== null;
  function shift([x, y]) {
    if (!following) return [0, 0, 0];
    const [p, q, r] = data.walk.origin, [a, b, c] = data.walk.normal;
    return [-x, -y, (a * (x - p) + b * (y - q)) / c - r];
  }

  // A level ground without an end goes with the robot by whole squares.
  function moveGround([x, y]) {
    const [u, v] = [x, y].map((part) => Math.round(part / data.walk.square) * data.walk.square);
    viewer.handle_command({
      type: "set_transform", path: data.walk.path + "/frame_0/floor",
      matrix: matrix([u, v, 0, 1, 0, 0, 0]),
    });
  }

  let present = []; // points of the robot as it is, and what else there is to hold
  let placed = null;
  function place(poses, more = []) {
    placed = [poses, more];
    const [x, y, z] = shift(poses[0]);
    if (data.walk) {
      viewer.handle_command({
        type: "set_transform", path: data.walk.path, matrix: matrix([x, y, z, 1, 0, 0, 0]),
      });
      if (data.walk.square) moveGround(poses[0]);
    }
    const matrices = poses.map(matrix);
    data.paths.forEach((path, i) => {
      viewer.handle_command({ type: "set_transform", path: path, matrix: matrices[i] });
    });
    present = data.held.flatMap((corners, i) =>
      corners.map((corner) => times(matrices[i], [...corner, 1])))
      .concat(more.map((point) => times(data.upright, [...point, 1])))
      .map(([u, v, w]) => [u + x, v + y, w + z]);
    if (view && distance(view, present) > away * (1 + 1e-9)) look(chosen);
  }

  function setVisible(paths, on) {
    for (const path of paths) {
      viewer.handle_command({ type: "set_property", path: path, property: "visible", value: on });
    }
  }

  function makeButton(parent, label, action) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.addEventListener("click", () => action(button));
    parent.append(button);
    return button;
  }

  // Views. Meshcat's camera has y up: x, y, z of the world are x, z, -y there.
  let view = null, chosen = 0;
  const seen = () => (data.walk && !following ? data.walk.whole : data);
  const buttons = data.views.map((entry, i) => {
    const button = makeButton(element("page-views"), entry.label, () => look(i));
    button.title = `Key ${i + 1}`;
    return button;
  });

  // From where a view sees all points.
  function distance(view, points) {
    const aspect = pane.offsetWidth / Math.max(pane.offsetHeight, 1);
    const scale = data.margin / Math.tan(view.field / 2);
    return Math.max(...points.map((point) => {
      const [right, up, near] = view.axes.map((axis) => axis.reduce(
        (sum, part, i) => sum + part * (point[i] - view.target[i]), 0));
      return near + scale * Math.max(Math.abs(up), Math.abs(right) / aspect);
    }));
  }

  let away = 0; // [m], of the camera
  function look(index) {
    chosen = index;
    view = { ...data.views[index], target: seen().targets[index] };
    mark();
    away = distance(view, seen().points.concat(present));
    const [x, y, z] = view.target.map((part, i) => part + away * view.axes[2][i]);
    const [u, v, w] = view.target;
    Object.assign(viewer.camera, {
      fov: view.field * 180 / Math.PI, near: away / 50, far: 4 * away, zoom: 1,
    });
    Object.assign(viewer.controls, {
      minDistance: away / 10, maxDistance: 2.5 * away, maxTargetRadius: away / 2,
    });
    viewer.controls.cursor.set(view.target[0], view.target[2], -view.target[1]);
    viewer.camera.position.set(x, z, -y);
    viewer.set_camera_target([u, w, -v]);
    viewer.controls.update();
    viewer.set_3d_pane_size();
  }

  function mark() {
    buttons.forEach((button, i) => button.setAttribute("aria-pressed", Boolean(view) && i === chosen));
  }

  viewer.controls.addEventListener("start", () => { view = null; mark(); });

  // The camera stays above the floor: never lower than what it turns around, nor that under it.
  viewer.controls.maxPolarAngle = Math.PI / 2;
  viewer.controls.addEventListener("change", () => {
    const lift = data.floor - viewer.controls.target.y;
    if (lift <= 0) return;
    viewer.controls.target.y += lift;
    viewer.camera.position.y += lift;
  });
  shareGestures(pane);

  new ResizeObserver(() => {
    if (view) look(chosen); else viewer.set_3d_pane_size();
  }).observe(pane);

  const writeNames = makeNames(data, pane);
  let named = data.framed;
  const render = viewer.render.bind(viewer);
  viewer.render = () => { render(); writeNames(named); };

  // What can be hidden.
  function makeShown(label, paths) {
    const button = makeButton(element("page-shown"), label, () => {
      const on = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", on);
      if (paths === data.triads) named = on;
      setVisible(paths, on);
    });
    button.setAttribute("aria-pressed", "true");
    return button;
  }
  const framesButton = makeShown("Frames", data.triads);
  framesButton.title =
    data.frames.map((name, place) => `${data.marks[place]} ${name}`).join(", ");
  if (!data.framed) {
    framesButton.setAttribute("aria-pressed", "false");
    setVisible(data.triads, false);
  }
  makeShown("Trace", [data.trace]);
  if (data.walk) {
    const button = makeButton(element("page-views"), "Follow", () => {
      following = !following;
      button.setAttribute("aria-pressed", following);
      if (placed) place(...placed);
      look(chosen);
    });
    button.setAttribute("aria-pressed", "true");
    button.title = "The picture goes with the robot, or holds its whole way";
  }

  // Whether a key is typed into a box, or belongs to the browser.
  function isTyped(event) {
    return event.ctrlKey || event.altKey || event.metaKey || event.isComposing
      || Boolean(event.target.closest?.("input:not([type=range]), select, textarea"));
  }

  document.addEventListener("keydown", (event) => {
    const index = "1234".indexOf(event.key);
    if (event.key.length === 1 && index >= 0 && !isTyped(event)) look(index);
  });

  function paint() {
    const style = getComputedStyle(document.documentElement);
    const read = (name) => style.getPropertyValue("--" + name).trim();
    for (const edge of ["top", "bottom"]) {
      const colour = [1, 3, 5].map((i) => parseInt(read(edge).slice(i, i + 2), 16) / 255);
      viewer.set_property(["Background", "<object>"], edge + "_color", colour);
    }
    viewer.set_property(["Lights", "AmbientLight", "<object>"], "intensity", Number(read("ambient")));
  }
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);

  viewer.gui.domElement.style.display = "none";
  paint();
  look(data.first);
  return { data, element, place, makeButton, makeShown, isTyped };
})();
