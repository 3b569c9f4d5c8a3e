// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Numbers, colours and canvases, for plots and the view of space alike.
'use strict';

/** The value of a colour of report.css. */
function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
}

/** 1, 2 or 5 times a power of ten, so that about `count` steps fill the extent. */
function niceStep(extent, count) {
  const rough = extent / count;
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  for (const factor of [1, 2, 5]) if (factor * power >= rough) return factor * power;
  return 10 * power;
}

/** A tick's text: as many decimals as its step needs, with k and M for large ones. */
function tickText(value, step) {
  if (Math.abs(value) < step * 1e-6) return '0';
  const [unit, name] = Math.abs(step) >= 1e5 ? [1e6, 'M'] : Math.abs(step) >= 1000 ? [1e3, 'k'] : [1, ''];
  const decimals = Math.max(0, Math.min(6, -Math.floor(Math.log10(step / unit) + 1e-9)));
  return (value / unit).toFixed(decimals) + name;
}

/** Four significant digits. */
function valueText(value) {
  if (value === null || value === undefined) return '–';
  const size = Math.abs(value);
  if (size >= 1e6) return (value / 1e6).toFixed(2) + 'M';
  if (size >= 1e4) return (value / 1e3).toFixed(1) + 'k';
  return Number.isInteger(value) ? String(value) : value.toFixed(Math.max(0, Math.min(5, 3 - Math.floor(Math.log10(size)))));
}

/** The index of the last time at or before t; times rise. */
function rowAt(times, t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}

/** A canvas's context with one unit a css pixel, sharp on any screen. */
function sized(canvas) {
  const ratio = Math.min(3, window.devicePixelRatio || 1), width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.scale(ratio, ratio);
  return [context, width, height];
}
