// Handles over the pictures of a joint.  Python has the pictures, and the values with their places; this file moves handles.
const STYLE = `
  .sketch { position: relative; container-type: inline-size; user-select: none; -webkit-user-select: none; }
  .picture svg { display: block; width: 100%; height: auto; }
  .picture.narrow { display: none; }
  .handle { position: absolute; left: calc(var(--wide-x) + var(--dx, 0px)); top: calc(var(--wide-y) + var(--dy, 0px));
    width: 24px; height: 24px; margin: -12px 0 0 -12px; cursor: ew-resize; touch-action: none; outline: none; }
  .handle.gap { cursor: ns-resize; }
  .handle::before { content: ""; position: absolute; inset: 7px; box-sizing: border-box; border-radius: 50%;
    border: 2px solid currentColor; background: var(--panel-background-color, Canvas); }
  .handle.gap::before { inset: 9px 5px; border-radius: 3px; }
  .handle:hover::before, .handle.moving::before { background: currentColor; }
  .handle:focus-visible::before { outline: 2px solid currentColor; outline-offset: 3px; }
  .handle:focus-visible, .handle:hover, .handle.moving { z-index: 1; }
  .handle:focus-visible::after, .handle:hover::after, .handle.moving::after { content: attr(aria-label) ": " attr(aria-valuenow);
    position: absolute; bottom: 26px; padding: 1px 6px; border-radius: 4px; white-space: nowrap; font-size: 12px;
    color: var(--panel-background-color, Canvas); background: var(--panel-on-background-color, CanvasText); left: var(--side-l, auto); right: var(--side-r, auto); pointer-events: none; }
  @container (max-width: 480px) {
    .picture.wide { display: none; }
    .picture.narrow { display: block; }
    .handle { left: calc(var(--narrow-x) + var(--dx, 0px)); top: calc(var(--narrow-y) + var(--dy, 0px)); }
  }`
const WAIT = 40  // ms between two messages of one move: 25 a second, more than a picture is made
const PATIENCE = 1000  // ms for which pictures may be older than the last move: made before it, and on their way
const FACTOR = 1.05  // of a gap with an arrow key
const KEYS = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10}

const clamped = (h, v) => Math.min(h.most, Math.max(h.least, Number(v.toPrecision(h.is_gap ? 4 : 6))))
const stepped = (h, from, by) => {
  if (!h.is_gap) return clamped(h, from + by * h.step)
  return clamped(h, from > 0 ? from * FACTOR ** by : Math.round(10 * (from / h.step + by)) * h.step / 10)
}
const dragged = (h, from, by) => {  // `by`: m, or gaps as they are drawn
  if (!h.is_gap) return clamped(h, Math.round((from + by) / h.step) * h.step)
  return from > 0 ? clamped(h, from * 2 ** by) : stepped(h, from, Math.round(10 * by))
}

export function render({model, el}) {
  const make = (tag, name, on) => { const e = document.createElement(tag); e.className = name; on.append(e); return e }
  make('style', '', el).textContent = STYLE
  const root = make('div', 'sketch', el), handles = new Map()
  root.setAttribute('role', 'group')
  root.setAttribute('aria-label', 'Sketch of the joint')
  const pictures = ['wide', 'narrow'].map(name => make('div', `picture ${name}`, root))
  const size = i => pictures[i].firstElementChild.viewBox.baseVal
  const seen = () => pictures[1].offsetWidth ? 1 : 0
  const pixels = () => pictures[seen()].offsetWidth / size(seen()).width  // in a unit of the picture that is seen

  function place(h) {
    const {node} = h
    ;['wide', 'narrow'].forEach((name, i) => {
      node.style.setProperty(`--${name}-x`, `${100 * h.centres[i][0] / size(i).width}%`)
      node.style.setProperty(`--${name}-y`, `${100 * h.centres[i][1] / size(i).height}%`)
    })
    const right = h.centres[0][0] > size(0).width / 2
    node.style.setProperty('--side-l', right ? 'auto' : '0')
    node.style.setProperty('--side-r', right ? '0' : 'auto')
    node.style.setProperty('--dx', h.is_gap ? '0px' : `${(h.now - h.value) / h.reach[seen()] * pixels()}px`)
    node.style.setProperty('--dy', `${h.is_gap && h.grab ? h.grab.y : 0}px`)
    node.classList.toggle('moving', Boolean(h.grab))
    const says = {label: h.label, valuemin: h.least, valuemax: h.most, valuenow: h.now, valuetext: `${h.beam}${h.now} m`}
    for (const key in says) node.setAttribute(`aria-${key}`, says[key])
  }
  function say(h, done) {
    if (!done) { h.waits ??= setTimeout(() => { h.waits = null; model.send_msg([h.path, h.now, false]) }, WAIT); return }
    clearTimeout(h.waits)
    h.waits = null
    model.send_msg([h.path, h.now, true])
  }
  function move(h, to) {
    if (to === h.now) return
    Object.assign(h, {now: to, dirty: true, old: false})
    clearTimeout(h.settles)
    h.settles = setTimeout(() => { h.settles = null; if (h.old) adopt(h) }, PATIENCE)
    say(h, false)
  }
  function end(h) {
    h.grab = null
    if (h.dirty) say(h, true)
    h.dirty = false
    place(h)
  }
  function adopt(h) {  // take the value of the picture, unless the picture may be older than the value
    if (h.value === h.now) { /* the picture knows it */ } else if (h.grab || h.dirty || h.settles) h.old = true
    else h.now = h.value
    place(h)
  }
  function listen(h) {
    const {node} = h
    node.onpointerdown = e => {
      if (e.button || h.grab) return
      node.setPointerCapture(e.pointerId)
      h.grab = {at: h.is_gap ? e.clientY : e.clientX, from: h.now, y: 0}
      place(h)
    }
    node.onpointermove = e => {
      if (!h.grab) return
      const by = (h.is_gap ? e.clientY : e.clientX) - h.grab.at
      h.grab.y = by
      move(h, dragged(h, h.grab.from, by / pixels() * h.reach[seen()]))
      place(h)
    }
    node.onlostpointercapture = () => end(h)
    node.onkeydown = e => {
      let to = e.key in KEYS ? stepped(h, h.now, KEYS[e.key] * (e.shiftKey ? 0.1 : 1)) : null
      if (e.key === 'Home') to = h.is_gap ? 0 : h.least
      if (e.key === 'End' && !h.is_gap) to = h.most
      if (to === null || e.ctrlKey || e.altKey || e.metaKey) return
      e.preventDefault()
      move(h, to)
      place(h)
    }
    node.onkeyup = node.onblur = () => { if (!h.grab && h.dirty) end(h) }
  }
  function draw() {
    const {svg = [], handles: listed = []} = JSON.parse(model.shown)
    pictures.forEach((e, i) => { e.innerHTML = svg[i] ?? '' })
    root.querySelectorAll('svg').forEach(e => e.setAttribute('aria-hidden', 'true'))
    for (const [path, h] of handles) if (!listed.some(one => one.path === path)) { h.node.remove(); handles.delete(path) }
    for (const one of listed) {
      const h = handles.get(one.path) ?? {now: one.value, node: make('div', `handle ${one.is_gap ? 'gap' : 'along'}`, root)}
      if (!handles.has(one.path)) {
        h.node.tabIndex = 0
        h.node.setAttribute('role', 'slider')
        h.node.setAttribute('aria-orientation', one.is_gap ? 'vertical' : 'horizontal')
        handles.set(one.path, h)
        listen(h)
      }
      Object.assign(h, one)
      adopt(h)
    }
  }
  model.on('shown', draw)
  new ResizeObserver(() => handles.forEach(place)).observe(root)
  draw()
}
