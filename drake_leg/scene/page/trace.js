// The paths of the tips: rods, the oldest of which are used again for new ones. It returns a
// function that takes what is new of the paths, and returns where the rods end.
const makeTrace = (pen, path) => {
  "use strict";
  const { most, radius, colour } = pen;
  const { THREE } = MeshCat;
  const material = new THREE.MeshLambertMaterial();
  material.color.setRGB(...colour, THREE.SRGBColorSpace);
  const rods = new THREE.InstancedMesh(new THREE.CylinderGeometry(1, 1, 1, 8), material, most);
  rods.count = 0;
  rods.frustumCulled = false;
  viewer.set_object(path.split("/").slice(1), rods);
  const up = new THREE.Vector3(0, 1, 0);
  let cleared = -1, drawn = 0, ends = [];

  function lay([u, v, w, x, y, z]) {
    const start = new THREE.Vector3(u, v, w), end = new THREE.Vector3(x, y, z);
    const way = end.clone().sub(start), length = way.length();
    const turn = new THREE.Quaternion().setFromUnitVectors(up, way.divideScalar(length));
    const place = start.add(end).multiplyScalar(0.5);
    const size = new THREE.Vector3(radius, length, radius);
    rods.setMatrixAt(drawn % most, new THREE.Matrix4().compose(place, turn, size));
    ends[drawn % most] = [x, y, z];
    drawn += 1;
  }

  return (told) => {
    if (told.cleared !== cleared) { cleared = told.cleared; drawn = 0; ends = []; }
    told.pieces.forEach(lay);
    rods.count = Math.min(drawn, most);
    rods.instanceMatrix.needsUpdate = true;
    viewer.set_dirty();
    return ends;
  };
};
