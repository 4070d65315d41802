// ---- controls

const kPlay = "M3 1.5v13l11-6.5z";
const kPause = "M3 2h3.6v12H3zM9.4 2H13v12H9.4z";

const player = {frames: null, frame: 0, playing: false, last: 0, dirty: true};
const withForces = () => element("show-forces").checked;

function show() {
  player.dirty = false;
  drawStage(player.frames, player.frame, withForces());
  drawPlot(player.frame);
  const whole = Math.round(player.frame);
  element("scrub").value = whole;
  const text = `${timeOf(player.frame).toFixed(scene.duration < 2 ? 3 : 2)} s`;
  element("scrub").setAttribute("aria-valuetext", text);
  element("time").textContent = `${text} of ${short(scene.duration)} s`;
}

function tick(now) {
  if (player.playing) {
    // A page that was hidden goes on where it stopped.
    const elapsed = Math.min(0.25, Math.max(0, (now - player.last) / 1000));
    player.frame += elapsed * scene.fps * Number(element("speed").value);
    if (player.frame >= frameCount - 1) {
      if (element("loop").checked && frameCount > 1) player.frame %= frameCount - 1;
      else setPlaying(false, frameCount - 1);
    }
    player.dirty = true;
  }
  player.last = now;
  if (player.dirty) show();
  requestAnimationFrame(tick);
}

function setPlaying(playing, frame) {
  if (frame !== undefined) player.frame = Math.min(frameCount - 1, Math.max(0, frame));
  else if (playing && player.frame >= frameCount - 1) player.frame = 0;
  player.playing = playing;
  player.dirty = true;
  element("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  element("play-icon").setAttribute("d", playing ? kPause : kPlay);
}

const scrubTo = (frame) => setPlaying(false, frame);

function zoomBy(factor, x = view.width / 2, y = view.height / 2) {
  const zoom = Math.min(1e4, Math.max(0.25, view.zoom * factor));
  const ratio = zoom / view.zoom;
  // The point under the pointer stays.
  view.x += (x - view.width / 2) / view.scale * (1 - 1 / ratio);
  view.y -= (y - view.height / 2) / view.scale * (1 - 1 / ratio);
  view.zoom = zoom;
  view.scale = view.fit * zoom;
  canvas.style.touchAction = zoom > 1 ? "none" : "pan-y";
  player.dirty = true;
}

function fit() {
  fitView();
  canvas.style.touchAction = "pan-y";
  player.dirty = true;
}

function changeSpeed(step) {
  const speed = element("speed");
  speed.selectedIndex = Math.min(speed.options.length - 1, Math.max(0, speed.selectedIndex + step));
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
  const onButton = ["BUTTON", "INPUT"].includes(event.target.tagName) && event.target.id !== "scrub";
  const whole = Math.round(player.frame);
  const step = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => setPlaying(!player.playing), ArrowLeft: () => scrubTo(whole - step), ArrowRight: () => scrubTo(whole + step),
    Home: () => scrubTo(0), End: () => scrubTo(frameCount - 1), ArrowUp: () => changeSpeed(1), ArrowDown: () => changeSpeed(-1),
    "+": () => zoomBy(1.25), "=": () => zoomBy(1.25), "-": () => zoomBy(0.8), 0: fit,
    f: () => { element("show-forces").checked = !withForces(); player.dirty = true; },
  };
  // A focused button has its own use for the space bar.
  const action = event.key === " " && onButton ? null : actions[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}

function listenToPointers() {
  const pointers = new Map();
  const position = (event) => [event.offsetX, event.offsetY];
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return {x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, size: Math.hypot(a[0] - b[0], a[1] - b[1]) || 1};
  };
  canvas.addEventListener("pointerdown", (event) => pointers.set(event.pointerId, position(event)));
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = position(event);
    if (pointers.size === 2) {
      const old = spread();
      pointers.set(event.pointerId, now);
      const next = spread();
      zoomBy(next.size / old.size, next.x, next.y);
    } else {
      pointers.set(event.pointerId, now);
      view.x -= (now[0] - before[0]) / view.scale;
      view.y += (now[1] - before[1]) / view.scale;
      player.dirty = true;
    }
  });
  for (const type of ["pointerup", "pointercancel", "pointerleave"]) {
    canvas.addEventListener(type, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomBy(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
  }, {passive: false});
  plotCanvas.addEventListener("pointerdown", (event) => {
    plotCanvas.setPointerCapture(event.pointerId);
    scrubTo(plotFrame(event.offsetX));
  });
  plotCanvas.addEventListener("pointermove", (event) => {
    if (event.buttons) scrubTo(plotFrame(event.offsetX));
  });
}

function writeLegend() {
  element("legend").innerHTML = scene.legend.map(([width, symbol, text]) =>
    `<li><svg width="${width}" height="14" viewBox="0 -7 ${width} 14">${symbol}</svg>${text}</li>`).join("");
}

function writeCaption() {
  const movable = scene.bodies.filter((body) => body.kind === "movable").length;
  const {steps, solves, failedSolves, impacts, worstPenetration} = scene.statistics;
  const parts = [`${movable} movable ${movable === 1 ? "body" : "bodies"}`, scene.caption];
  if (steps > 0) parts.push(`${steps} steps, ${solves} LCPs${failedSolves > 0 ? ` (${failedSolves} not solved)` : ""}, ${impacts} impacts, deepest penetration ${short(worstPenetration)} m`);
  element("caption").textContent = parts.filter(Boolean).join(" \u00b7 ");
  if (scene.stopped) notice(`The motion stopped at ${short(scene.duration)} s: ${scene.stopped}`);
}

function notice(text) {
  element("notice").textContent = text;
  element("notice").hidden = false;
}

function resize() {
  const keep = view.zoom !== 1 ? {x: view.x, y: view.y, zoom: view.zoom} : null;
  Object.assign(view, resizeCanvas(canvas));
  fitView();
  if (keep) Object.assign(view, keep, {scale: view.fit * keep.zoom});
  preparePlot();
  // At once: a canvas that changes its size is empty.
  show();
}

async function start() {
  writeCaption();
  if (!("DecompressionStream" in window)) {
    notice("This page needs a browser of 2023 or later (DecompressionStream).");
    return;
  }
  player.frames = new Frames(await inflateWords());
  writeLegend();
  element("scrub").max = frameCount - 1;
  element("play").addEventListener("click", () => setPlaying(!player.playing));
  element("scrub").addEventListener("input", () => scrubTo(Number(element("scrub").value)));
  element("show-forces").addEventListener("change", () => { player.dirty = true; });
  element("zoom-in").addEventListener("click", () => zoomBy(1.5));
  element("zoom-out").addEventListener("click", () => zoomBy(1 / 1.5));
  element("fit").addEventListener("click", fit);
  document.addEventListener("keydown", onKey);
  listenToPointers();
  new ResizeObserver(resize).observe(element("stage-box"));
  resize();
  // "#t=1.5" opens the page at a time.
  const time = /^#t=([\d.]+)$/.exec(location.hash);
  scrubTo(time ? Math.round(Number(time[1]) * scene.fps) : 0);
  requestAnimationFrame(tick);
}

start().catch((error) => {
  notice(`This page cannot be shown: ${error.message}`);
  throw error;
});
