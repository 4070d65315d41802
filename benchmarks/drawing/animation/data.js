// ---- the recorded motion: words of 16 bits, see benchmarks/drawing/animation.h

const element = (id) => document.getElementById(id);
const scene = JSON.parse(element("scene").textContent);
const frameCount = scene.frameCount;

async function inflateWords() {
  const packed = Uint8Array.from(atob(element("frames").textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const words = new Uint16Array(bytes.length / 2);
  for (let i = 0; i < words.length; ++i) words[i] = bytes[i] | (bytes[words.length + i] << 8);
  return words;
}

class Frames {
  constructor(words) {
    this.words = words;
    this.at = 0;
    for (const body of scene.bodies) {
      if (body.track) body.words = [this.track(), this.track(), this.track()];
    }
    this.forces = this.lists(scene.forces);
    this.slides = this.lists(scene.slides);
    this.cones = this.lists(scene.cones);
    this.impacts = this.lists(scene.impacts);
  }

  // Second differences, summed up in place.
  track() {
    const track = this.words.subarray(this.at, this.at += frameCount);
    let slope = 0;
    for (let k = 0, before = 0; k < frameCount; ++k) {
      slope = (slope + track[k]) & 0xffff;
      before = track[k] = (before + slope) & 0xffff;
    }
    return track;
  }

  // Lists of numbers, one list a frame: where each begins, and its columns.
  lists(columns) {
    const begins = new Uint32Array(frameCount + 1);
    for (let k = 0; k < frameCount; ++k) begins[k + 1] = begins[k] + this.words[this.at++];
    const values = columns.map(([offset, step]) => {
      const words = this.words.subarray(this.at, this.at += begins[frameCount]);
      for (let k = 1; k < frameCount; ++k) {
        const shared = Math.min(begins[k + 1] - begins[k], begins[k] - begins[k - 1]);
        for (let i = 0; i < shared; ++i) words[begins[k] + i] += words[begins[k - 1] + i];
      }
      return {words, offset, step};
    });
    return {begins, value: (column, i) => values[column].offset + values[column].step * values[column].words[i]};
  }

  // Of every body at a frame number that need not be whole: x, y, theta in body.now.
  place(frame) {
    const k = Math.min(Math.floor(frame), frameCount - 1);
    const next = Math.min(k + 1, frameCount - 1);
    const share = frame - k;
    for (const body of scene.bodies) {
      if (!body.words) {
        body.now = body.pose;
        continue;
      }
      const [x, y, theta] = body.words;
      const [x0, dx, y0, dy] = body.track;
      // The shorter way round.
      const turn = ((theta[next] - theta[k]) << 16) >> 16;
      body.now = [x0 + dx * (x[k] + share * (x[next] - x[k])), y0 + dy * (y[k] + share * (y[next] - y[k])),
                  (theta[k] + share * turn) * Math.PI / 32768];
    }
  }
}

// Three digits, as people write them.
function short(value) {
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(1).split("e");
    return `${mantissa.replace("-", "\u2212")}\u00b710${superscript(Number(exponent))}`;
  }
  return value.toFixed(Math.min(5, Math.max(0, 2 - Math.floor(Math.log10(size))))).replace("-", "\u2212");
}

// As short, of numbers that are round.
const round = (value) => short(value).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");

function superscript(exponent) {
  return String(exponent).replace(/./g, (c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[Number(c)]));
}

// 1, 2, 5 times a power of ten, <= value.
function roundDown(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return (value >= 5 * decade ? 5 : value >= 2 * decade ? 2 : 1) * decade;
}

