// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The page of `edged calib --target`: sigmas, coverage of the image, residuals over image and time, what is missing.
'use strict';

const kArrow = 40;  // pixels of the image that a residual of one pixel is drawn long

function targetCanvas(title, note, draw, [width, height]) {
  const canvas = make('canvas', {role: 'img', 'aria-label': title, style: 'height: auto; aspect-ratio: ' + width + ' / ' + height});
  const figure = make('figure', {class: 'plot'}, make('figcaption', {}, title, make('span', {}, note)),
                      make('div', {class: 'area'}, canvas));
  const redraw = () => draw(...sized(canvas));
  targetCanvas.all.push(redraw);
  return figure;
}
targetCanvas.all = [];

/** Corners in each cell of the image: the darker, the more. */
function drawCells(camera, context, width, height) {
  const {columns, rows, corners} = camera.cells, most = Math.max(1, ...corners);
  const scale = Math.min(width / camera.resolution_px[0], height / camera.resolution_px[1]);
  const w = camera.resolution_px[0] * scale / columns, h = camera.resolution_px[1] * scale / rows;
  context.font = '11px sans-serif';
  context.textAlign = 'center';
  for (let i = 0; i < corners.length; ++i) {
    const x = (i % columns) * w, y = Math.floor(i / columns) * h;
    context.globalAlpha = corners[i] ? 0.1 + 0.4 * Math.sqrt(corners[i] / most) : 1;
    context.fillStyle = corners[i] ? colour('accent') : colour('page');
    context.fillRect(x, y, w - 1, h - 1);
    context.globalAlpha = 1;
    context.fillStyle = corners[i] ? colour('ink') : colour('lost');
    context.fillText(corners[i], x + w / 2, y + h / 2 + 4);
  }
}

/** A stroke from each corner along its residual. */
function drawResiduals(camera, context, width, height) {
  const scale = Math.min(width / camera.resolution_px[0], height / camera.resolution_px[1]);
  context.strokeStyle = colour('line');
  context.strokeRect(0.5, 0.5, camera.resolution_px[0] * scale - 1, camera.resolution_px[1] * scale - 1);
  context.strokeStyle = colour('accent');
  context.globalAlpha = 0.35;
  context.beginPath();
  for (const [, x, y, dx, dy] of camera.residuals) {
    context.moveTo(x * scale, y * scale);
    context.lineTo((x + kArrow * dx) * scale, (y + kArrow * dy) * scale);
  }
  context.stroke();
  context.globalAlpha = 1;
}

/** Length of the residuals over time, up to four times their root mean square. */
function drawOverTime(camera, context, width, height) {
  const left = 34, bottom = 16, top = 4 * Math.max(camera.reprojection_px.rms, 1e-3);
  const end = Math.max(1, ...camera.residuals.map(r => r[0]));
  const x = t => left + t / end * (width - left - 4), y = e => (height - bottom) * (1 - Math.min(e, top) / top) + 2;
  context.font = '11px sans-serif';
  context.fillStyle = colour('soft');
  context.strokeStyle = colour('grid');
  for (let step = niceStep(top, 3), e = 0; e <= top; e += step) {
    context.fillText(tickText(e, step), 2, y(e) + 4);
    context.strokeRect(left, y(e), width - left, 0);
  }
  for (let step = niceStep(end, 6), t = 0; t <= end; t += step) context.fillText(tickText(t, step) + ' s', x(t), height - 3);
  context.fillStyle = colour('accent');
  context.globalAlpha = 0.4;
  for (const [t, , , dx, dy] of camera.residuals) context.fillRect(x(t), y(Math.hypot(dx, dy)), 1.5, 1.5);
  context.globalAlpha = 1;
}

function cameraSection(camera) {
  const rows = camera.parameters.map(p => [cell(p.name, 'key'), cell(valueText6(p.value), 'n'), cell(valueText(p.sigma), 'n')]);
  if (camera.p_B_C_m) {
    for (let i = 0; i < 3; ++i)
      rows.push([cell('position ' + 'xyz'[i], 'key'), cell((1e3 * camera.p_B_C_m[i]).toFixed(2) + ' mm', 'n'),
                 cell((1e3 * camera.position_sigma_m[i]).toFixed(3) + ' mm', 'n')]);
    rows.push([cell('rotation w x y z', 'key'), cell(camera.q_B_C.map(q => q.toFixed(5)).join(' ')),
               cell(camera.rotation_sigma_deg.map(s => s.toFixed(4)).join(' ') + ' deg')]);
  }
  if (camera.time_offset_s !== undefined)
    rows.push([cell('time offset', 'key'), cell((1e3 * camera.time_offset_s).toFixed(3) + ' ms', 'n'),
               cell((1e3 * camera.time_offset_sigma_s).toFixed(4) + ' ms', 'n')]);
  section('Camera ' + camera.name,
          make('p', {}, camera.modality + ', ' + camera.resolution_px.join(' x ') + ' px, ' + camera.lens + '. The target is in ' +
               camera.views + ' of ' + camera.pictures + ' pictures, at ' + camera.distance_m.map(d => d.toFixed(2)).join(' to ') +
               ' m, tilted by ' + camera.tilt_deg.map(d => d.toFixed(0)).join(' and ') + ' deg (one sigma). Residuals: ' +
               camera.reprojection_px.median.toFixed(3) + ' px median, ' + camera.reprojection_px.rms.toFixed(3) + ' px rms.'),
          make('div', {class: 'card'}, table(['', 'value', 'sigma'], rows)),
          make('div', {class: 'plots', style: 'margin-top: 12px'},
               targetCanvas('Coverage', 'corners in each part of the image', (...a) => drawCells(camera, ...a), camera.resolution_px),
               targetCanvas('Residuals over the image', kArrow + ' times their length', (...a) => drawResiduals(camera, ...a), camera.resolution_px),
               targetCanvas('Residuals over time', 'px', (...a) => drawOverTime(camera, ...a), camera.resolution_px)));
}

const valueText6 = value => Math.abs(value) >= 10 ? value.toFixed(3) : value.toFixed(6);

function buildTargetPage(data) {
  time = new TimeGroup(0, 1);  // of the page's theme
  document.title = 'Calibration from ' + data.recording;
  document.getElementById('title').textContent = document.title;
  const missing = data.advice.length ? data.advice : ['Nothing is missing.'];
  section('Recording', make('div', {class: 'card'},
          make('p', {}, data.target + '. ' + (data.has_imu ? 'Cameras and IMU' : 'Cameras alone') + ', ' + data.states +
               ' instants, ' + data.seconds.toFixed(0) + ' s of computation.'),
          make('h3', {}, 'What a better recording needs'), ...missing.map(line => make('p', {class: 'finding'}, line))));
  for (const camera of data.cameras) cameraSection(camera);
  applyTheme();
}

begin(buildTargetPage);
// After the colours of the theme have been set, and again when they change.
const redrawTarget = () => targetCanvas.all.forEach(draw => draw());
redrawTarget();
new MutationObserver(redrawTarget).observe(document.documentElement, {attributes: true, attributeFilter: ['data-theme']});
addEventListener('resize', redrawTarget);
