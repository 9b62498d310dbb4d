"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const place = document.getElementById("plot");
  const shown = (u, v) => (v === null ? "" : v.toPrecision(4));
  const series = data.series.map((s) => ({
    label: s.label, stroke: s.stroke, width: 1.5, dash: s.dashed ? [6, 4] : [], value: shown,
  }));
  const width = () => Math.max(280, place.clientWidth);
  const plot = new uPlot({
    width: width(), height: 460, scales: { x: { time: false } },
    axes: [{ label: data.x.label }, { label: data.y }],
    series: [{ label: data.x.label, value: shown }, ...series],
  }, [data.x.values, ...data.series.map((s) => s.values)], place);
  window.addEventListener("resize", () => plot.setSize({ width: width(), height: 460 }));
})();
