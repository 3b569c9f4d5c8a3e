// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Plots over time that share one window of time and one cursor.
'use strict';

class TimeGroup {
  constructor(begin, end) {
    this.full = end > begin ? [begin, end] : [begin, begin + 1];
    this.view = this.full.slice();
    this.cursor = null;
    this.plots = [];
    this.listeners = [];
    this.spans = [];  // of time, shaded: [{from, to, colour}]
    this.marks = [];  // of time, an upright line each
    this.pending = false;
  }
  zoom(begin, end) {
    const least = (this.full[1] - this.full[0]) * 1e-4, length = Math.max(end - begin, least);
    if (length >= this.full[1] - this.full[0]) return this.reset();
    const from = Math.min(Math.max(begin, this.full[0]), this.full[1] - length);
    this.view = [from, from + length];
    this.redraw();
  }
  scale(factor) {
    const [a, b] = this.view;
    const about = this.cursor !== null && this.cursor >= a && this.cursor <= b ? this.cursor : (a + b) / 2;
    this.zoom(about - (about - a) * factor, about + (b - about) * factor);
  }
  pan(share) {
    const by = share * (this.view[1] - this.view[0]);
    this.zoom(this.view[0] + by, this.view[1] + by);
  }
  reset() {
    this.view = this.full.slice();
    this.redraw();
  }
  /** Extends the time range; a view of the whole range stays one. */
  grow(end) {
    const whole = this.view[0] === this.full[0] && this.view[1] === this.full[1];
    this.full[1] = Math.max(this.full[1], end);
    if (whole) this.view = this.full.slice();
    this.draw();
  }
  point(t) {
    this.cursor = t === null ? null : Math.min(Math.max(t, this.full[0]), this.full[1]);
    this.tell();
  }
  tell() {
    for (const plot of this.plots) plot.showCursor();
    for (const listener of this.listeners) listener(this);
  }
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }
  draw() {
    for (const plot of this.plots) plot.draw();
    this.tell();
  }
}

/** spec: title, unit, zero (the axis holds 0), series: [{t, y, label, colour, wide, dots, band: {low, high}}]; wide: pale, seen on both sides of a line above it. */
class TimePlot {
  constructor(group, spec, parent) {
    this.group = group;
    this.spec = spec;
    const figure = parent.appendChild(document.createElement('figure'));
    figure.className = 'plot';
    this.caption = figure.appendChild(document.createElement('figcaption'));
    this.caption.textContent = spec.title + (spec.unit ? ' [' + spec.unit + ']' : '');
    this.values = spec.series.map(() => this.caption.appendChild(document.createElement('span')));
    const area = figure.appendChild(document.createElement('div'));
    area.className = 'area';
    this.canvas = area.appendChild(document.createElement('canvas'));
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', spec.title + ' over time; arrows move the cursor, plus and minus zoom, Home shows all');
    this.line = area.appendChild(document.createElement('div'));
    this.line.className = 'cursor';
    this.choice = area.appendChild(document.createElement('div'));
    this.choice.className = 'choice';
    this.listen();
    group.plots.push(this);
  }

  timeAt(x) {
    const [a, b] = this.group.view;
    return a + (b - a) * (x - this.left) / Math.max(1, this.canvas.clientWidth - this.left - 6);
  }
  xOf(t) {
    const [a, b] = this.group.view;
    return this.left + (this.canvas.clientWidth - this.left - 6) * (t - a) / (b - a);
  }

  listen() {
    const group = this.group, canvas = this.canvas;
    let from = null;
    canvas.addEventListener('pointerdown', event => {
      if (event.pointerType === 'mouse' && event.button === 0) from = event.offsetX, canvas.setPointerCapture(event.pointerId);
      group.point(this.timeAt(event.offsetX));
    });
    canvas.addEventListener('pointermove', event => {
      group.point(this.timeAt(event.offsetX));
      if (from === null) return;
      this.choice.style.display = 'block';
      this.choice.style.left = Math.min(from, event.offsetX) + 'px';
      this.choice.style.width = Math.abs(event.offsetX - from) + 'px';
    });
    const end = event => {
      this.choice.style.display = 'none';
      if (from !== null && Math.abs(event.offsetX - from) > 5 && event.type === 'pointerup') {
        const times = [this.timeAt(from), this.timeAt(event.offsetX)].sort((a, b) => a - b);
        group.zoom(times[0], times[1]);
      }
      from = null;
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
    canvas.addEventListener('dblclick', () => group.reset());
    canvas.addEventListener('keydown', event => {
      const [a, b] = group.view, now = group.cursor === null ? (a + b) / 2 : group.cursor;
      const step = event.shiftKey ? null : (b - a) / 100;
      const actions = {
        ArrowLeft: () => step === null ? group.pan(-0.2) : group.point(now - step),
        ArrowRight: () => step === null ? group.pan(0.2) : group.point(now + step),
        '+': () => group.scale(0.5), '=': () => group.scale(0.5), '-': () => group.scale(2),
        Home: () => group.reset(), Escape: () => group.point(null),
      };
      if (!actions[event.key]) return;
      event.preventDefault();
      actions[event.key]();
    });
  }

  /** Lowest and highest value in view, with some room. */
  range() {
    let low = Infinity, high = -Infinity;
    const [a, b] = this.group.view;
    for (const series of this.spec.series) {
      for (const y of series.band ? [series.y, series.band.low, series.band.high] : [series.y]) {
        for (let i = rowAt(series.t, a); i < series.t.length && series.t[i] <= b; ++i) {
          if (y[i] === null || y[i] === undefined) continue;
          low = Math.min(low, y[i]);
          high = Math.max(high, y[i]);
        }
      }
    }
    if (low > high) return [0, 1];
    if (this.spec.zero) low = Math.min(low, 0), high = Math.max(high, 0);
    if (this.spec.zero && low === high) return [0, 1];
    const room = high > low ? 0.06 * (high - low) : Math.max(1e-3, 0.1 * Math.abs(high));
    return [low - (this.spec.zero && low === 0 ? 0 : room), high + room];
  }

  draw() {
    const [context, width, height] = sized(this.canvas);
    const bottom = height - 20, [low, high] = this.range(), [a, b] = this.group.view;
    const yOf = y => bottom - (bottom - 6) * (y - low) / (high - low);
    const stepY = niceStep(high - low, 5), stepT = niceStep(b - a, Math.max(2, width / 90)), ticks = [];
    for (let y = Math.ceil(low / stepY) * stepY; y <= high; y += stepY) ticks.push(y);
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    this.left = Math.max(46, ...ticks.map(y => context.measureText(tickText(y, stepY)).width + 8));
    for (const span of this.group.spans) {
      const from = Math.max(this.left, this.xOf(span.from)), to = Math.min(width - 6, this.xOf(span.to));
      context.fillStyle = colour(span.colour);
      context.globalAlpha = 0.14;
      if (to > from) context.fillRect(from, 4, to - from, bottom - 4);
      context.globalAlpha = 1;
    }
    context.fillStyle = colour('accent');
    for (const t of this.group.marks) if (t >= a && t <= b) context.fillRect(this.xOf(t) - 1, 4, 2, bottom - 4);
    context.fillStyle = colour('soft');
    context.strokeStyle = colour('grid');
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.beginPath();
    for (const y of ticks) {
      context.moveTo(this.left, yOf(y)), context.lineTo(width - 6, yOf(y));
      context.fillText(tickText(y, stepY), this.left - 5, yOf(y));
    }
    context.textAlign = 'center';
    for (let t = Math.ceil(a / stepT) * stepT; t <= b; t += stepT) {
      context.moveTo(this.xOf(t), 4), context.lineTo(this.xOf(t), bottom);
      const text = tickText(t, Math.min(stepT, 50)) + (t + stepT > b ? ' s' : '');
      context.fillText(text, Math.min(this.xOf(t), width - 14), bottom + 11);
    }
    context.stroke();
    context.save();
    context.beginPath();
    context.rect(this.left, 0, width - this.left - 6, bottom + 1);
    context.clip();
    for (const series of this.spec.series) this.drawSeries(context, series, yOf);
    context.restore();
  }

  drawSeries(context, series, yOf) {
    const [a, b] = this.group.view, first = rowAt(series.t, a), ink = colour(series.colour);
    let last = first;
    while (last + 1 < series.t.length && series.t[last] <= b) ++last;
    if (series.band) {
      context.fillStyle = ink;
      context.globalAlpha = 0.18;
      context.beginPath();
      for (let i = first; i <= last; ++i) context.lineTo(this.xOf(series.t[i]), yOf(series.band.high[i] ?? 0));
      for (let i = last; i >= first; --i) context.lineTo(this.xOf(series.t[i]), yOf(series.band.low[i] ?? 0));
      context.fill();
      context.globalAlpha = 1;
    }
    if (series.dots) {
      context.fillStyle = ink;
      for (let i = first; i <= last; ++i) if (series.y[i] !== null) context.fillRect(this.xOf(series.t[i]) - 1, yOf(series.y[i]) - 1, 2.5, 2.5);
      return;
    }
    context.strokeStyle = ink;
    context.lineWidth = series.wide ? 6 : 1.6;
    context.globalAlpha = series.wide ? 0.5 : 1;
    context.beginPath();
    let pen = false;
    for (let i = first; i <= last; ++i) {
      if (series.y[i] === null || series.y[i] === undefined) { pen = false; continue; }
      if (pen) context.lineTo(this.xOf(series.t[i]), yOf(series.y[i]));
      else context.moveTo(this.xOf(series.t[i]), yOf(series.y[i]));
      pen = true;
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  showCursor() {
    const t = this.group.cursor, [a, b] = this.group.view, inside = t !== null && t >= a && t <= b;
    this.line.style.display = inside ? 'block' : 'none';
    if (inside) this.line.style.left = this.xOf(t) + 'px';
    this.spec.series.forEach((series, i) => {
      const value = t === null || !series.t.length ? null : series.y[rowAt(series.t, t)];
      const text = (series.label ? series.label + ' ' : '') + (t === null ? '' : valueText(value));
      if (this.values[i].textContent !== text) this.values[i].textContent = text;
      this.values[i].style.color = colour(series.colour);
    });
  }
}
