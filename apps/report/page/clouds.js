// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A million points and voxels, rendered into an image by the nearest of each pixel: any browser does this in some
// hundredths of a second, with or without a graphics card.
'use strict';

const kHeightColours = [[72, 60, 150], [44, 112, 168], [30, 152, 138], [116, 184, 84], [222, 200, 60]];
/** From black to white, but never that of the page. */
const greyColours = () => document.documentElement.dataset.theme === 'dark' ? [[70, 70, 70], [250, 250, 250]] : [[10, 10, 10], [185, 185, 185]];
/** Brightness of the sides of a voxel that face along its x, y and z. */
const kSides = [0.82, 0.64, 1];
const kRenderGoal_ms = 25;  // while the view moves; every n-th point is rendered then

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** Points as the program packs them: {low, step, xyz, grey} to flat positions [m] and a byte each. */
function unpacked(packed) {
  const words = new Uint16Array(bytesOf(packed.xyz).buffer), xyz = new Float32Array(words.length);
  for (let i = 0; i < words.length; ++i) xyz[i] = packed.low[i % 3] + packed.step[i % 3] * words[i];
  return {xyz, grey: bytesOf(packed.grey)};
}

/** Points that become more as updates bring them: {halved, from, all, low, step, xyz, grey}. */
class GrowingCloud {
  constructor() {
    this.all = this.count = 0;
    this.room = {xyz: new Float32Array(3 * 4096), grey: new Uint8Array(4096)};
  }

  get xyz() { return this.room.xyz.subarray(0, 3 * this.count); }
  get grey() { return this.room.grey.subarray(0, this.count); }

  take(update) {
    for (let times = 0; times < update.halved; ++times) this.halve();
    this.count = update.from;  // 0 after the connection was lost
    const more = unpacked(update), count = this.count + more.grey.length;
    if (count > this.room.grey.length) {
      const before = this.room, size = 2 * count;
      this.room = {xyz: new Float32Array(3 * size), grey: new Uint8Array(size)};
      this.room.xyz.set(before.xyz);
      this.room.grey.set(before.grey);
    }
    this.room.xyz.set(more.xyz, 3 * this.count);
    this.room.grey.set(more.grey, this.count);
    this.count = count;
    this.all = update.all;
  }

  /** Drops every second point, as the program does. */
  halve() {
    this.count = Math.ceil(this.count / 2);
    for (let i = 1; i < this.count; ++i) {
      this.room.xyz.copyWithin(3 * i, 6 * i, 6 * i + 3);
      this.room.grey[i] = this.room.grey[2 * i];
    }
  }
}

/** About so many values of one axis, evenly chosen, in their order. */
function sortedSample(xyz, axis, count) {
  const every = 3 * Math.ceil(xyz.length / 3 / count), sample = [];
  for (let i = axis; i < xyz.length; i += every) if (xyz[i] !== null) sample.push(xyz[i]);
  return sample.sort((a, b) => a - b);
}
const quantile = (sorted, share) => sorted[Math.floor(share * (sorted.length - 1))];

function mixed(colours, share) {
  const at = Math.min(Math.max(share, 0), 1) * (colours.length - 1), i = Math.min(Math.floor(at), colours.length - 2);
  return colours[i].map((c, k) => Math.round(c + (colours[i + 1][k] - c) * (at - i)));
}

/** 256 pixel values, from low to high. */
function inksOf(colours, brightness) {
  return Uint32Array.from({length: 256}, (_, i) => {
    const [r, g, b] = mixed(colours, i / 255).map(c => Math.round(brightness * c));
    return (255 << 24 | b << 16 | g << 8 | r) >>> 0;
  });
}

/** The place of each point between two heights, as a byte. */
function heightTones(xyz, [low, high]) {
  const tones = new Uint8ClampedArray(xyz.length / 3), scale = 255 / Math.max(1e-6, high - low);
  for (let i = 0; i < tones.length; ++i) tones[i] = scale * (xyz[3 * i + 2] - low);
  return tones;
}

/**
 * The pixels of a cube about its middle, by column and row, with how near they are [px] and the side they show.
 * axes: the directions of its edges in the view, each [right, up, towards the viewer].
 */
function cubeSprite(edge, axes) {
  const half = edge / 2, reach = Math.ceil(half * Math.sqrt(3)), pixels = [];
  for (let v = -reach; v <= reach; ++v) {
    for (let u = -reach; u <= reach; ++u) {
      let enter = -Infinity, leave = Infinity, side = 0;
      axes.forEach(([right, up, towards], k) => {
        const slope = Math.abs(towards) < 1e-6 ? 1e-6 : towards, at = u * right + v * up;
        const a = (-half - at) / slope, b = (half - at) / slope;
        if (Math.max(a, b) < leave) leave = Math.max(a, b), side = k;
        enter = Math.max(enter, Math.min(a, b));
      });
      if (enter <= leave || (u === 0 && v === 0)) pixels.push([u, -v, leave, side]);
    }
  }
  return {u: Int32Array.from(pixels, p => p[0]), v: Int32Array.from(pixels, p => p[1]), near: Float32Array.from(pixels, p => p[2]), side: Uint8Array.from(pixels, p => p[3])};
}

/** An image in which the nearest wins. A view: [x, y, z, 1] to column, row and nearness, each as four factors. */
class CloudImage {
  constructor() {
    this.canvas = document.createElement('canvas');
  }

  clear(width, height) {
    if (!this.image || this.image.width !== width || this.image.height !== height) {
      this.canvas.width = width, this.canvas.height = height;
      this.context = this.canvas.getContext('2d');
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.near = new Float32Array(width * height);
    }
    this.pixels.fill(0);
    this.near.fill(-Infinity);
  }

  /** Squares of `size` pixels; every `every`-th point. */
  points(cloud, [column, row, near], size, inks, every) {
    const {width, height} = this.image, {xyz, tones} = cloud, pixels = this.pixels, nears = this.near, count = xyz.length / 3;
    const shift = (size - 1) / 2;
    for (let i = 0; i < count; i += every) {
      const x = xyz[3 * i], y = xyz[3 * i + 1], z = xyz[3 * i + 2];
      const u = Math.floor(column[0] * x + column[1] * y + column[2] * z + column[3] - shift);
      const v = Math.floor(row[0] * x + row[1] * y + row[2] * z + row[3] - shift);
      if (u < 0 || v < 0 || u > width - size || v > height - size) continue;
      const d = near[0] * x + near[1] * y + near[2] * z + near[3], ink = inks[tones[i]];
      for (let b = 0, at = v * width + u; b < size; ++b, at += width) {
        for (let a = at; a < at + size; ++a) if (d > nears[a]) nears[a] = d, pixels[a] = ink;
      }
    }
  }

  /** sideInks: of each side of the sprite. */
  cubes(cloud, [column, row, near], sprite, sideInks, every) {
    const {width, height} = this.image, {xyz, tones} = cloud, pixels = this.pixels, nears = this.near, count = xyz.length / 3;
    for (let i = 0; i < count; i += every) {
      const x = xyz[3 * i], y = xyz[3 * i + 1], z = xyz[3 * i + 2];
      const u = Math.floor(column[0] * x + column[1] * y + column[2] * z + column[3]);
      const v = Math.floor(row[0] * x + row[1] * y + row[2] * z + row[3]);
      const d = near[0] * x + near[1] * y + near[2] * z + near[3];
      for (let k = 0; k < sprite.u.length; ++k) {
        const a = u + sprite.u[k], b = v + sprite.v[k];
        if (a < 0 || b < 0 || a >= width || b >= height) continue;
        const at = b * width + a;
        if (d + sprite.near[k] > nears[at]) nears[at] = d + sprite.near[k], pixels[at] = sideInks[sprite.side[k]][tones[i]];
      }
    }
  }

  finished() {
    this.context.putImageData(this.image, 0, 0);
    return this.canvas;
  }
}
