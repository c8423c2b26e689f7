// Names of the frames' axes, written over the picture: beyond an axis' end, or beside its origin
// with ⊙ (towards the reader) or ⊗ (away) where it is seen from its end. They keep off each other
// and off the axes; one for which there is no room is left out.
const makeNames = (axes, triads, pane) => {
  "use strict";
  const END_ON = 0.3, NO_LONGER_END_ON = 0.33; // sine of an axis' angle to the line of sight
  const SHORTEST = 12, SMALLEST = 16; // [px], of an axis as it is seen; as it would be from the side
  const TURNS = [0, 40, -40, 80, -80, 120, -120].map((turn) => turn * Math.PI / 180);
  const REACHES = [11, 18, 26]; // [px], beyond an axis' end; but for the first less than its size
  const BEARINGS = Array.from({ length: 12 }, (_, i) => i * Math.PI / 6);
  const DISTANCES = [20, 28, 36]; // [px], from an origin
  const SAMPLES = 12; // points along an axis that names keep off
  const TAKEN = 100, MOST = 4, MOST_MARKED = 2; // costs: of lying on a name; beyond them it is left out
  const STAY = 0.5; // what a name is worth where it was: it jumps only for a reason
  const { THREE } = MeshCat;

  const names = axes.flatMap((length, frame) => ["x", "y", "z"].map((letter, axis) => {
    const name = document.createElement("span"), mark = document.createElement("i");
    name.className = "axis-name axis-" + letter;
    name.append(mark, letter);
    name.append(Object.assign(document.createElement("sub"), { textContent: frame }));
    name.setAttribute("aria-hidden", "true");
    pane.append(name);
    const wide = name.offsetWidth;
    mark.hidden = true;
    return {
      name, mark, frame, axis, length, last: -1, turned: false,
      half: [name.offsetWidth / 2, 7], halfMarked: [wide / 2, 7],
    };
  }));

  const canvas = viewer.renderer.domElement;
  let width = 0, height = 0; // [px], of the picture
  function seen(point) {
    const { x, y } = point.clone().project(viewer.camera);
    return [(1 + x) / 2 * width, (1 - y) / 2 * height];
  }

  // How an axis is seen.
  function look({ frame, axis, length, turned: before }) {
    const path = triads[frame].split("/").slice(1);
    const world = viewer.scene_tree.find(path).object.matrixWorld;
    const origin = new THREE.Vector3().setFromMatrixPosition(world);
    const way = new THREE.Vector3().setFromMatrixColumn(world, axis).normalize();
    const sight = new THREE.Vector3().setFromMatrixPosition(viewer.camera.matrixWorld).sub(origin);
    const cosine = way.dot(sight.normalize());
    const sine = Math.sqrt(Math.max(0, 1 - cosine * cosine));
    const tip = origin.clone().addScaledVector(way, length);
    const start = seen(origin), end = seen(tip);
    const size = Math.hypot(end[0] - start[0], end[1] - start[1]);
    const turned = sine < (before ? NO_LONGER_END_ON : END_ON);
    const near = Math.min(depth(origin), depth(tip));
    const scale = height / 2 * viewer.camera.projectionMatrix.elements[5] / near; // [px/m]
    return {
      start, end, size, turned, towards: cosine > 0,
      named: near > viewer.camera.near
        && (turned ? length * scale >= SMALLEST : size >= SHORTEST),
    };
  }

  // How far before the camera a point is [m].
  function depth(point) {
    return -point.clone().applyMatrix4(viewer.camera.matrixWorldInverse).z;
  }

  // Places for a name, the best ones first, and what each costs.
  function places({ start, end, size, turned }) {
    if (turned) {
      return DISTANCES.flatMap((distance) => BEARINGS.map((bearing) => [
        start[0] + distance * Math.cos(bearing), start[1] - distance * Math.sin(bearing),
        distance / DISTANCES[0] - 1]));
    }
    const ahead = Math.atan2(end[1] - start[1], end[0] - start[0]);
    const reaches = REACHES.filter((reach, i) => i === 0 || reach < size);
    return reaches.flatMap((reach) => TURNS.map((turn) => [
      end[0] + reach * Math.cos(ahead + turn), end[1] + reach * Math.sin(ahead + turn),
      Math.abs(turn) + 1.5 * (reach / REACHES[0] - 1)]));
  }

  function cost([x, y, price], [wide, high], taken, points) {
    const inside = x >= wide && y >= high && x <= width - wide && y <= height - high;
    if (!inside || taken.some(
      ([u, v, w, h]) => Math.abs(u - x) < wide + w && Math.abs(v - y) < high + h)) return TAKEN;
    let hidden = 0;
    for (const [u, v] of points) {
      if (Math.abs(u - x) < wide && Math.abs(v - y) < high) hidden += 1;
    }
    return price + hidden;
  }

  // Where a name has its place; null where there is none.
  function choose(entry, axis, taken, points) {
    if (axis.turned !== entry.turned) Object.assign(entry, { turned: axis.turned, last: -1 });
    const half = axis.turned ? entry.halfMarked : entry.half;
    const options = axis.named ? places(axis) : [];
    const costs = options.map((option, i) =>
      cost(option, half, taken, points) - (i === entry.last ? STAY : 0));
    const least = costs.indexOf(Math.min(...costs));
    const free = costs[least] < (axis.turned ? MOST_MARKED : MOST);
    entry.last = free ? least : -1;
    if (!free) return null;
    const [x, y] = options[least];
    taken.push([x, y, ...half]);
    return [x, y];
  }

  function write({ name, mark }, axis, place) {
    name.hidden = place === null;
    if (place === null) return;
    mark.hidden = !axis.turned;
    mark.className = axis.towards ? "towards" : "away";
    name.style.transform = `translate(${place[0]}px, ${place[1]}px) translate(-50%, -50%)`;
  }

  return (shown) => {
    if (!shown) { for (const { name } of names) name.hidden = true; return; }
    width = canvas.clientWidth;
    height = canvas.clientHeight;
    const lines = names.map(look);
    const points = lines.flatMap(({ start, end }) => Array.from({ length: SAMPLES }, (_, i) => {
      const share = i / (SAMPLES - 1);
      return [start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])];
    }));
    const taken = [], chosen = [];
    for (const turned of [false, true]) {
      names.forEach((entry, i) => {
        if (lines[i].turned === turned) chosen[i] = choose(entry, lines[i], taken, points);
      });
    }
    names.forEach((entry, i) => write(entry, lines[i], chosen[i]));
  };
};
