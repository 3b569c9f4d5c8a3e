// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The page of a live run: the same sections, filled by updates of the program, until the report replaces them.
'use strict';

const kLiveSays = {
  Good: ['Running, with a good pose.', 'good'],
  Degraded: ['Running; its poses are less certain now.', 'degraded'],
  Lost: ['Tracking is lost; it initializes again.', 'lost'],
  Initializing: ['Initializing; there is no pose yet.', 'initializing'],
};
const kPictures = {frame: 'frame', events: 'events, motion-compensated'};

/** A run without data, in the format of the report. */
function emptyRun(about) {
  const columns = ['t', 'status', 'x', 'y', 'z', 'roll', 'pitch', 'yaw', 'vx', 'vy', 'vz', 'bgx', 'bgy', 'bgz', 'bax', 'bay', 'baz', 'keyframe',
                   'event_tracks', 'frame_tracks', 'landmarks', 'event_track_survival_rate', 'frame_track_survival_rate', 'map_matches', 'map_reach', 'event_rate', 'depth',
                   'processing', 'latency', 'sigma3_x', 'sigma3_y', 'sigma3_z'];
  return {name: about.recording, folder: '', is_file: false, metrics: null, live: about, frame: about.frame, evaluation: null,
          rows: Object.fromEntries(columns.map(name => [name, []])), pose_errors: {}, truth: [], map: [], dense: about.dense ? new GrowingCloud() : null,
          voxels: about.voxels ? {xyz: new Float32Array(0), grey: new Uint8Array(0), all: 0} : null, changes: [], pictures: []};
}

/** Adds new rows and changes; also the newest row, even if it is not kept. */
function takeUpdate(run, update) {
  const rows = run.rows, from = update.rows_from;
  for (const [name, values] of Object.entries(update.rows)) rows[name].splice(from, Infinity, ...values);
  const last = rows.t[rows.t.length - 1];
  if (last !== undefined && update.t > last) {
    for (const [name, values] of Object.entries(update.newest)) rows[name].push(values[0]);
  }
  run.changes.splice(update.changes_from, Infinity, ...update.changes);
  if (update.map) run.map.splice(0, Infinity, ...update.map);
  if (update.dense) run.dense.take(update.dense);
  if (update.voxels) run.voxels = {...update.voxels, ...unpacked(update.voxels)};
}

/** Name by name; null is left out. */
function liveFacts(run, update) {
  const p = update.progress, now = name => update.newest[name][0];
  const three = (names, decimals) => now(names[0]) === null ? null : names.map(name => now(name).toFixed(decimals)).join(', ');
  const tracks = [];
  if (run.live.mode !== 'frames') tracks.push(now('event_tracks') + ' on events');
  if (run.live.mode !== 'events') tracks.push(now('frame_tracks') + ' on frames');
  return [
    ['time', number(update.t, 's', 1) + (run.live.whole_s ? ' of ' + number(run.live.whole_s, 's', 1) : '')],
    ['position [m]', three(['x', 'y', 'z'], 3)],
    ['velocity [m/s]', three(['vx', 'vy', 'vz'], 2)],
    ['tracks', tracks.join(', ') + ', ' + now('landmarks') + ' landmarks'],
    ['processing per packet', number(now('processing'), 'ms', 1)],
    ['latency', number(now('latency'), 'ms', 1)],
    ['event rate', run.live.mode === 'frames' ? null : valueText(now('event_rate')) + ' 1/s'],
    ['scene depth', number(now('depth'), 'm', 2)],
    ['poses, keyframes', p.poses + ', ' + p.keyframes],
    ['losses', p.times_lost === 0 ? 'none' : String(p.times_lost)],
    ['coverage', number(100 * p.coverage, '% of the time Good', 1)],
    ['first good pose', p.first_good_s === null ? 'not yet' : 'after ' + number(p.first_good_s, 's', 2)],
    ['speed', number(p.real_time_factor, '× real time', 2)],
    ['pose of', run.frame === 'body' ? 'the body (IMU)' : 'camera ' + run.frame],
    ['skipped here', update.left_out === 0 ? null : update.left_out + ' updates: this browser was too slow for them'],
  ];
}

/** The present state; returns the card and its update function. */
function liveCard(run) {
  const says = make('p', {class: 'says', role: 'status'}, 'Starting.'), why = make('p', {}), list = make('dl', {class: 'facts'});
  const card = make('article', {class: 'card verdict', id: 'live'}, make('h3', {}, make('i', {class: 'swatch', c: runColour(0)}), fullName(run)), says, why, list);
  const say = (text, ink) => {
    if (says.textContent !== text) says.textContent = text;
    card.style.setProperty('--verdict', 'var(--' + ink + ')');
  };
  return [card, say, update => {
    const [text, ink] = kLiveSays[update.status], overload = update.progress.overload;
    overload ? say(text + ' Too slow: ' + overload + '.', ink === 'lost' ? ink : 'degraded') : say(text, ink);
    why.textContent = update.reason;
    list.replaceChildren(...liveFacts(run, update).flatMap(([name, value]) => value === null ? [] : [make('div', {}, make('dt', {}, name), make('dd', {}, value))]));
  }];
}

/** The newest images: each is requested when the one before has arrived. */
function livePictures() {
  const figures = make('div', {class: 'shots'}), shown = {};
  const card = make('div', {class: 'card'}, make('h3', {}, 'What the cameras see, with tracks'), figures,
                    make('p', {class: 'hint'}, 'Orange: new corners, green: those followed for more than five images.'));
  return [card, update => {
    for (const [key, number] of Object.entries(update.pictures)) {
      const name = kPictures[key] || 'camera ' + key;
      if (number === 0 || (shown[key] && (shown[key].number === number || !shown[key].image.complete))) continue;
      if (!shown[key]) {
        shown[key] = {image: make('img', {alt: name})};
        figures.append(make('figure', {class: 'shot'}, shown[key].image, make('figcaption', {}, name)));
      }
      shown[key].number = number;
      shown[key].image.src = encodeURIComponent(key) + '.jpg?' + number;
    }
  }];
}

/** Replaces the page by the report of the run. */
async function showReport(say, metrics) {
  try {
    const answer = await fetch('report.html');
    if (!answer.ok) throw new Error(answer.statusText);
    const page = new DOMParser().parseFromString(await answer.text(), 'text/html');
    buildPage(JSON.parse(page.getElementById('data').textContent));
    document.getElementById('footer').textContent += ' The run has ended; this page is saved as ' + metrics.folder + '/report.html.';
  } catch (error) {
    say(metrics.verdict + '; the report is ' + metrics.folder + '/report.html.', inkOf(metrics));
  }
}

function buildLive(data) {
  const run = emptyRun(data);
  clearPage({version: data.version, runs: [run]});
  const [card, say, fillCard] = liveCard(run), [path, refresh] = pathCard(), [pictures, fillPictures] = livePictures();
  section('In plain words', make('div', {class: 'cards'}, card));
  section('Path', make('div', {class: 'pair'}, path, pictures));
  plotSection();
  const fillTimes = timelineSection();
  document.getElementById('footer').textContent = 'Sent by edged ' + data.version + '. Times count from the first packet.';
  refresh();
  time.listeners.push(moveMarks);
  applyTheme();
  let rested = 0;
  watch(run, say, update => {
    fillCard(update);
    fillPictures(update);
    const begin = performance.now();
    if (begin < rested) return;
    fillTimes();
    refresh();
    time.grow(update.t);
    rested = performance.now() + 5 * (performance.now() - begin);  // plots take a sixth of the browser's time at most
  });
}

/** Processes updates; a hidden page draws nothing and requests no images. */
function watch(run, say, draw) {
  const source = new EventSource('events');
  let newest = null;
  const drawNewest = () => { if (newest && !document.hidden) draw(newest); };
  source.addEventListener('message', event => {
    newest = JSON.parse(event.data);
    takeUpdate(run, newest);
    drawNewest();
  });
  document.addEventListener('visibilitychange', () => { if (source.readyState !== EventSource.CLOSED) drawNewest(); });
  source.addEventListener('end', async event => {
    const metrics = JSON.parse(event.data);
    await showReport(say, metrics);
    source.close();
  });
  source.addEventListener('error', () => {
    say('The program does not answer; its last data is below. This page continues when it answers again.', 'lost');
  });
}

begin(buildLive);
