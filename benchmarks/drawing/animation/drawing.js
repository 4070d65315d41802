// ---- the bodies

// Bodies smaller than this are drawn with one edge colour, smaller ones than the second without edges [px].
const kFewEdges = 9;
const kNoEdges = 2.5;
const kImpactFade = 8;  // [frames]

const canvas = element("stage");
const context = canvas.getContext("2d");
const view = {scale: 1, x: 0, y: 0, zoom: 1, width: 0, height: 0, ratio: 1};

for (const body of scene.bodies) {
  if (body.fill !== undefined) {
    body.fillPath = new Path2D(body.fill);
    body.edgePaths = body.edges.map(([color, path]) => [color, new Path2D(path)]);
  }
}
for (const link of scene.connectors) {
  if (link.path) link.pathShape = new Path2D(link.path);
}

function hatching([ground, stripe]) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = 16;
  const pen = tile.getContext("2d");
  pen.fillStyle = ground;
  pen.fillRect(0, 0, 16, 16);
  pen.strokeStyle = stripe;
  pen.lineWidth = 3;
  pen.stroke(new Path2D("M-20 20L4 -4M-4 20L20 -4M12 20L36 -4"));
  return context.createPattern(tile, "repeat");
}
const patterns = {fixed: hatching(scene.colors.fixed), driven: hatching(scene.colors.driven)};

function fitView() {
  const [left, bottom, right, top] = scene.view;
  const margin = 0.04 * Math.max(right - left, top - bottom, scene.bodySize) + 0.3 * scene.bodySize;
  view.fit = Math.min(view.width / (right - left + 2 * margin), view.height / (top - bottom + 2 * margin));
  view.x = (left + right) / 2;
  view.y = (bottom + top) / 2;
  view.zoom = 1;
  view.scale = view.fit;
}

function resizeCanvas(target) {
  const ratio = window.devicePixelRatio || 1;
  const {width, height} = target.getBoundingClientRect();
  target.width = Math.max(1, Math.round(width * ratio));
  target.height = Math.max(1, Math.round(height * ratio));
  return {width, height, ratio};
}

const toPage = (x, y) => [view.width / 2 + (x - view.x) * view.scale, view.height / 2 - (y - view.y) * view.scale];

function pagePoint(body, [px, py]) {
  const [x, y, theta] = body.now;
  const c = Math.cos(theta);
  const s = Math.sin(theta);
  return toPage(x + c * px - s * py, y + s * px + c * py);
}

// Path units of the body frame to pixels.
function bodyTransform(body, unit) {
  const [x, y, theta] = body.now;
  const [px, py] = toPage(x, y);
  const k = view.ratio * view.scale / unit;
  const c = k * Math.cos(theta);
  const s = k * Math.sin(theta);
  context.setTransform(c, -s, -s, -c, view.ratio * px, view.ratio * py);
  return view.scale / unit;
}
const pageTransform = () => context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);

function drawBody(body) {
  if (body.unit === undefined) {
    if (body.kind === "movable") drawPointMass(body);
    return;
  }
  const size = 2 * body.radius * view.scale;
  const [px, py] = toPage(body.now[0], body.now[1]);
  const reach = size / 2 + 4;
  if (px < -reach || px > view.width + reach || py < -reach || py > view.height + reach) return;
  const scale = bodyTransform(body, body.unit);
  if (body.kind === "movable") {
    context.fillStyle = size < kNoEdges ? "#7d8791" : scene.colors.body;
  } else {
    patterns[body.kind].setTransform(new DOMMatrix().scale(0.5 / scale));
    context.fillStyle = patterns[body.kind];
  }
  context.fill(body.fillPath, "evenodd");
  if (size < kNoEdges) return;
  context.lineWidth = Math.min(1.8, Math.max(0.5, 0.045 * size)) / scale;
  const edges = size < kFewEdges ? body.edgePaths.slice(0, 1) : body.edgePaths;
  for (const [color, path] of edges) {
    context.strokeStyle = color;
    context.stroke(path);
  }
  // Where a disc's centre of mass is, and how far it has turned.
  if (body.kind === "movable" && size > 14) {
    const arm = Math.min(6, 0.12 * size) / scale;
    context.beginPath();
    context.moveTo(-0.4 * arm, 0);
    context.lineTo(arm, 0);
    context.moveTo(0, -0.4 * arm);
    context.lineTo(0, 0.4 * arm);
    context.strokeStyle = "#7d8791";
    context.lineWidth = 1 / scale;
    context.stroke();
  }
}

function drawPointMass(body) {
  pageTransform();
  disc(toPage(body.now[0], body.now[1]), 4, scene.colors.body, "#7d8791", 1);
}

function disc([x, y], radius, fill, stroke, width, square = false) {
  context.beginPath();
  if (square) context.rect(x - radius, y - radius, 2 * radius, 2 * radius);
  else context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.strokeStyle = stroke;
  context.lineWidth = width;
  context.stroke();
}

// ---- what holds them, as benchmarks/drawing/drawn_scene.cc draws it

const strokeOf = (half) => Math.min(1.5, Math.max(0.5, 0.3 * half));
const pin = (at, radius, square) => disc(at, radius, "#fff", scene.colors.ink, strokeOf(radius), square);

function drawPath(link) {
  const scale = bodyTransform(scene.bodies[link.b], link.unit);
  context.setLineDash([6 / scale, 3 / scale, 1 / scale, 3 / scale]);
  context.lineWidth = 1 / scale;
  context.strokeStyle = scene.colors.soft;
  context.stroke(link.pathShape);
  context.setLineDash([]);
}

function drawConnector(link) {
  const half = Math.min(6, Math.max(1.2, 0.09 * scene.bodySize * view.scale));
  if (link.path) drawPath(link);
  const a = pagePoint(scene.bodies[link.a], link.p);
  const b = link.path ? a : pagePoint(scene.bodies[link.b], link.q);
  pageTransform();
  if (link.path || link.type === "pin") {
    pin([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], Math.max(1.2, 0.8 * half), Boolean(link.path));
    return;
  }
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const span = Math.hypot(dx, dy) || 1;
  let [ax, ay] = [-dy * half / span, dx * half / span];  // across
  const [x0, y0] = [a[0] + 1.3 * link.side * ax, a[1] + 1.3 * link.side * ay];
  if (link.type === "rope") {
    const slack = Math.min(link.length * view.scale - span, span);
    [ax, ay] = [0, slack > 1e-3 * span ? Math.sqrt(0.375 * span * slack) : 0];
  }
  const line = new Path2D();
  for (const [along, across, down] of scene.symbols[link.type]) {
    const point = [x0 + along * dx + across * ax, y0 + along * dy + across * ay];
    if (down) line.lineTo(...point);
    else line.moveTo(...point);
  }
  const stroke = (color, width) => {
    context.strokeStyle = color;
    context.lineWidth = width;
    context.stroke(line);
  };
  if (link.type !== "rod") {
    stroke(scene.colors.ink, strokeOf(half));
    return;
  }
  stroke(scene.colors.ink, 1.2 * half);
  stroke("#fff", 1.2 * half - Math.min(1.6, 0.6 * half));
  pin(a, 0.6 * half);
  pin(b, 0.6 * half);
}

// ---- what acts between them

function drawForces({begins, value}, frame, color) {
  const k = Math.min(Math.round(frame), frameCount - 1);
  const width = Math.min(2.2, Math.max(0.8, 0.05 * scene.bodySize * view.scale));
  const longest = scene.longestArrow * view.scale;
  const shafts = new Path2D();
  const heads = new Path2D();
  for (let i = begins[k]; i < begins[k + 1]; ++i) {
    const [x, y] = toPage(value(0, i), value(1, i));
    let dx = value(2, i) * scene.arrowPerNewton * view.scale;
    let dy = -value(3, i) * scene.arrowPerNewton * view.scale;
    const length = Math.hypot(dx, dy);
    if (length < 1) continue;
    const cut = Math.min(1, longest / length);
    dx *= cut;
    dy *= cut;
    const head = Math.min(4 * width, 0.6 * length * cut) / (length * cut);
    const [nx, ny] = [x + (1 - head) * dx, y + (1 - head) * dy];
    shafts.moveTo(x, y);
    shafts.lineTo(nx, ny);
    heads.moveTo(x + dx, y + dy);
    heads.lineTo(nx - 0.45 * head * dy, ny + 0.45 * head * dx);
    heads.lineTo(nx + 0.45 * head * dy, ny - 0.45 * head * dx);
    heads.closePath();
  }
  pageTransform();
  context.strokeStyle = context.fillStyle = color;
  context.lineWidth = width;
  context.stroke(shafts);
  context.fill(heads);
}

// Edges come in pairs, from the contact to where the cone is as high as its normal force.
function drawCones({begins, value}, frame) {
  const k = Math.min(Math.round(frame), frameCount - 1);
  const longest = scene.longestArrow * view.scale;
  const cones = new Path2D();
  for (let i = begins[k]; i < begins[k + 1]; i += 2) {
    const [x, y] = toPage(value(0, i), value(1, i));
    const edges = [i, i + 1].map((j) => [value(2, j), -value(3, j)].map((part) => part * scene.arrowPerNewton * view.scale));
    const cut = Math.min(1, longest / Math.hypot(...edges[0]));
    cones.moveTo(x + cut * edges[0][0], y + cut * edges[0][1]);
    cones.lineTo(x, y);
    cones.lineTo(x + cut * edges[1][0], y + cut * edges[1][1]);
    cones.closePath();
  }
  pageTransform();
  context.fillStyle = `${scene.colors.cone}2e`;
  context.strokeStyle = scene.colors.cone;
  context.lineWidth = 0.8;
  context.fill(cones);
  context.stroke(cones);
}

// Rings that grow with the square root of the impulse, and fade.
function drawImpacts(frames, frame) {
  const {begins, value} = frames.impacts;
  const now = Math.min(Math.round(frame), frameCount - 1);
  pageTransform();
  context.strokeStyle = scene.colors.force;
  for (let k = Math.max(0, now - kImpactFade + 1); k <= now; ++k) {
    context.globalAlpha = 1 - (now - k) / kImpactFade;
    context.lineWidth = 1.5;
    context.beginPath();
    for (let i = begins[k]; i < begins[k + 1]; ++i) {
      const [x, y] = toPage(value(0, i), value(1, i));
      const radius = 2 + 0.5 * scene.bodySize * view.scale * Math.sqrt(Math.hypot(value(2, i), value(3, i)) / scene.largestImpulse);
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.stroke();
  }
  context.globalAlpha = 1;
}

function drawScale() {
  const length = roundDown(110 / view.scale);
  const width = length * view.scale;
  const y = view.height - 14;
  const text = `${round(length)} m`;
  context.font = "12px Helvetica, Arial, sans-serif";
  context.fillStyle = "rgba(255,255,255,.85)";
  context.fillRect(8, y - 9, width + context.measureText(text).width + 16, 18);
  context.strokeStyle = context.fillStyle = scene.colors.ink;
  context.lineWidth = 1.4;
  context.stroke(new Path2D(`M12 ${y - 4}v8m0 -4h${width}m0 -4v8`));
  context.fillText(text, 18 + width, y + 4);
}

function drawStage(frames, frame, withForces) {
  pageTransform();
  context.clearRect(0, 0, view.width, view.height);
  context.lineJoin = context.lineCap = "round";
  frames.place(frame);
  for (const movable of [false, true]) {
    for (const body of scene.bodies) {
      if ((body.kind === "movable") === movable) drawBody(body);
    }
  }
  for (const link of scene.connectors) drawConnector(link);
  context.lineCap = "butt";
  if (withForces) {
    drawCones(frames.cones, frame);
    drawForces(frames.forces, frame, scene.colors.force);
    drawForces(frames.slides, frame, scene.colors.slide);
    drawImpacts(frames, frame);
  }
  drawScale();
}

