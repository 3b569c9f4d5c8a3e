// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The page: verdict, path, pictures, plots, timeline, options, calibration. All text of recordings goes in as text.
'use strict';

let report = null, runs = [], time = null, space = null;
const show = {error: true, truth: true, final: false, map: true, dense: true, voxels: false, heights: true, whole: false, keyframes: false, kept: false, links: true};
const kLinkedAfter_s = 5;  // matches of younger keyframes are no return to an earlier place
const kStatusColours = {Good: 'good', Degraded: 'degraded', Lost: 'lost', Initializing: 'initializing'};
/** The colour of a verdict. */
const inkOf = m => m.status === 'good' && !(m.findings || []).length ? 'good' : m.trusted || m.status === 'interrupted' ? 'degraded' : 'lost';

/** An element with text or children; null children are left out. */
function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === 'c') element.style.setProperty('--c', 'var(--' + value + ')');
    else element.setAttribute(name, value);
  }
  for (const child of children) if (child !== null) element.append(child);
  return element;
}

function number(value, unit, decimals) {
  return value === null || value === undefined ? null : value.toFixed(decimals) + (unit ? ' ' + unit : '');
}
/** Millimetres below 10 cm. */
function length(value) {
  if (value === null || value === undefined) return null;
  return value < 0.1 ? (1e3 * value).toFixed(2) + ' mm' : value.toFixed(3) + ' m';
}
const runColour = i => 'run' + i % 6;
const nameOf = run => runs.filter(other => other.name === run.name).length > 1 ? run.folder : run.name;
/** The metadata of a run, also of a live one; null for a file. */
const about = run => run.metrics || run.live || null;
const runName = run => nameOf(run) + (about(run) && !run.name.includes(about(run).mode) ? ', ' + about(run).mode : '');
/** With the recording, if the folder's name does not contain it. */
const fullName = run => (about(run) && !run.name.includes(about(run).recording) ? about(run).recording + ': ' : '') + runName(run);

function section(title, ...children) {
  const element = make('section', {}, make('h2', {}, title), ...children);
  document.getElementById('main').append(element);
  return element;
}

function table(heads, rows) {
  return make('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': heads.join(', ')},
              make('table', {}, make('thead', {}, make('tr', {}, ...heads.map(head => make('th', {scope: 'col'}, head)))),
                   make('tbody', {}, ...rows.map(row => make('tr', {}, ...row)))));
}
const cell = (text, kind) => make('td', kind ? {class: kind} : {}, text === null || text === undefined ? '–' : String(text));

// ---- verdict ----

/** The summary of a run, name by name; null is skipped. */
function facts(run) {
  const m = run.metrics, e = run.evaluation;
  const list = [];
  if (e) {
    list.push(['ATE (RMSE)', length(e.ate_m.rmse) + ', ' + e.alignment + ' alignment' + (e.window_s[0] > 0 || e.window_s[1] !== null ? ' on a part' : '')]);
    const local = (e.local_error || []).filter(l => l.rmse_m !== null).map(l => length(l.rmse_m) + ' over ' + l.window_s + ' s');
    if (local.length) list.push(['local error', local.join(', ')]);
    list.push(['worst error', length(e.ate_m.max)]);
    list.push(['rotation error', number(e.rotation_deg.mean, '° on average', 2)]);
    list.push(['scale', number(e.scale, '(1 is perfect)', 4)]);
  } else {
    list.push(['ATE (RMSE)', run.not_compared || 'no ground truth to compare with']);
  }
  list.push(['path', number(e ? e.path_length_m : run.path_m, e ? 'm (true)' : 'm (estimated)', 2)]);
  if (!m) return list;
  const final = m.final_not_causal;
  if (final && final.ate_rmse_m !== null) list.push(['ATE of the final trajectory', length(final.ate_rmse_m) + ' (not causal)']);
  list.push(['duration', number(m.duration_s, 's', 1)]);
  list.push(['losses', m.times_lost === 0 ? 'none' : m.times_lost + ', ' + number(m.seconds_in.Lost, 's in total', 1)]);
  if (m.seconds_in.Degraded > 0) list.push(['less certain', number(m.seconds_in.Degraded, 's (Degraded)', 1)]);
  list.push(['coverage', number(100 * m.coverage, '% of the time Good', 1)]);
  list.push(['first good pose', m.first_good_s === null ? 'never' : 'after ' + number(m.first_good_s, 's', 2)]);
  if (m.loops_closed > 0) list.push(['loops closed', m.loops_closed]);
  list.push(['poses, keyframes', m.poses + ', ' + m.keyframes]);
  for (const [sensor, n] of Object.entries(m.external || {}))
    list.push([sensor + ' samples', n.used + ' of ' + n.samples + ' used, ' + n.rejected + ' rejected, ' + n.late + ' late']);
  if (m.consistency) list.push(['within 3 σ', number(100 * m.consistency.position.within_3_sigma, '% of the positions', 1)]);
  const process = run.stages.find(stage => stage.stage === 'process');
  if (process) list.push(['processing per packet', number(process.p50_ms, 'ms (median)', 1) + ', ' + number(process.p99_ms, 'ms (99 %)', 1)]);
  list.push(['speed', number(m.real_time_factor, '× real time', 2) + ', ' + number(m.cpu_s_per_s, 'CPU s per s', 2) + ', ' + number(m.peak_rss_mb, 'MB', 0)]);
  if (m.live) list.push(['latency', number(1e3 * m.live.latency_s.p50, 'ms (median)', 1) + ', ' + number(1e3 * m.live.latency_s.p99, 'ms (99 %)', 1)]);
  list.push(['recording', m.recording + ' (' + m.format + '), ' + m.mode + (m.seed === null ? '' : ', seed ' + m.seed)]);
  list.push(['pose of', run.frame === 'body' ? 'the body (IMU)' : 'camera ' + run.frame]);
  list.push(['program', m.version]);
  return list;
}

/** Links that save the trajectories, which the page contains; null for a file and for a run without poses. */
function downloads(run) {
  const names = Object.keys(run.trajectories || {});
  if (!names.length) return null;
  return make('p', {class: 'downloads'}, 'Save: ', ...names.flatMap((name, k) => {
    const text = run.trajectories[name], file = new Blob([text || ''], {type: 'text/plain'});
    const link = text === null ? name + ' (in the run folder: too large for this page)'
      : make('a', {href: URL.createObjectURL(file), download: run.name + '-' + name}, name);
    return k ? [', ', link] : [link];
  }));
}

function verdictCard(run, i) {
  const m = run.metrics;
  const [says, ink] = run.is_file ? [run.by_edged ? 'A trajectory of edged; its run folder shows more.' : 'A trajectory of another program.', 'initializing']
    : !m ? ['The run ended before it wrote metrics.json; this page shows what it had written.', 'lost']
    : [m.verdict || m.status, inkOf(m)];
  const card = make('article', {class: 'card verdict'}, make('h3', {}, make('i', {class: 'swatch', c: runColour(i)}), fullName(run)),
                    make('p', {class: 'says'}, says));
  card.style.setProperty('--verdict', 'var(--' + ink + ')');
  if (m) {
    for (const finding of m.findings || []) {
      card.append(make('p', {class: 'finding'}, make('b', {}, finding.severity + ': '), finding.text),
                  make('p', {}, '→ ' + finding.remedy));
    }
    if (m.waiting_for) card.append(make('p', {}, 'Last waited for: ' + m.waiting_for));
    if (m.next && !m.next.startsWith('open ')) card.append(make('p', {}, 'Next: ', make('code', {}, m.next)));
    for (const [what, count] of Object.entries(m.repairs || {})) card.append(make('p', {}, 'repaired: ' + count + ' × ' + what));
  }
  card.append(make('dl', {class: 'facts'}, ...facts(run).flatMap(([name, value]) => value === null ? [] : [make('div', {}, make('dt', {}, name), make('dd', {}, value))])));
  const links = downloads(run);
  if (links) card.append(links);
  return card;
}

// ---- path and pictures ----

/** Sets the report of the page. */
function take(data) {
  report = data;
  runs = data.runs;
  const begin = Math.min(...runs.map(run => run.rows.t.length ? run.rows.t[0] : Infinity));
  const end = Math.max(...runs.map(run => run.rows.t.length ? run.rows.t[run.rows.t.length - 1] : -Infinity));
  time = new TimeGroup(isFinite(begin) ? begin : 0, isFinite(end) ? end : 1);
  show.error = runs.length === 1;
  for (const run of runs) for (const kind of ['dense', 'voxels']) if (run[kind] && run[kind].low) Object.assign(run[kind], unpacked(run[kind]));
  show.voxels = !runs.some(run => run.dense);  // they would hide the points within
  show.whole = runs.some(run => run.dense || run.voxels);
}

function axisOf(flat, k) {
  return flat.filter((value, i) => i % 3 === k);
}

const place = (rows, i) => [rows.x[i], rows.y[i], rows.z[i]];

/** From the pose of a map match to the keyframe of its map point. */
function linksOf(run) {
  const rows = run.rows, links = [];
  (rows.map_reach || []).forEach((reach, i) => {
    const from = place(rows, i), then = rows.t[i] - reach;
    if (reach === null || reach < kLinkedAfter_s || then < rows.t[0]) return;  // a keyframe of a loaded map is not on this path
    const to = place(rows, rowAt(rows.t, then));
    if (from[0] !== null && to[0] !== null) links.push({from, to});
  });
  return links;
}

/** The lowest and the highest of most points of the runs, for colours. */
function heightsOf(clouds) {
  const sorted = clouds.flatMap(cloud => sortedSample(cloud.xyz, 2, 4000)).sort((a, b) => a - b);
  return sorted.length ? [quantile(sorted, 0.02), quantile(sorted, 0.98)] : [0, 1];
}

/** The dense points and voxels that are shown, in colours of their heights or, points alone, in their own grey. */
function fillClouds() {
  const chosen = runs.flatMap(run => ['voxels', 'dense'].filter(kind => run[kind] && show[kind]).map(kind => run[kind])), heights = heightsOf(chosen);
  space.clouds = chosen.map(cloud => {
    const own = !show.heights && cloud.grey.length > 0;
    return {xyz: cloud.xyz, edge_m: cloud.edge_m, axes: cloud.axes, tones: own ? cloud.grey : heightTones(cloud.xyz, heights), own};
  });
  return space.clouds.every(cloud => cloud.own) ? null : heights;
}

function fillSpace() {
  const shadeMax = Math.max(1e-9, ...runs.map(run => (run.rows.error_m || []).reduce((a, b) => Math.max(a, b || 0), 0)));
  space.paths = [];
  space.points = [];
  space.links = show.links ? runs.flatMap(linksOf) : [];
  runs.forEach((run, i) => {
    const rows = run.rows;
    if (show.map && run.map.length) space.points.push({xyz: run.map, colour: runs.length > 1 ? runColour(i) : 'truth', size: 2, alpha: 0.55});
    if (show.keyframes && rows.keyframe) {
      const xyz = rows.t.flatMap((t, k) => rows.keyframe[k] && rows.x[k] !== null ? [rows.x[k], rows.y[k], rows.z[k]] : []);
      space.points.push({xyz, colour: 'ink', size: 5});
    }
    const kept = run.map_keyframes;
    if (show.kept && kept && kept.t) space.points.push({xyz: kept.t.flatMap((t, k) => place(kept, k)), colour: 'accent', size: 6});
    if (show.final && run.final && run.final.length) {
      space.paths.push({x: axisOf(run.final, 0), y: axisOf(run.final, 1), z: axisOf(run.final, 2), colour: 'truth', width: 6});
    }
    if (!rows.x) return;
    const shade = show.error && rows.error_m ? rows.error_m : null;
    space.paths.push({x: rows.x, y: rows.y, z: rows.z, colour: runColour(i), width: show.truth && run.truth.length ? 4 : 2, shade, shadeMax});
  });
  // Above the estimates, which would hide it.
  for (const run of runs.filter(each => show.truth && each.truth.length)) {
    space.paths.push({x: axisOf(run.truth, 0), y: axisOf(run.truth, 1), z: axisOf(run.truth, 2), colour: 'ink', width: 1, dash: true});
  }
  const heights = fillClouds();
  space.fit(show.whole);
  return [shadeMax, heights];
}

function moveMarks() {
  space.marks = runs.flatMap((run, i) => {
    const rows = run.rows;
    if (!rows.x || !rows.t.length) return [];
    const start = rows.x.findIndex(value => value !== null), last = run.live ? rows.t.length - 1 : -1, now = time.cursor === null ? last : rowAt(rows.t, time.cursor);
    const marks = start < 0 ? [] : [{p: place(rows, start), colour: runColour(i), size: 4}];
    if (now >= 0) marks.push({p: place(rows, now), colour: runColour(i), size: 7});
    return marks;
  });
  space.draw();
}

/** How many points of how many there are. */
function drawnText() {
  const sum = (kind, count) => runs.reduce((all, run) => all + (run[kind] ? count(run[kind]) : 0), 0);
  const text = (kind, name) => sum(kind, cloud => cloud.all) ? [sum(kind, cloud => cloud.xyz.length / 3) + ' of ' + sum(kind, cloud => cloud.all) + ' ' + name] : [];
  return [...text('dense', 'dense points'), ...text('voxels', 'occupied voxels')].map(each => each + ' are in this page.').join(' ');
}

function pathCard() {
  const canvas = make('canvas', {tabindex: '0', role: 'img', id: 'path',
                                 'aria-label': 'Path in space; arrows rotate, with shift move, plus and minus zoom, t looks from above, Home resets'});
  const tools = make('div', {class: 'tools'});
  space = new SpaceView(canvas);
  const scale = make('span', {class: 'scale'}), drawn = make('p', {class: 'hint', id: 'drawn'});
  const legend = (from, colours, to) => {
    const bar = make('i', {});
    bar.style.background = 'linear-gradient(90deg,' + colours.map(c => 'rgb(' + c.join(',') + ')').join(',') + ')';
    return make('span', {class: 'scale'}, from, bar, to);
  };
  const refresh = () => {
    const [most, heights] = fillSpace();
    scale.replaceChildren();
    if (show.error && runs.some(run => run.rows.error_m)) scale.append(legend('error 0', kErrorColours, length(most)));
    if (heights) scale.append(legend('height ' + number(heights[0], 'm', 2), kHeightColours, number(heights[1], 'm', 2)));
    drawn.textContent = drawnText();
    moveMarks();
  };
  const has = {error: runs.some(run => run.rows.error_m), truth: runs.some(run => run.truth.length), final: runs.some(run => run.final && run.final.length), map: runs.some(run => run.live || run.map.length), whole: runs.some(run => run.live || run.map.length || run.dense || run.voxels),
               dense: runs.some(run => run.dense), voxels: runs.some(run => run.voxels), heights: runs.some(run => run.dense), keyframes: runs.some(run => run.rows.keyframe),
               kept: runs.some(run => run.map_keyframes && run.map_keyframes.t), links: runs.some(run => run.live || linksOf(run).length)};
  for (const [key, label] of [['error', 'coloured by error'], ['truth', 'truth (thin, above)'], ['final', 'final path (wide grey)'], ['map', 'map points'], ['dense', 'dense points'], ['voxels', 'occupied voxels'], ['heights', 'coloured by height'], ['whole', 'fit the map'], ['keyframes', 'keyframes'], ['kept', 'keyframes of the map'],
                              ['links', 'revisits (lines)']]) {
    if (!has[key]) continue;
    const box = make('input', {type: 'checkbox'});
    box.checked = show[key];
    box.addEventListener('change', () => { show[key] = box.checked; refresh(); });
    tools.append(make('label', {}, box, label));
  }
  const button = (text, action) => {
    const element = make('button', {type: 'button'}, text);
    element.addEventListener('click', action);
    return element;
  };
  tools.append(button('From above', () => { space.turn = 0; space.tilt = Math.PI / 2; space.draw(); }),
               button('From the side', () => { space.turn = 0; space.tilt = 0; space.draw(); }),
               button('Reset', () => { space.home(); space.draw(); }), scale);
  const world = runs.some(run => run.evaluation) ? 'World of the ground truth, z up.' : 'World of the estimate, z up; it begins at the origin.';
  const card = make('div', {class: 'card view'}, canvas, tools, drawn,
                    make('p', {class: 'hint'}, world + ' Drag rotates, shift-drag or two fingers move, wheel (after a click) or pinch zooms; the keyboard does the same. The small dot is the start.' +
                         (has.links ? ' A line joins the two positions from which a place was observed, ' + kLinkedAfter_s + ' s apart or more.' : '')));
  return [card, refresh];
}

/** The picture nearest before the cursor, of each run. */
function picturesCard() {
  const withPictures = runs.filter(run => run.pictures.length);
  if (!withPictures.length) return null;
  const slider = make('input', {type: 'range', min: time.full[0], max: time.full[1], step: (time.full[1] - time.full[0]) / 1000, 'aria-label': 'time of the pictures', id: 'scrubber'});
  const card = make('div', {class: 'card'}, make('h3', {}, 'What the cameras saw, with tracks'), slider);
  const shown = [];
  for (const run of withPictures) {
    const further = [...new Set(run.pictures.flatMap(Object.keys))].filter(key => key.startsWith('camera ')).sort();
    for (const [key, name] of [['frame', 'frame'], ['events', 'events, motion-compensated'], ...further.map(key => [key, key])]) {
      if (!run.pictures.some(picture => picture[key])) continue;
      const image = make('img', {alt: name}), caption = make('figcaption', {});
      shown.push({list: run.pictures.filter(picture => picture[key]), times: run.pictures.filter(picture => picture[key]).map(picture => picture.t), key, image, caption,
                  name: (withPictures.length > 1 ? runName(run) + ': ' : '') + name});
      card.append(make('figure', {class: 'shot'}, image, caption));
    }
  }
  const figures = make('div', {class: 'shots'}, ...card.querySelectorAll('figure'));
  card.append(figures, make('p', {class: 'hint'}, 'Orange: new corners, green: those followed for more than five images.'));
  const update = () => {
    const t = time.cursor === null ? time.full[0] + 0.5 * (time.full[1] - time.full[0]) : time.cursor;
    slider.value = t;
    for (const each of shown) {
      const picture = each.list[rowAt(each.times, t)], source = 'data:image/jpeg;base64,' + picture[each.key];
      if (each.image.src !== source) each.image.src = source;
      each.caption.textContent = each.name + ', ' + picture.t.toFixed(2) + ' s';
    }
  };
  slider.addEventListener('input', () => time.point(Number(slider.value)));
  time.listeners.push(update);
  update();
  return card;
}
