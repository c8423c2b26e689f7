// A dial for every joint.
if (live) (() => {
  "use strict";
  const { data, element } = stage;
  let values = data.dials.map(() => 0);

  const dials = data.dials.map(({ name, unit, low, high }, i) => {
    const row = live.makeRow(element("view-dials"), name, name);
    return live.makeDial(row, {
      name, label: name, unit, low, high,
      change(value, put) {
        values = values.map((old, k) => (k === i ? value : old));
        live.send({ do: "joints", values, put });
      },
    });
  });

  live.onState((told) => {
    values = told.values;
    dials.forEach((dial, i) => dial.show(told.values[i]));
  });
})();
