// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sections below the path: plots, timeline, options, calibration, stages; and the assembly of the page.
'use strict';

// ---- plots ----

/** Lengths of a plot in mm if all are small: [factor, unit]. A live page, whose columns grow, stays with metres. */
function lengthUnit(columns) {
  const small = !runs.some(run => run.live) && columns.every(column => column.every(value => Math.abs(value || 0) < 0.1));
  return small ? [1e3, 'mm'] : [1, 'm'];
}
const scaled = (column, factor) => factor === 1 ? column : column.map(value => value === null ? null : factor * value);

/** One plot of a column with all runs, and the truth if requested. Nothing if no run has the column. */
function columnPlot(parent, title, unit, key, more) {
  const series = [];
  const [factor, shownUnit] = more && more.error ? lengthUnit(runs.filter(run => run.rows[key]).map(run => run.rows[key])) : [1, unit];
  let truth = null;
  runs.forEach((run, i) => {
    const rows = run.rows;
    if (more && more.truth && !truth && rows['true_' + key]) {
      truth = {t: rows.t, y: rows['true_' + key], label: 'truth (wide)', colour: 'truth', wide: true};
    }
    if (!rows[key] || !(run.live || rows[key].some(value => value !== null))) return;
    if (about(run) && about(run).mode === (more && more.notIn)) return;
    series.push({t: rows.t, y: scaled(rows[key], factor), label: runs.length > 1 ? runName(run) : more && more.truth ? 'estimate' : '', colour: runColour(i), dots: more && more.dots});
  });
  if (!series.length) return;
  if (truth) series.unshift(truth);
  new TimePlot(time, {title, unit: shownUnit, series, zero: more && more.zero}, parent);
}

/** Errors with their limits by the covariance, if there is a truth; else only the limits. */
function errorPlots(parent) {
  for (const axis of ['x', 'y', 'z']) {
    const key = 'sigma3_' + axis, series = [];
    const [factor, unit] = lengthUnit(runs.flatMap(run => run.pose_errors.t ? [run.pose_errors[axis], run.pose_errors[key]] : run.rows[key] ? [run.rows[key]] : []));
    runs.forEach((run, i) => {
      const pose_errors = run.pose_errors, label = runs.length > 1 ? runName(run) : '';
      if (pose_errors.t) {
        series.push({t: pose_errors.t, y: scaled(pose_errors[axis], factor), label, colour: runColour(i), band: {low: scaled(pose_errors[key], -factor), high: scaled(pose_errors[key], factor)}});
      } else if (run.rows[key] && run.rows[key].some(s => s !== null)) {
        series.push({t: run.rows.t, y: run.rows[key].map(() => null), label, colour: runColour(i), band: {low: scaled(run.rows[key], -factor), high: scaled(run.rows[key], factor)}});
      }
    });
    const compared = runs.some(run => run.pose_errors.t);
    if (series.length) new TimePlot(time, {title: compared ? 'error ' + axis + ' since the start, ±3 σ' : '±3 σ of ' + axis, unit, series}, parent);
  }
}

/** Samples of height and speed beside the estimate; heights have an arbitrary zero, and are shifted by their median difference. */
function externalPlots(parent) {
  const median = all => [...all].sort((a, b) => a - b)[all.length >> 1];
  const speed = rows => rows.vx.map((v, i) => v === null ? null : Math.hypot(v, rows.vy[i], rows.vz[i]));
  runs.forEach((run, i) => {
    for (const [sensor, samples] of Object.entries(run.external || {})) {
      const height = sensor === 'height', estimate = height ? run.rows.z : speed(run.rows);
      const known = estimate.filter(value => value !== null);
      const shift = height && known.length ? median(known) - median(samples.y) : 0;
      const series = [{t: samples.t, y: samples.y.map(value => value + shift), label: sensor + ' sensor', colour: 'truth', dots: true},
                      {t: run.rows.t, y: estimate, label: runs.length > 1 ? runName(run) : 'estimate', colour: runColour(i)}];
      new TimePlot(time, {title: height ? 'height' : 'speed', unit: height ? 'm' : 'm/s', series}, parent);
    }
  });
}

function plotSection() {
  const group = title => {
    const grid = make('div', {class: 'plots'});
    all.append(make('h3', {}, title), grid);
    return grid;
  };
  const span = make('span', {'aria-live': 'off', id: 'span'});
  const button = (text, label, action) => {
    const element = make('button', {type: 'button', 'aria-label': label}, text);
    element.addEventListener('click', action);
    return element;
  };
  const bar = make('div', {class: 'tools sticky'}, button('+', 'zoom in', () => time.scale(0.5)), button('−', 'zoom out', () => time.scale(2)),
                   button('Whole run', 'show the whole run', () => time.reset()), span);
  const all = section('Over time', bar, make('p', {class: 'hint'}, 'One cursor for all plots, the path and the pictures. Drag zooms, a double click shows all; keys: arrows, + − and Home.' + (runs.length === 1 ? ' Shaded: not Good (see below); vertical line: relocalized in the map.' : '')));
  const truth = {truth: true};
  const triple = (parent, names, unit, keys, more) => keys.forEach((key, i) => columnPlot(parent, names[i], unit, key, more));
  const frames = [...new Set(runs.filter(run => !run.is_file).map(run => run.frame === 'body' ? 'the body (IMU)' : 'camera ' + run.frame))].join(', ');
  triple(group('Position' + (frames ? ' of ' + frames : '')), ['x', 'y', 'z'], 'm', ['x', 'y', 'z'], truth);
  triple(group('Orientation of the body (IMU)'), ['roll', 'pitch', 'yaw'], '°', ['roll', 'pitch', 'yaw'], truth);
  const errors = group('Errors and uncertainty');
  columnPlot(errors, 'position error, aligned', 'm', 'error_m', {zero: true, error: true});
  columnPlot(errors, 'rotation error, aligned', '°', 'rotation_error_deg', {zero: true});
  if (runs.some(run => run.live)) triple(errors, ['3 σ of x', '3 σ of y', '3 σ of z'], 'm', ['sigma3_x', 'sigma3_y', 'sigma3_z'], {zero: true});
  else errorPlots(errors);
  triple(group('Velocity of the body, in the world of the estimate'), ['v x', 'v y', 'v z'], 'm/s', ['vx', 'vy', 'vz']);
  externalPlots(group('Height and velocity sensors'));
  const biases = group('Biases of the IMU');
  triple(biases, ['gyro x', 'gyro y', 'gyro z'], 'rad/s', ['bgx', 'bgy', 'bgz']);
  triple(biases, ['accelerometer x', 'accelerometer y', 'accelerometer z'], 'm/s²', ['bax', 'bay', 'baz']);
  const seen = group('Tracks, landmarks and events');
  columnPlot(seen, 'tracks on events', '', 'event_tracks', {zero: true, notIn: 'frames'});
  columnPlot(seen, 'tracks on frames', '', 'frame_tracks', {zero: true, notIn: 'events'});
  columnPlot(seen, 'track survival rate, events', '', 'event_track_survival_rate', {zero: true, notIn: 'frames'});
  columnPlot(seen, 'track survival rate, frames', '', 'frame_track_survival_rate', {zero: true, notIn: 'events'});
  columnPlot(seen, 'landmarks', '', 'landmarks', {zero: true});
  columnPlot(seen, 'event rate', '1/s', 'event_rate', {zero: true, notIn: 'frames'});
  columnPlot(seen, 'scene depth', 'm', 'depth', {zero: true});
  const map = group('Map: landmarks observed again after they left the window');
  columnPlot(map, 'map matches', '', 'map_matches', {zero: true, dots: true});
  columnPlot(map, 'age of the oldest keyframe matched', 's', 'map_reach', {zero: true, dots: true});
  const pace = group('Processing time per packet');
  columnPlot(pace, 'processing', 'ms', 'processing', {zero: true});
  columnPlot(pace, 'latency', 'ms', 'latency', {zero: true});
  for (const grid of [...all.querySelectorAll('.plots')]) if (!grid.children.length) grid.previousSibling.remove(), grid.remove();
  time.listeners.push(() => {
    const [a, b] = time.view;
    span.textContent = a.toFixed(2) + ' to ' + b.toFixed(2) + ' s' + (time.cursor === null ? '' : ', cursor ' + time.cursor.toFixed(2) + ' s');
  });
}

// ---- timeline, options, calibration ----

function timelineSection() {
  const cards = section('Status, and why it changed').appendChild(make('div', {}));
  const table = () => cards.querySelector('.scroll') || {scrollLeft: 0};
  const fill = () => {
    const at = table().scrollLeft;  // a narrow screen has moved it
    cards.replaceChildren();
    fillTimeline(cards);
    table().scrollLeft = at;
  };
  fill();
  return fill;
}

function fillTimeline(all) {
  runs.forEach((run, i) => {
    if (run.is_file || !run.changes.length) return;
    const last = run.rows.t[run.rows.t.length - 1];
    const spans = run.changes.map((change, k) => ({...change, length: (k + 1 < run.changes.length ? run.changes[k + 1].t : last) - change.t}));
    const bar = make('div', {class: 'timeline', role: 'img', 'aria-label': 'status over time'});
    for (const span of spans) {
      const piece = make('i', {c: kStatusColours[span.status], title: span.status + ' from ' + span.t.toFixed(2) + ' s' + (span.relocalized ? ', relocalized in the map' : '')});
      if (span.relocalized) piece.className = 'again';
      piece.style.flexGrow = Math.max(span.length, 1e-3);
      bar.append(piece);
    }
    if (runs.length === 1) {
      time.spans = spans.filter(span => span.status !== 'Good').map(span => ({from: span.t, to: span.t + span.length, colour: kStatusColours[span.status]}));
      time.marks = spans.filter(span => span.relocalized).map(span => span.t);
    }
    const rows = spans.map(span => {
      const status = make('td', {class: 'status', c: kStatusColours[span.status]}, span.status);
      const at = rowAt(run.rows.t, span.t), n = key => run.rows[key] ? run.rows[key][at] : 0;
      const tracks = n('event_tracks') + ' on events, ' + n('frame_tracks') + ' on frames, ' + n('landmarks') + ' landmarks';
      return [cell(span.t.toFixed(2), 'n'), cell(span.length.toFixed(2), 'n'), status, cell(span.reason || '', 'why'), cell(tracks)];
    });
    all.append(make('div', {class: 'card'}, make('h3', {}, make('i', {class: 'swatch', c: runColour(i)}), runName(run)), bar,
                    table(['from [s]', 'for [s]', 'status', 'why', 'tracks at its start'], rows)));
  });
}

function optionsSection() {
  const all = section('Options that differ from the defaults');
  for (const run of runs.filter(each => !each.is_file)) {
    const body = run.options.length
      ? table(['option', 'value', 'default', 'unit', 'what it does'], run.options.map(option => [cell(option.key, 'key'), cell(option.value, 'key'), cell(option.default, 'key'), cell(option.unit), cell(option.effect)]))
      : make('p', {}, 'None: all options are the defaults.');
    all.append(make('div', {class: 'card'}, make('h3', {}, runName(run)), body));
  }
}

/** Angle between two transforms' rotations [deg]. */
function turned(before, after) {
  let trace = 0;
  for (let row = 0; row < 3; ++row) for (let column = 0; column < 3; ++column) trace += before[4 * row + column] * after[4 * row + column];
  return Math.acos(Math.min(1, Math.max(-1, (trace - 1) / 2))) * 180 / Math.PI;
}
function matrixText(T) {
  return [0, 1, 2].map(row => T.slice(4 * row, 4 * row + 4).map(value => value.toFixed(5).padStart(9)).join(' ')).join('\n');
}

function calibrationSection() {
  const all = section('Calibration, given and estimated');
  for (const run of runs.filter(each => each.calibration.length)) {
    const rows = run.calibration.map(camera => {
      const found = ((run.metrics && run.metrics.calibration) || []).find(each => each.camera === camera.camera) || {};
      const sigma = (value, unit) => value === null || value === undefined ? '' : ' ± ' + value.toFixed(2) + unit;
      const after = camera.after;
      return [cell(camera.camera), cell(matrixText(camera.before.T_B_C), 'matrix'), cell(after ? matrixText(after.T_B_C) : null, 'matrix'),
              cell(after ? turned(camera.before.T_B_C, after.T_B_C).toFixed(2) + sigma(found.rotation_sigma_deg, '') + '°' : null, 'n'),
              cell(camera.before.time_offset_ms.toFixed(3), 'n'), cell(after ? after.time_offset_ms.toFixed(3) + sigma(found.time_offset_sigma_ms, '') : null, 'n')];
    });
    all.append(make('div', {class: 'card'}, make('h3', {}, runName(run)),
                    table(['camera', 'T_B_C given', 'T_B_C estimated', 'rotation between', 'time offset given [ms]', 'time offset estimated [ms]'], rows),
                    make('p', {class: 'hint'}, 'T_B_C maps the camera to the body (IMU); t_imu = t_cam + time offset. Translation and lens are as given.')));
  }
}

function detailsSection() {
  const all = section('Time spent, log');
  for (const run of runs.filter(each => !each.is_file)) {
    const card = make('div', {class: 'card'}, make('h3', {}, runName(run)));
    if (run.stages.length) {
      const rows = run.stages.map(stage => [cell(stage.stage), ...['count', 'mean_ms', 'p50_ms', 'p95_ms', 'p99_ms', 'max_ms', 'total_s'].map(key => cell(key === 'count' ? stage[key] : stage[key].toFixed(3), 'n'))]);
      card.append(make('details', {}, make('summary', {}, 'Stages'), table(['stage', 'count', 'mean [ms]', 'median [ms]', '95 % [ms]', '99 % [ms]', 'worst [ms]', 'total [s]'], rows)));
    }
    if (run.log.length) card.append(make('details', {}, make('summary', {}, 'Log'), make('pre', {tabindex: '0'}, run.log.join('\n'))));
    all.append(card);
  }
}

// ---- the page ----

const kThemes = ['as the system', 'light', 'dark'];
let theme = 0, printing = false;
const dark = matchMedia('(prefers-color-scheme: dark)');

function applyTheme() {
  const isDark = !printing && (theme === 2 || (theme === 0 && dark.matches));
  document.documentElement.dataset.theme = isDark ? 'dark' : 'light';
  document.getElementById('theme').textContent = 'Theme: ' + kThemes[theme];
  if (space) space.draw();
  for (const plot of time.plots) plot.draw(), plot.showCursor();
}

/** An empty page about these runs. */
function clearPage(data) {
  take(data);
  document.getElementById('main').replaceChildren();
  const title = runs.map(fullName).join(' · ');
  document.title = title + ' – Edged report';
  document.getElementById('title').textContent = title;
}

function buildPage(data) {
  clearPage(data);
  section('In plain words', make('div', {class: 'cards'}, ...runs.map(verdictCard)));
  const [path, refresh] = pathCard(), pictures = picturesCard();
  section('Path', make('div', {class: pictures ? 'pair' : 'pair alone'}, path, pictures));
  plotSection();
  timelineSection();
  optionsSection();
  calibrationSection();
  detailsSection();
  document.getElementById('footer').textContent = 'Written by edged ' + report.version + '. Times count from the first packet of the first run.';
  refresh();
  time.listeners.push(moveMarks);
  applyTheme();
  time.tell();
}

/** build(data) fills the page, which adapts to theme, window and printer. */
function begin(build) {
  build(JSON.parse(document.getElementById('data').textContent));
  document.getElementById('theme').addEventListener('click', () => { theme = (theme + 1) % 3; applyTheme(); });
  dark.addEventListener('change', applyTheme);
  let width = innerWidth;
  addEventListener('resize', () => { if (innerWidth !== width) width = innerWidth, applyTheme(); });
  addEventListener('beforeprint', () => { printing = true; applyTheme(); });
  addEventListener('afterprint', () => { printing = false; applyTheme(); });
  document.documentElement.dataset.ready = 'yes';
}
