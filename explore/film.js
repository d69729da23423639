// The film of a cycle.  Python has the places of beams and stops in each frame; this file shows one frame after another.
const STYLE = `
  .film svg { display: block; width: 100%; height: auto; }
  .film path { fill: none; stroke: currentColor; stroke-width: 1.5px; vector-effect: non-scaling-stroke; stroke-linejoin: round; }
  .film .rest { stroke-dasharray: 4 4; opacity: 0.5; stroke-width: 1px; }
  .film .beam { stroke: color-mix(in srgb, #0072b2 75%, currentColor); stroke-width: 4px; }
  .film .lit path { stroke: #d55e00; stroke-width: 2px; }
  .film .face { stroke-width: 2.5px; }
  .film .lit .face { stroke-width: 7px; }
  .controls { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 12px; font-variant-numeric: tabular-nums; }
  .controls button { font: inherit; color: inherit; background: none; border: 1px solid; border-radius: 4px; min-width: 4.5em;
    min-height: 32px; cursor: pointer; }
  .controls input { flex: 1 1 120px; min-width: 0; height: 24px; accent-color: #0072b2; }
  .controls :focus-visible { outline: 2px solid currentColor; outline-offset: 2px; }`
const LASTS = 4000  // ms for which a film runs: an impact is seen to come, and to go
const FACE = 'M-20 0H20', STEM = 'M0 0V-12', GROUND = 'M-18 -12H18M-14 -12l6 -7M-4 -12l6 -7M6 -12l6 -7'

export function render({model, el}) {
  const make = (tag, at, on) => {
    const e = document.createElementNS(on.namespaceURI === SVG || tag === 'svg' ? SVG : HTML, tag)
    for (const key in at) e.setAttribute(key, at[key])
    on.append(e)
    return e
  }
  make('style', {}, el).textContent = STYLE
  const root = make('div', {class: 'film', role: 'group', 'aria-label': 'Film of the cycle'}, el)
  const svg = make('svg', {role: 'img'}, root), controls = make('div', {class: 'controls'}, root)
  const button = make('button', {type: 'button'}, controls)
  const range = make('input', {type: 'range', min: 0, step: 1, 'aria-label': 'Time in the cycle'}, controls)
  const time = make('span', {}, controls), scale = make('span', {}, controls)
  let scene = null, parts = null, at = 0, since = 0, frame = 0
  let runs = !matchMedia('(prefers-reduced-motion: reduce)').matches

  function draw() {
    parts.beams.forEach((e, j) => e.setAttribute('d', 'M' + scene.x[j].map((x, i) => `${x} ${scene.y[j][at][i]}`).join('L')))
    parts.stops.forEach((e, k) => {
      const [x, up] = scene.stops[k]
      e.setAttribute('transform', `translate(${x} ${scene.faces[at][k]}) scale(1 ${up})`)
      e.classList.toggle('lit', scene.lit[at][k])
    })
    range.value = at
    range.setAttribute('aria-valuetext', scene.labels[at])
    time.textContent = `t = ${scene.labels[at]}`
  }
  function tick(now) {
    const next = Math.floor((now - since) / LASTS * scene.times.length) % scene.times.length
    if (next >= 0 && next !== at) { at = next; draw() }
    frame = requestAnimationFrame(tick)
  }
  function roll() {  // one film at a time, and none while it stands still
    cancelAnimationFrame(frame)
    if (runs && scene && !model.rests)
      frame = requestAnimationFrame(now => { since = now - (at + 0.5) / scene.times.length * LASTS; tick(now) })
  }
  function run(on) {
    runs = on
    button.textContent = runs ? 'Pause' : 'Play'
    if (!scene) return
    model.time = runs ? null : scene.times[at]
    roll()
  }
  function show() {
    const had = scene
    scene = JSON.parse(model.shown)
    root.hidden = !scene
    if (!scene) return
    at = Math.min(at, scene.times.length - 1)
    svg.replaceChildren()
    svg.setAttribute('viewBox', `0 0 ${scene.size.join(' ')}`)
    svg.setAttribute('aria-label', scene.said)
    for (const [left, right, y] of scene.rest) make('path', {class: 'rest', d: `M${left} ${y}H${right}`}, svg)
    const stops = scene.stops.map(([, , ground], k) => {
      const e = make('g', {}, svg)
      make('title', {}, e).textContent = scene.names[k]
      make('path', {d: STEM + (ground ? GROUND : '')}, e)
      make('path', {class: 'face', d: FACE}, e)
      return e
    })
    parts = {stops, beams: scene.rest.map(() => make('path', {class: 'beam'}, svg))}
    range.max = scene.times.length - 1
    scale.textContent = `displacements × ${scene.exaggeration}`
    draw()
    if (!had || !runs) run(runs)
  }
  button.onclick = () => run(!runs)
  range.oninput = () => { at = Number(range.value); if (runs) run(false); else model.time = scene.times[at]; draw() }
  model.on('rests', roll)
  model.on('shown', show)
  model.on('remove', () => { runs = false; roll() })
  show()
}
const SVG = 'http://www.w3.org/2000/svg', HTML = 'http://www.w3.org/1999/xhtml'
