// Put at the end of an animation page's script by animation_test.cc: the page works its own controls, and writes to the
// console what it found.

const selftestErrors = [];
window.addEventListener("error", (event) => selftestErrors.push(event.message));
window.addEventListener("unhandledrejection", (event) => selftestErrors.push(String(event.reason)));

const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));

async function selftest() {
  const check = (holds, what) => { if (!holds) selftestErrors.push(what); };
  const wait = async (frames) => { for (let k = 0; k < frames; ++k) await nextFrame(); };
  const key = (name, shift = false) => canvas.dispatchEvent(new KeyboardEvent("keydown", {key: name, shiftKey: shift, bubbles: true}));
  const frame = () => player.frame;
  const image = (target) => target.toDataURL();
  const last = frameCount - 1;

  await wait(3);
  check(frame() === 0 && !player.playing, "starts paused at the first frame");
  const [first, firstPlot] = [image(canvas), image(plotCanvas)];

  element("play").click();
  const started = performance.now();
  while (frame() === 0 && performance.now() - started < 5000) await nextFrame();
  check(player.playing && frame() > 0, "play moves on");
  check(element("play").getAttribute("aria-label") === "Pause", "the play button becomes a pause button");
  element("play").click();
  const paused = frame();
  await wait(5);
  check(!player.playing && frame() === paused, "pause stops");

  const middle = Math.floor(last / 2);
  element("scrub").value = middle;
  element("scrub").dispatchEvent(new Event("input"));
  await wait(2);
  check(frame() === middle, "scrubbing goes to the frame");
  check(image(canvas) !== first, "scrubbing changes the picture");
  check(image(plotCanvas) !== firstPlot, "scrubbing moves the cursor");
  check(element("time").textContent.startsWith(timeOf(middle).toFixed(scene.duration < 2 ? 3 : 2)), "the time is that of the frame");
  check(element("total").textContent === `${short(energies[2].values[middle])} J`, "the energy is that of the frame");

  for (const [name, shift, expected] of [["ArrowRight", false, middle + 1], ["Home", false, 0], ["ArrowRight", true, 10]]) {
    key(name, shift);
    check(frame() === Math.min(last, expected), `${shift ? "shift " : ""}${name} goes to frame ${expected}`);
  }
  key("Home");
  await wait(2);
  check(image(canvas) === first, "the first frame looks as before");
  key(" ");
  check(player.playing, "space plays");
  key(" ");
  check(!player.playing, "space pauses");
  key("End");
  check(frame() === last, "end goes to the end");
  element("play").click();
  check(frame() === 0 && player.playing, "play at the end starts over");
  element("speed").value = "4";
  setPlaying(true, last - 0.01);
  await wait(4);
  check(frame() === last && !player.playing, "the end stops");

  const rect = plotCanvas.getBoundingClientRect();
  scrubTo(plotFrame(plotX(middle)));
  check(frame() === middle && rect.width > 0, "the plot's places are frames");
  const fitted = view.scale;
  key("+");
  check(view.scale > fitted, "plus zooms in");
  key("0");
  check(view.scale === fitted, "zero fits");
  const [x, y] = toPage(...[scene.view[0], scene.view[1]]);
  check(x >= 0 && x <= view.width && y >= 0 && y <= view.height, "all of the scene is in view");
  check(document.documentElement.scrollWidth <= window.innerWidth, "nothing sticks out sideways");
}

(async () => {
  while (!player.frames) await nextFrame();
  await selftest();
  // What the page shows, as numbers: the test compares them with the motion.
  const poses = [0, Math.floor((frameCount - 1) / 2), frameCount - 1].map((k) => {
    player.frames.place(k);
    return scene.bodies.map((body) => body.now);
  });
  console.log(`selftest ${JSON.stringify({errors: selftestErrors, poses})}`);
})();
