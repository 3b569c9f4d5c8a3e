// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Paths and points in space on a canvas, from any direction: z is up, orthographic, so that lengths are comparable.
'use strict';

/** From small to large errors, distinguishable by brightness as well. */
const kErrorColours = [[42, 120, 190], [66, 168, 150], [214, 184, 60], [226, 120, 46], [190, 30, 60]];

const errorColour = share => 'rgb(' + mixed(kErrorColours, share).join(',') + ')';

/**
 * paths: [{x, y, z, colour, dash, width, shade: values, shadeMax}], points: [{xyz: flat, colour, size}], marks: [{p, colour, size}], links: [{from, to}],
 * clouds: [{xyz: flat, tones, own: tones are greys, not heights}], of voxels with edge_m and axes, the directions of their edges.
 */
class SpaceView {
  constructor(canvas) {
    this.canvas = canvas;
    this.paths = [];
    this.points = [];
    this.marks = [];
    this.links = [];
    this.clouds = [];
    this.image = new CloudImage();
    this.full_ms = 0;  // of the last drawing with all points
    this.home();
    this.listen();
  }

  home() {
    this.turn = -0.9;  // [rad] about the world's z
    this.tilt = 0.6;   // [rad], 0 from the side, pi/2 from above
    this.zoom = 1;
    this.shift = [0, 0];
  }

  /** The bounding box of the paths, and if requested of most points, without far outliers. */
  fit(withPoints) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const hold = (k, values) => values.forEach(value => {
      if (value !== null) low[k] = Math.min(low[k], value), high[k] = Math.max(high[k], value);
    });
    for (const path of this.paths) ['x', 'y', 'z'].forEach((axis, k) => hold(k, path[axis]));
    for (const cloud of withPoints ? [...this.points, ...this.clouds] : []) {
      for (let k = 0; k < 3; ++k) {
        const sorted = sortedSample(cloud.xyz, k, 4000);
        if (sorted.length) hold(k, [quantile(sorted, 0.05), quantile(sorted, 0.95)]);
      }
    }
    this.empty = low[0] > high[0];
    this.centre = low.map((value, k) => this.empty ? 0 : (value + high[k]) / 2);
    this.floor = this.empty ? 0 : low[2];
    this.radius = this.empty ? 1 : Math.max(0.02, 0.5 * Math.hypot(...low.map((value, k) => high[k] - value)));
  }

  project(x, y, z) {
    const dx = x - this.centre[0], dy = y - this.centre[1], dz = z - this.centre[2];
    const right = this.cosTurn * dx + this.sinTurn * dy, away = -this.sinTurn * dx + this.cosTurn * dy;
    return [this.middle[0] + this.scale * right, this.middle[1] - this.scale * (this.cosTilt * dz + this.sinTilt * away)];
  }

  /** quick: with fewer points where all take too long; all follow when the view rests. */
  draw(quick) {
    clearTimeout(this.rest);
    const every = quick ? Math.max(1, Math.ceil(this.full_ms / kRenderGoal_ms)) : 1;
    if (every > 1) this.rest = setTimeout(() => this.draw(), 200);
    const [context, width, height] = sized(this.canvas);
    this.cosTurn = Math.cos(this.turn), this.sinTurn = Math.sin(this.turn);
    this.cosTilt = Math.cos(this.tilt), this.sinTilt = Math.sin(this.tilt);
    this.scale = this.zoom * 0.45 * Math.min(width, height) / this.radius;
    this.middle = [width / 2 + this.shift[0], height / 2 + this.shift[1]];
    context.font = '12px system-ui, "DejaVu Sans", sans-serif';
    context.lineJoin = 'round';
    if (this.empty) {
      context.fillStyle = colour('soft');
      context.fillText('no pose was estimated', 16, 28);
      return;
    }
    this.drawFloor(context);
    this.drawClouds(context, width, height, every);
    for (const cloud of this.points) this.drawPoints(context, cloud);
    this.drawLinks(context);
    for (const path of this.paths) this.drawPath(context, path);
    for (const mark of this.marks) this.drawMark(context, mark);
    this.drawAxes(context, height);
  }

  drawFloor(context) {
    const step = niceStep(2 * this.radius / Math.max(1, this.zoom), 6), n = 4;
    const [cx, cy] = this.centre.map(value => Math.round(value / step) * step);
    context.strokeStyle = colour('grid');
    context.lineWidth = 1;
    context.beginPath();
    for (let i = -n; i <= n; ++i) {
      context.moveTo(...this.project(cx + i * step, cy - n * step, this.floor));
      context.lineTo(...this.project(cx + i * step, cy + n * step, this.floor));
      context.moveTo(...this.project(cx - n * step, cy + i * step, this.floor));
      context.lineTo(...this.project(cx + n * step, cy + i * step, this.floor));
    }
    context.stroke();
    context.fillStyle = colour('soft');
    context.fillText('squares of ' + tickText(step, step) + ' m', 12, 20);
  }

  /** Right, up and towards the viewer: the part of a direction of the world in each. */
  inView(x, y, z) {
    const away = -this.sinTurn * x + this.cosTurn * y;
    return [this.cosTurn * x + this.sinTurn * y, this.cosTilt * z + this.sinTilt * away, this.sinTilt * z - this.cosTilt * away];
  }

  drawClouds(context, width, height, every) {
    if (!this.clouds.length || !this.canvas.width || !this.canvas.height) return;  // a canvas off the page has no size
    const begin = performance.now(), ratio = this.canvas.width / width, scale = this.scale * ratio, image = this.image;
    const axes = [this.inView(1, 0, 0), this.inView(0, 1, 0), this.inView(0, 0, 1)], centre = this.inView(...this.centre);
    // Of pixels of the screen: columns, rows downwards, nearness.
    const view = [scale, -scale, scale].map((factor, k) => [...axes.map(axis => factor * axis[k]), -factor * centre[k]]);
    view[0][3] += ratio * this.middle[0];
    view[1][3] += ratio * this.middle[1];
    image.clear(this.canvas.width, this.canvas.height);
    for (const cloud of this.clouds) {
      const colours = cloud.own ? greyColours() : kHeightColours;
      if (cloud.edge_m) {
        const edges = [0, 3, 6].map(i => this.inView(cloud.axes[i], cloud.axes[i + 1], cloud.axes[i + 2]));
        image.cubes(cloud, view, cubeSprite(scale * cloud.edge_m, edges), kSides.map(side => inksOf(colours, side)), every);
      } else {
        image.points(cloud, view, Math.max(1, Math.round(1.5 * ratio)), inksOf(colours, 1), every);
      }
    }
    context.drawImage(image.finished(), 0, 0, width, height);
    if (every === 1) this.full_ms = performance.now() - begin;
  }

  drawPoints(context, cloud) {
    context.fillStyle = colour(cloud.colour);
    context.globalAlpha = cloud.alpha || 1;
    for (let i = 0; i + 2 < cloud.xyz.length; i += 3) {
      if (cloud.xyz[i] === null) continue;
      const [x, y] = this.project(cloud.xyz[i], cloud.xyz[i + 1], cloud.xyz[i + 2]);
      context.fillRect(x - cloud.size / 2, y - cloud.size / 2, cloud.size, cloud.size);
    }
    context.globalAlpha = 1;
  }

  /** Shaded paths are drawn shade by shade: a stroke per segment would be slow. */
  drawPath(context, path) {
    const kShades = 16, strokes = new Map();
    let before = null;
    for (let i = 0; i < path.x.length; ++i) {
      const now = path.x[i] === null ? null : this.project(path.x[i], path.y[i], path.z[i]);
      if (now && before) {
        const share = path.shade && path.shade[i] !== null ? path.shade[i] / path.shadeMax : null;
        const key = share === null ? -1 : Math.min(kShades - 1, Math.floor(share * kShades));
        if (!strokes.has(key)) strokes.set(key, new Path2D());
        strokes.get(key).moveTo(...before);
        strokes.get(key).lineTo(...now);
      }
      before = now;
    }
    context.lineWidth = path.width || 2;
    context.lineCap = path.dash ? 'butt' : 'round';
    for (const [key, stroke] of strokes) {
      context.strokeStyle = key < 0 ? colour(path.colour) : errorColour((key + 0.5) / kShades);
      context.stroke(stroke);
    }
  }

  drawLinks(context) {
    context.strokeStyle = colour('accent');
    context.globalAlpha = 0.5;
    context.lineWidth = 1;
    context.beginPath();
    for (const link of this.links) {
      context.moveTo(...this.project(...link.from));
      context.lineTo(...this.project(...link.to));
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  drawMark(context, mark) {
    if (!mark.p || mark.p[0] === null || mark.p[0] === undefined) return;
    const [x, y] = this.project(...mark.p);
    context.beginPath();
    context.arc(x, y, mark.size, 0, 2 * Math.PI);
    context.fillStyle = colour(mark.colour);
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = colour('card');
    context.stroke();
  }

  drawAxes(context, height) {
    const at = [44, height - 40], length = 26;
    context.lineWidth = 2;
    context.textAlign = 'center';
    [['x', 1, 0, 0, 'run5'], ['y', 0, 1, 0, 'run2'], ['z', 0, 0, 1, 'run0']].forEach(([name, x, y, z, ink]) => {
      const u = this.cosTurn * x + this.sinTurn * y;
      const v = this.cosTilt * z + this.sinTilt * (-this.sinTurn * x + this.cosTurn * y);
      context.strokeStyle = context.fillStyle = colour(ink);
      context.beginPath();
      context.moveTo(...at);
      context.lineTo(at[0] + length * u, at[1] - length * v);
      context.stroke();
      context.fillText(name, at[0] + (length + 9) * u, at[1] - (length + 9) * v + 4);
    });
    context.textAlign = 'left';
  }

  rotate(dx, dy) {
    this.turn -= 0.008 * dx;
    this.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.tilt + 0.008 * dy));
    this.draw(true);
  }
  magnify(factor) {
    this.zoom = Math.min(200, Math.max(0.2, this.zoom * factor));
    this.draw(true);
  }
  move(dx, dy) {
    this.shift = [this.shift[0] + dx, this.shift[1] + dy];
    this.draw(true);
  }

  listen() {
    const canvas = this.canvas, fingers = new Map();
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    });
    canvas.addEventListener('pointermove', event => {
      const was = fingers.get(event.pointerId);
      if (!was) return;
      const now = [event.offsetX, event.offsetY], dx = now[0] - was[0], dy = now[1] - was[1];
      const others = [...fingers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
      fingers.set(event.pointerId, now);
      if (others.length > 0) {
        const far = p => Math.max(8, Math.hypot(p[0] - others[0][0], p[1] - others[0][1]));
        this.move(dx / 2, dy / 2);
        this.magnify(far(now) / far(was));
      } else if (event.shiftKey || event.buttons === 2) {
        this.move(dx, dy);
      } else {
        this.rotate(dx, dy);
      }
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => fingers.delete(event.pointerId));
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('dblclick', () => { this.home(); this.draw(); });
    // The wheel belongs to the page until someone has clicked here.
    canvas.addEventListener('wheel', event => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      this.magnify(Math.exp(-0.0015 * event.deltaY));
    }, {passive: false});
    canvas.addEventListener('keydown', event => {
      const by = event.shiftKey ? (dx, dy) => this.move(dx, dy) : (dx, dy) => this.rotate(dx, dy);
      const actions = {
        ArrowLeft: () => by(-15, 0), ArrowRight: () => by(15, 0), ArrowUp: () => by(0, -15), ArrowDown: () => by(0, 15),
        '+': () => this.magnify(1.25), '=': () => this.magnify(1.25), '-': () => this.magnify(0.8),
        Home: () => { this.home(); this.draw(); }, t: () => { this.turn = 0; this.tilt = Math.PI / 2; this.draw(); },
      };
      if (!actions[event.key]) return;
      event.preventDefault();
      actions[event.key]();
    });
  }
}
