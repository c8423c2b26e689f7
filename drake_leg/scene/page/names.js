// Names of the frames' axes, written over the picture: beyond an axis' end, or beside its origin
// with ⊙ (towards the reader) or ⊗ (away) where it is seen from its end. They keep off each other
// and off the axes; one for which there is no room is left out. The rules and their numbers are
// those of Placement in lettering.py, with lengths in sizes of the letters.
const makeNames = (data, pane) => {
  "use strict";
  const { axes, triads, placement: rules } = data;
  const { THREE } = MeshCat;
  const turns = rules.turns.map((turn) => turn * Math.PI / 180);
  const bearings = Array.from({ length: rules.bearings },
    (_, i) => 2 * Math.PI * i / rules.bearings);

  const letterSize = (name) => parseFloat(getComputedStyle(name).fontSize);
  const names = axes.flatMap((length, frame) => ["x", "y", "z"].map((letter, axis) => {
    const name = document.createElement("span"), mark = document.createElement("i");
    name.className = "axis-name axis-" + letter;
    name.append(mark, letter);
    name.append(Object.assign(document.createElement("sub"), { textContent: data.marks[frame] }));
    name.setAttribute("aria-hidden", "true");
    pane.append(name);
    const wide = name.offsetWidth, high = rules.high * letterSize(name);
    mark.hidden = true;
    return {
      name, mark, frame, axis, length, last: -1, endOn: false,
      half: [name.offsetWidth / 2, high / 2], halfMarked: [wide / 2, high / 2],
    };
  }));
  const size = letterSize(names[0].name); // [px]

  const canvas = viewer.renderer.domElement;
  let width = 0, height = 0; // [px], of the picture
  function seen(point) {
    const { x, y } = point.clone().project(viewer.camera);
    return [(1 + x) / 2 * width, (1 - y) / 2 * height];
  }

  // How an axis is seen.
  function look({ frame, axis, length, endOn: before }) {
    const path = triads[frame].split("/").slice(1);
    const world = viewer.scene_tree.find(path).object.matrixWorld;
    const origin = new THREE.Vector3().setFromMatrixPosition(world);
    const way = new THREE.Vector3().setFromMatrixColumn(world, axis).normalize();
    const sight = new THREE.Vector3().setFromMatrixPosition(viewer.camera.matrixWorld).sub(origin);
    const cosine = way.dot(sight.normalize());
    const sine = Math.sqrt(Math.max(0, 1 - cosine * cosine));
    const tip = origin.clone().addScaledVector(way, length);
    const start = seen(origin), end = seen(tip);
    const long = Math.hypot(end[0] - start[0], end[1] - start[1]);
    const endOn = sine < (before ? rules.no_longer_end_on : rules.end_on);
    const near = Math.min(depth(origin), depth(tip));
    const scale = height / 2 * viewer.camera.projectionMatrix.elements[5] / near; // [px/m]
    return {
      start, end, long, endOn, towards: cosine > 0,
      named: near > viewer.camera.near
        && (endOn ? length * scale >= rules.smallest * size : long >= rules.shortest * size),
    };
  }

  // How far before the camera a point is [m].
  function depth(point) {
    return -point.clone().applyMatrix4(viewer.camera.matrixWorldInverse).z;
  }

  // Places for a name, the best ones first, and what each costs.
  function places({ start, end, long, endOn }) {
    if (endOn) {
      return rules.distances.flatMap((distance) => bearings.map((bearing) => [
        start[0] + distance * size * Math.cos(bearing),
        start[1] - distance * size * Math.sin(bearing),
        distance / rules.distances[0] - 1]));
    }
    const ahead = Math.atan2(end[1] - start[1], end[0] - start[0]), first = rules.reaches[0];
    const reaches = rules.reaches.filter((reach, i) => i === 0 || reach * size < long);
    return reaches.flatMap((reach) => turns.map((turn) => [
      end[0] + reach * size * Math.cos(ahead + turn),
      end[1] + reach * size * Math.sin(ahead + turn),
      Math.abs(turn) + rules.reach_price * (reach / first - 1)]));
  }

  function cost([x, y, price], [wide, high], taken, points) {
    const inside = x >= wide && y >= high && x <= width - wide && y <= height - high;
    if (!inside || taken.some(
      ([u, v, w, h]) => Math.abs(u - x) < wide + w && Math.abs(v - y) < high + h)) return rules.on_name;
    let hidden = 0;
    for (const [u, v] of points) {
      if (Math.abs(u - x) < wide && Math.abs(v - y) < high) hidden += 1;
    }
    return price + hidden;
  }

  // Where a name has its place; null where there is none.
  function choose(entry, axis, taken, points) {
    if (axis.endOn !== entry.endOn) Object.assign(entry, { endOn: axis.endOn, last: -1 });
    const half = axis.endOn ? entry.halfMarked : entry.half;
    const options = axis.named ? places(axis) : [];
    const costs = options.map((option, i) =>
      cost(option, half, taken, points) - (i === entry.last ? rules.stay : 0));
    const least = costs.indexOf(Math.min(...costs));
    const free = costs[least] < (axis.endOn ? rules.most_end_on : rules.most);
    entry.last = free ? least : -1;
    if (!free) return null;
    const [x, y] = options[least];
    taken.push([x, y, ...half]);
    return [x, y];
  }

  function write({ name, mark }, axis, place) {
    name.hidden = place === null;
    if (place === null) return;
    mark.hidden = !axis.endOn;
    mark.className = axis.towards ? "towards" : "away";
    name.style.transform = `translate(${place[0]}px, ${place[1]}px) translate(-50%, -50%)`;
  }

  return (shown) => {
    if (!shown) { for (const { name } of names) name.hidden = true; return; }
    width = canvas.clientWidth;
    height = canvas.clientHeight;
    const lines = names.map(look);
    const points = lines.flatMap(({ start, end }) => Array.from({ length: rules.samples }, (_, i) => {
      const share = i / (rules.samples - 1);
      return [start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])];
    }));
    const taken = [], chosen = [];
    for (const endOn of [false, true]) {
      names.forEach((entry, i) => {
        if (lines[i].endOn === endOn) chosen[i] = choose(entry, lines[i], taken, points);
      });
    }
    names.forEach((entry, i) => write(entry, lines[i], chosen[i]));
  };
};
