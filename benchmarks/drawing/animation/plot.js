// ---- energies over time

const plotCanvas = element("plot");
const plotContext = plotCanvas.getContext("2d");
const plot = {left: 62, right: 8, top: 8, bottom: 22, width: 0, height: 0, ratio: 1, picture: null};
const lowestPotential = scene.energy.potential.reduce((a, b) => Math.min(a, b), Infinity);
const energies = [
  {id: "kinetic", color: "#0072B2", dash: [], width: 2, values: scene.energy.kinetic},
  {id: "potential", color: "#009E73", dash: [7, 4], width: 2, values: scene.energy.potential.map((e) => e - lowestPotential)},
];
energies.push({id: "total", color: "#222222", dash: [], width: 1.5,
               values: energies[0].values.map((e, k) => e + energies[1].values[k])});
const timeOf = (frame) => Math.min(frame / scene.fps, scene.duration);
const highestEnergy = energies[2].values.reduce((a, b) => Math.max(a, b), 0) || 1;

const plotX = (frame) => plot.left + (plot.width - plot.left - plot.right) * frame / Math.max(1, frameCount - 1);
const plotY = (energy) => plot.height - plot.bottom - (plot.height - plot.top - plot.bottom) * energy / (1.05 * highestEnergy);
const plotFrame = (x) => Math.round((frameCount - 1) * Math.min(1, Math.max(0, (x - plot.left) / (plot.width - plot.left - plot.right))));

function ticks(largest, count) {
  const step = roundDown(largest / count) * (largest / count / roundDown(largest / count) > 1.99 ? 2 : 1);
  const values = [];
  for (let k = 0; k * step <= largest * (1 + 1e-9); ++k) values.push(k * step);
  return values;
}

// Once per size: the curves do not change.
function preparePlot() {
  Object.assign(plot, resizeCanvas(plotCanvas));
  plot.picture = document.createElement("canvas");
  plot.picture.width = plotCanvas.width;
  plot.picture.height = plotCanvas.height;
  const pen = plot.picture.getContext("2d");
  pen.setTransform(plot.ratio, 0, 0, plot.ratio, 0, 0);
  pen.font = "12px Helvetica, Arial, sans-serif";
  pen.fillStyle = "#555";
  pen.strokeStyle = "#e3e6ea";
  pen.textAlign = "right";
  for (const energy of ticks(highestEnergy, 4)) {
    const y = Math.round(plotY(energy)) + 0.5;
    pen.stroke(new Path2D(`M${plot.left} ${y}H${plot.width - plot.right}`));
    pen.fillText(energy === 0 ? "0 J" : round(energy), plot.left - 6, y + 4);
  }
  const duration = timeOf(frameCount - 1);
  for (const time of duration > 0 ? ticks(duration, plot.width < 500 ? 4 : 8) : [0]) {
    const x = plotX(time * scene.fps);
    pen.stroke(new Path2D(`M${x} ${plot.top}V${plot.height - plot.bottom + 3}`));
    pen.textAlign = x > plot.width - 24 ? "right" : "center";
    pen.fillText(`${round(time)} s`, Math.min(x, plot.width), plot.height - 6);
  }
  for (const {color, dash, width, values} of energies) {
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.beginPath();
    values.forEach((energy, k) => pen.lineTo(plotX(k), plotY(energy)));
    pen.stroke();
  }
}

function drawPlot(frame) {
  plotContext.setTransform(1, 0, 0, 1, 0, 0);
  plotContext.clearRect(0, 0, plotCanvas.width, plotCanvas.height);
  plotContext.drawImage(plot.picture, 0, 0);
  plotContext.setTransform(plot.ratio, 0, 0, plot.ratio, 0, 0);
  const x = plotX(frame);
  plotContext.strokeStyle = "#D55E00";
  plotContext.lineWidth = 1.5;
  plotContext.stroke(new Path2D(`M${x} ${plot.top}V${plot.height - plot.bottom}`));
  const k = Math.min(Math.round(frame), frameCount - 1);
  for (const {id, color, values} of energies) {
    plotContext.fillStyle = color;
    plotContext.beginPath();
    plotContext.arc(x, plotY(values[k]), 3.5, 0, 2 * Math.PI);
    plotContext.fill();
    element(id).textContent = `${short(values[k])} J`;
  }
  const change = energies[2].values[k] - energies[2].values[0];
  // Differences below the digits of what they are taken from are not a change.
  const size = highestEnergy + Math.abs(lowestPotential);
  element("change").textContent = Math.abs(change) < 1e-14 * size ? "0 J" : `${change > 0 ? "+" : ""}${short(change)} J`;
}

