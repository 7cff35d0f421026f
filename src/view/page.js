// Pan and zoom of the picture. A place of the map is shown at zoom * place + (x, y) in units of the picture; only
// transforms change, paths are never touched. Numbers stay doubles up to what is shown.

const LEAST_ZOOM = 2 ** -2;
const ZOOM_STEP = 2;
// As parts of the picture's width and height: how far an arrow key moves, and how much of the map stays in sight.
const MOVE_STEP = 1 / 8;
const IN_SIGHT = 1 / 4;
const WHEEL_PIXELS_TO_DOUBLE = 300;
const PINCH_PIXELS_TO_DOUBLE = 60;
// Pixels per unit of a wheel event, by its mode: pixels, lines or pages.
const WHEEL_PIXELS = [1, 16, 400];
// Drawing a map with longer paths takes more than a frame. Units: characters.
const LIGHT_PATHS = 100_000;
const PATH_CHARACTERS = 50;
// A heavy map is drawn again after resting this long, moving by half the picture, or zooming by a factor of two.
const REST_MILLISECONDS = 100;
const STEP_MILLISECONDS = 160;
// Browsers refuse an address that changes with every frame.
const SETTLE_MILLISECONDS = 300;
const HOME = { zoom: 1, x: 0, y: 0 };

const stage = document.querySelector('.page-stage');
const svg = stage.querySelector('svg');
const map = svg.querySelector('#map');
const { width, height } = svg.viewBox.baseVal;
// An oblique view has no world coordinates: picture coordinates replace them, and are not shown.
const isPlan = stage.dataset.unit !== undefined;
const [left, top, unit] = isPlan ? ['left', 'top', 'unit'].map((name) => Number(stage.dataset[name])) : [0, 0, 1];
const shown = Object.fromEntries([...document.querySelectorAll('[data-show]')].map((part) => [part.dataset.show, part]));
const stillness = matchMedia('(prefers-reduced-motion: reduce)');
const isHeavy = pathCharacters() > LIGHT_PATHS;
const furniture = arranged();
const drawScaleBar = scaleBar();

let view = HOME;
// The view that the step under way ends at; the next step starts there.
let goal = HOME;
// The view that the paths were drawn for, and the view that they have been moved to since.
let drawn = HOME;
let seen = null;
// From the window to the picture. Measured only when sizes change, because measuring can force a layout.
let placement = { a: 1, d: 1, e: 0, f: 0 };
// Where the mouse is, in units of the picture.
let pointer = null;
let frameIsDue = false;
let animation = 0;
let resting = 0;
let settling = 0;

// Views

function clamp(value, least, greatest) {
  return Math.min(Math.max(value, least), greatest);
}

// Browsers draw in single precision, of 24 bits: up to this zoom, corners are off by at most a quarter of a
// unit. At this zoom, a unit still spans many steps of a double at the largest coordinate.
function greatestZoom() {
  const size = Math.max(width, height);
  const farthest = Math.max(Math.abs(left), Math.abs(top), unit * size);
  return Math.max(1, Math.min(2 ** 22 / size, unit / (farthest * Number.EPSILON * 16)));
}

function kept({ zoom, x, y }) {
  const along = (offset, size) => clamp(offset, size * (IN_SIGHT - zoom), size * (1 - IN_SIGHT));
  return { zoom, x: along(x, width), y: along(y, height) };
}

function zoomed(from, factor, at) {
  const zoom = clamp(from.zoom * factor, LEAST_ZOOM, greatestZoom());
  const scale = zoom / from.zoom;
  return kept({ zoom, x: at.x - scale * (at.x - from.x), y: at.y - scale * (at.y - from.y) });
}

function moved({ zoom, x, y }, right, down) {
  return kept({ zoom, x: x + right, y: y + down });
}

// A view between two views. The zoom centre is the one place that both draw at the same place.
function between(from, to, part) {
  const zoom = from.zoom * (to.zoom / from.zoom) ** part;
  const share = from.zoom === to.zoom ? part : (zoom - from.zoom) / (to.zoom - from.zoom);
  return { zoom, x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y) };
}

function middle() {
  return { x: width / 2, y: height / 2 };
}

// World coordinates

function world(at) {
  return { x: left + unit * ((at.x - view.x) / view.zoom), y: top - unit * ((at.y - view.y) / view.zoom) };
}

function viewOf({ x, y, zoom }) {
  const within = clamp(zoom, LEAST_ZOOM, greatestZoom());
  const at = middle();
  return kept({ zoom: within, x: at.x - within * ((x - left) / unit), y: at.y - within * ((top - y) / unit) });
}

// World units of a pixel of the window.
function pixelSize() {
  return (unit / view.zoom) * placement.a;
}

// As many digits as tell places a step apart from each other, and at most as many as a double has.
function coordinateText(value, step) {
  const decimals = Math.max(0, Math.ceil(-Math.log10(step)));
  const leading = Math.floor(Math.log10(Math.abs(value) || step));
  if (decimals > 9 || leading >= 15) {
    // In an address, a plus sign would mean a space.
    return value.toExponential(clamp(leading + decimals, 0, 15)).replace('+', '');
  }
  const text = value.toFixed(Math.min(decimals, 15 - Math.max(leading, 0)));
  return Number(text) === 0 ? text.replace('-', '') : text;
}

function zoomText() {
  return String(Number(view.zoom.toPrecision(3)));
}

// The scale bar

// The greatest of 1, 2, 5, 10 ... that is not above the limit.
function roundLength(limit) {
  const reach = limit * (1 + 1e-9);
  const power = 10 ** Math.floor(Math.log10(reach));
  return [5, 2, 1].find((digit) => digit * power <= reach) * power;
}

// As in the picture: large numbers have an exponent.
function lengthText(length) {
  return length < 1e8 ? String(Number(length.toPrecision(3))) : length.toExponential(0).replace('+', '');
}

// Returns a function that redraws the scale bar for the current zoom, at most as long as it was at first.
function scaleBar() {
  const bar = furniture.querySelector('#scale path');
  const text = furniture.querySelector('#scale text');
  const [longest, ...name] = text?.textContent.trim().split(/\s+/) ?? [];
  if (!bar || !(Number(longest) > 0)) {
    return () => {};
  }
  const anchor = getComputedStyle(text).textAnchor;
  const box = bar.getBBox();
  return () => {
    const length = roundLength(Number(longest) / view.zoom);
    const drawn = (length / unit) * view.zoom;
    const start = anchor === 'end' ? box.x + box.width - drawn : box.x;
    bar.setAttribute('d', `M${start} ${box.y}v${box.height}h${drawn}v${-box.height}`);
    if (anchor === 'middle') {
      text.setAttribute('x', start + drawn / 2);
    }
    text.textContent = [lengthText(length), ...name].join(' ');
  };
}

// Drawing

function pathCharacters() {
  const paths = [...map.querySelectorAll('*')];
  return paths.reduce((sum, path) => sum + PATH_CHARACTERS + (path.getAttribute('d')?.length ?? 0), 0);
}

function draw() {
  frameIsDue = false;
  stage.classList.toggle('page-near', view.zoom > 4 * placement.a);
  if (view !== seen) {
    seen = view;
    if (isHeavy && isNearDrawn()) {
      slide();
    } else {
      render();
    }
    drawScaleBar();
  }
  tell();
}

function render() {
  clearTimeout(resting);
  drawn = view;
  svg.style.transform = '';
  map.setAttribute('transform', `matrix(${view.zoom} 0 0 ${view.zoom} ${view.x} ${view.y})`);
}

// The transform from the view that the paths are drawn for to the current view.
function slip() {
  const scale = view.zoom / drawn.zoom;
  return { scale, x: view.x - scale * drawn.x, y: view.y - scale * drawn.y };
}

function isNearDrawn() {
  const { scale, x, y } = slip();
  return scale > 1 / 2 && scale < 2 && Math.abs(x) < width / 2 && Math.abs(y) < height / 2;
}

// Moves the drawn map as a whole, which costs little.
function slide() {
  const { scale, x, y } = slip();
  svg.style.transform = `matrix(${scale}, 0, 0, ${scale}, ${x / placement.a}, ${y / placement.d})`;
  clearTimeout(resting);
  resting = setTimeout(render, REST_MILLISECONDS);
}

function tell() {
  shown.zoom.textContent = `zoom ${zoomText()}`;
  if (isPlan) {
    const at = world(pointer ?? middle());
    shown.whose.textContent = pointer ? 'pointer' : 'center';
    shown.x.textContent = `x ${coordinateText(at.x, pixelSize())}`;
    shown.y.textContent = `y ${coordinateText(at.y, pixelSize())}`;
  }
}

function requestDraw() {
  if (!frameIsDue) {
    frameIsDue = true;
    requestAnimationFrame(draw);
  }
}

function set(next) {
  view = next;
  requestDraw();
  clearTimeout(settling);
  settling = setTimeout(settle, SETTLE_MILLISECONDS);
}

function show(next) {
  cancelAnimationFrame(animation);
  goal = next;
  set(next);
}

function glide(next) {
  if (stillness.matches) {
    show(next);
    return;
  }
  const from = view;
  const start = performance.now();
  const advance = (now) => {
    const part = clamp((now - start) / STEP_MILLISECONDS, 0, 1);
    set(part < 1 ? between(from, next, part) : next);
    if (part < 1) {
      animation = requestAnimationFrame(advance);
    }
  };
  cancelAnimationFrame(animation);
  goal = next;
  animation = requestAnimationFrame(advance);
}

// The address: the middle in world coordinates, and the zoom

function settle() {
  const at = world(middle());
  const [x, y] = [at.x, at.y].map((value) => coordinateText(value, pixelSize() / 100));
  const isHome = view.zoom === 1 && view.x === 0 && view.y === 0;
  const place = `x=${x}&y=${y}&zoom=${Number(view.zoom.toPrecision(7))}`;
  history.replaceState(null, '', isHome ? location.pathname + location.search : `#${place}`);
  const [roundX, roundY] = [at.x, at.y].map((value) => coordinateText(value, pixelSize()));
  shown.status.textContent = isPlan ? `Zoom ${zoomText()}, center x ${roundX}, y ${roundY}` : `Zoom ${zoomText()}`;
}

function viewOfAddress() {
  const words = new URLSearchParams(location.hash.slice(1));
  const [x, y, zoom] = ['x', 'y', 'zoom'].map((name) => parseFloat(words.get(name)));
  return [x, y, zoom].every(Number.isFinite) ? viewOf({ x, y, zoom }) : HOME;
}

// Keys and buttons

const acts = {
  in: () => zoomed(goal, ZOOM_STEP, middle()),
  out: () => zoomed(goal, 1 / ZOOM_STEP, middle()),
  whole: () => HOME,
  left: () => moved(goal, width * MOVE_STEP, 0),
  right: () => moved(goal, -width * MOVE_STEP, 0),
  up: () => moved(goal, 0, height * MOVE_STEP),
  down: () => moved(goal, 0, -height * MOVE_STEP),
};

const keys = {
  '+': 'in',
  '=': 'in',
  '-': 'out',
  '0': 'whole',
  Home: 'whole',
  ArrowLeft: 'left',
  ArrowRight: 'right',
  ArrowUp: 'up',
  ArrowDown: 'down',
};

stage.addEventListener('keydown', (event) => {
  const act = acts[keys[event.key]];
  // With these keys they are the browser's.
  if (act && !event.ctrlKey && !event.altKey && !event.metaKey) {
    event.preventDefault();
    stage.classList.add('page-keyed');
    glide(act());
  }
});

for (const button of document.querySelectorAll('[data-act]')) {
  button.addEventListener('click', () => glide(acts[button.dataset.act]()));
}

// Mouse and fingers

const held = new Map();

function place(event) {
  return { x: event.clientX * placement.a + placement.e, y: event.clientY * placement.d + placement.f };
}

// The middle of the fingers that are down, and how far they are apart.
function grip() {
  const [first, second = first] = held.values();
  return {
    x: (first.x + second.x) / 2,
    y: (first.y + second.y) / 2,
    spread: Math.hypot(first.x - second.x, first.y - second.y),
  };
}

function drag(event) {
  const before = grip();
  held.set(event.pointerId, place(event));
  const after = grip();
  const factor = before.spread > 0 && after.spread > 0 ? after.spread / before.spread : 1;
  show(moved(zoomed(view, factor, before), after.x - before.x, after.y - before.y));
}

function release(event) {
  held.delete(event.pointerId);
}

stage.addEventListener('pointerdown', (event) => {
  if (event.button === 0 && held.size < 2) {
    stage.setPointerCapture(event.pointerId);
    stage.classList.remove('page-keyed');
    held.set(event.pointerId, place(event));
  }
});

stage.addEventListener('pointermove', (event) => {
  pointer = place(event);
  if (held.has(event.pointerId)) {
    drag(event);
  }
  requestDraw();
});

stage.addEventListener('pointerup', release);
stage.addEventListener('pointercancel', release);
stage.addEventListener('pointerleave', () => {
  pointer = null;
  requestDraw();
});

stage.addEventListener('dblclick', (event) => {
  glide(zoomed(goal, event.shiftKey ? 1 / ZOOM_STEP : ZOOM_STEP, place(event)));
});

stage.addEventListener('wheel', (event) => {
  event.preventDefault();
  const pixels = event.deltaY * WHEEL_PIXELS[event.deltaMode];
  // Touchpads report a pinch as a wheel with the control key, of small steps.
  const toDouble = event.ctrlKey ? PINCH_PIXELS_TO_DOUBLE : WHEEL_PIXELS_TO_DOUBLE;
  show(zoomed(view, 2 ** (-pixels / toDouble), place(event)));
}, { passive: false });

// Start

// Gives the furniture a layer of its own, above that of the map, and the sheet its shape.
function arranged() {
  // The stage has the title for screen readers; browsers would show it wherever the mouse rests.
  svg.querySelector(':scope > title')?.remove();
  svg.removeAttribute('role');
  const above = svg.cloneNode(false);
  above.append(svg.querySelector('#furniture') ?? '');
  svg.after(above);
  above.parentElement.style.setProperty('--aspect', width / height);
  above.parentElement.classList.toggle('page-heavy', isHeavy);
  document.querySelector('.page-bar').hidden = false;
  return above;
}

function measure() {
  // A stage that is squeezed to nothing shows nothing.
  if (stage.clientWidth > 0 && stage.clientHeight > 0) {
    placement = furniture.getScreenCTM().inverse();
    requestDraw();
  }
}

measure();
show(viewOfAddress());
new ResizeObserver(measure).observe(stage);
addEventListener('hashchange', () => show(viewOfAddress()));
// Keys work at once; the focus outline appears with the first key.
stage.focus({ focusVisible: false });
