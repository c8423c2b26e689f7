// What a walking robot stands on: arrows of the forces on its feet, the support on the ground with
// the projected center of mass, and the traces of its feet. A row is as overlay_rows writes it.
const makeFooting = (data, stage) => {
  "use strict";
  const pen = data.footing, legs = pen.legs;
  const { THREE } = MeshCat;
  const root = `${data.walk.path}/frame_0`;
  const up = new THREE.Vector3(0, 1, 0), normal = new THREE.Vector3(...data.walk.normal);
  const hidden = new THREE.Matrix4().makeScale(0, 0, 0);

  function colour(material, parts) {
    material.color.setRGB(...parts, THREE.SRGBColorSpace);
    return material;
  }

  function put(name, object) {
    object.frustumCulled = false;
    viewer.set_object(`${root}/${name}`.split("/").slice(1), object);
    return object;
  }

  function solids(name, geometry, parts, count) {
    const material = colour(new THREE.MeshLambertMaterial(), parts);
    return put(name, new THREE.InstancedMesh(geometry, material, count));
  }

  // A solid of height 1 around y, laid from one point to another.
  function lay(solid, index, start, end, radius) {
    const way = end.clone().sub(start), length = way.length();
    if (length < 1e-6) { solid.setMatrixAt(index, hidden); return; }
    const turn = new THREE.Quaternion().setFromUnitVectors(up, way.divideScalar(length));
    const middle = start.clone().add(end).multiplyScalar(0.5);
    const size = new THREE.Vector3(radius, length, radius);
    solid.setMatrixAt(index, new THREE.Matrix4().compose(middle, turn, size));
  }

  // Arrows are seen through the legs.
  function onTop(solid) {
    Object.assign(solid.material, { depthTest: false, transparent: true });
    solid.renderOrder = 1;
    return solid;
  }

  const rod = () => new THREE.CylinderGeometry(1, 1, 1, 12);
  const shafts = onTop(solids("forces/shafts", rod(), pen.force, legs));
  const heads = onTop(solids("forces/heads", new THREE.ConeGeometry(1, 1, 20), pen.force, legs));
  const edges = solids("support/edges", rod(), pen.support, legs);
  const thread = solids("support/thread", rod(), pen.centre, 1);
  // The mark of the center of mass is seen through the body, dark with a light rim.
  const mark = onTop(solids("support/mark", new THREE.SphereGeometry(1, 20, 12), [1, 1, 1], 2));
  mark.setColorAt(0, new THREE.Color(1, 1, 1));
  mark.setColorAt(1, new THREE.Color().setRGB(...pen.centre, THREE.SRGBColorSpace));
  const corners = new Float32Array(9 * Math.max(legs - 2, 1));
  const face = new THREE.BufferGeometry();
  face.setAttribute("position", new THREE.BufferAttribute(corners, 3));
  const area = put("support/area", new THREE.Mesh(face, new THREE.MeshBasicMaterial({
    transparent: true, opacity: 0.3, side: THREE.DoubleSide, depthWrite: false,
  })));

  function showForces(feet, arrows) {
    feet.forEach((foot, i) => {
      const length = arrows[i].length(), long = Math.min(pen.head[1], 0.6 * length);
      const end = foot.clone().add(arrows[i]);
      const neck = length > 0 ? end.clone().addScaledVector(arrows[i], -long / length) : end;
      lay(shafts, i, foot, neck, pen.shaft);
      lay(heads, i, neck, end, pen.head[0] * long / pen.head[1]);
    });
  }

  function showSupport(around, centre, below, safe) {
    const lifted = around.map((foot) => foot.clone().addScaledVector(normal, pen.over));
    for (let i = 0; i < legs; i++) {
      const both = lifted.length > 1 && i < lifted.length;
      const start = both ? lifted[i] : below;
      lay(edges, i, start, both ? lifted[(i + 1) % lifted.length] : start, pen.edge);
    }
    corners.fill(0);
    for (let i = 1; i + 1 < lifted.length; i++) {
      [lifted[0], lifted[i], lifted[i + 1]].forEach((point, k) =>
        corners.set([point.x, point.y, point.z], 9 * (i - 1) + 3 * k));
    }
    face.setDrawRange(0, 3 * Math.max(lifted.length - 2, 0));
    face.attributes.position.needsUpdate = true;
    for (const one of [area, edges]) colour(one.material, safe ? pen.support : pen.falling);
    lay(thread, 0, below, centre, pen.thread);
    [1.35 * pen.mark, pen.mark].forEach((radius, i) => {
      const place = new THREE.Matrix4().makeTranslation(below.x, below.y, below.z);
      mark.setMatrixAt(i, place.scale(new THREE.Vector3(radius, radius, radius)));
    });
  }

  const readout = stage.element("walk-margin");
  function show(row) {
    const points = Array.from({ length: 2 * legs + 2 }, (_, i) =>
      new THREE.Vector3(...row.slice(3 * i, 3 * i + 3)));
    const margin = row[6 * legs + 6];
    const around = [...row.slice(6 * legs + 7)].filter((foot) => foot >= 0);
    showForces(points.slice(0, legs), points.slice(legs, 2 * legs));
    showSupport(around.map((foot) => points[foot]), points[2 * legs], points[2 * legs + 1],
      margin >= 0);
    readout.textContent = margin < -100 ? "no foot is loaded"
      : `support margin ${(1000 * margin).toFixed(0).replace("-", "−")} mm`;
    for (const one of [shafts, heads, edges, thread, mark]) one.instanceMatrix.needsUpdate = true;
    viewer.set_dirty();
  }

  stage.makeShown("Forces", [`${root}/forces`]);
  stage.makeShown("Support", [`${root}/support`]);
  return { show };
};

// The rows of a replay, and the traces of its feet until now.
const makeWalked = (data, stage) => {
  "use strict";
  const { THREE } = MeshCat;
  const footing = makeFooting(data, stage), { legs, rows } = data.footing;
  const bytes = Uint8Array.from(atob(rows), (letter) => letter.charCodeAt(0));
  const numbers = new Float32Array(bytes.buffer), wide = 7 * legs + 7;
  const moments = numbers.length / wide;
  const row = (moment) => numbers.subarray(moment * wide, (moment + 1) * wide);

  const material = new THREE.MeshLambertMaterial();
  material.color.setRGB(...data.pen.colour, THREE.SRGBColorSpace);
  const rods = new THREE.InstancedMesh(
    new THREE.CylinderGeometry(1, 1, 1, 8), material, Math.max(legs * (moments - 1), 1));
  rods.frustumCulled = false;
  viewer.set_object([...data.trace.split("/").slice(1), "feet"], rods);
  const up = new THREE.Vector3(0, 1, 0);
  for (let moment = 0; moment + 1 < moments; moment++) {
    for (let leg = 0; leg < legs; leg++) {
      const [start, end] = [moment, moment + 1].map((one) =>
        new THREE.Vector3(...row(one).slice(3 * leg, 3 * leg + 3)));
      const way = end.clone().sub(start), length = way.length();
      const turn = length > 0
        ? new THREE.Quaternion().setFromUnitVectors(up, way.divideScalar(length))
        : new THREE.Quaternion();
      const thick = length > 0 ? data.pen.radius : 0;
      rods.setMatrixAt(moment * legs + leg, new THREE.Matrix4().compose(
        start.add(end).multiplyScalar(0.5), turn, new THREE.Vector3(thick, length, thick)));
    }
  }

  return (moment, share) => {
    const now = row(moment), next = row(Math.min(moment + 1, moments - 1));
    const nearest = share < 0.5 ? now : next, smooth = 6 * legs + 6;
    footing.show(nearest.map((part, i) =>
      (i < smooth ? (1 - share) * now[i] + share * next[i] : part)));
    rods.count = moment * legs;
  };
};
