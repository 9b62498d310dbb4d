"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const colours = ["#D55E00", "#0072B2"];
  const by = (id) => document.getElementById(id);
  for (const [id, names] of [["channel", data.channels], ["quantity", data.quantities]])
    for (const key of Object.keys(names)) by(id).add(new Option(names[key].label || key, key));
  let plot = null;

  function sorted(channel, quantity) {
    const order = quantity.values.map((x, i) => i).filter((i) => quantity.values[i] !== null);
    order.sort((i, k) => quantity.values[i] - quantity.values[k] || i - k);
    return order;
  }

  function band(channel) {
    return (u) => {
      if (!channel.sd) return;
      const top = u.valToPos(2 * channel.sd, "y", true), bottom = u.valToPos(-2 * channel.sd, "y", true);
      u.ctx.fillStyle = "#eeeeee";
      u.ctx.fillRect(u.bbox.left, top, u.bbox.width, bottom - top);
    };
  }

  function nearest(u, order, words, unit) {
    const { left, top } = u.cursor;
    if (left === undefined || left < 0) return;
    let best = 400, said = "";
    order.forEach((row, i) => words.forEach((word, s) => {
      const y = u.data[s + 1][i];
      if (y === null) return;
      const dx = u.valToPos(u.data[0][i], "x") - left, dy = u.valToPos(y, "y") - top;
      if (dx * dx + dy * dy >= best) return;
      best = dx * dx + dy * dy;
      said = `Row ${data.row[row]}, test ${data.test[row]}: ${y} ${unit}, ${word}.`;
    }));
    if (said) by("near").textContent = said;
  }

  function draw() {
    const channel = data.channels[by("channel").value], quantity = data.quantities[by("quantity").value];
    const order = sorted(channel, quantity), words = Object.keys(channel.left);
    const columns = words.map((word) => order.map((i) => channel.left[word][i]));
    const series = words.map((word, i) => ({
      label: word, stroke: colours[i], paths: () => null,
      points: { show: true, size: 6, width: 1.5, fill: i ? colours[i] : "#ffffff" },
    }));
    const label = quantity.unit ? `${quantity.label} [${quantity.unit}]` : quantity.label;
    const options = {
      width: by("plot").clientWidth, height: 340,
      scales: { x: { time: false, range: (u, low, high) => [low - 0.03 * (high - low || 1), high + 0.03 * (high - low || 1)] } },
      axes: [{ label }, { label: `measured - simulated [${channel.unit}]` }],
      series: [{ label: quantity.label }, ...series],
      legend: { live: false },
      cursor: { points: { show: false } },
      hooks: { drawClear: [band(channel)], setCursor: [(u) => nearest(u, order, words, channel.unit)] },
    };
    if (plot) plot.destroy();
    plot = new uPlot(options, [order.map((i) => quantity.values[i]), ...columns], by("canvas"));
  }

  by("plot").style.display = "block";
  by("channel").onchange = by("quantity").onchange = draw;
  window.addEventListener("resize", draw);
  draw();
})();
