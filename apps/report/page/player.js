// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The page of `edged show`: plays event images beside the frames of their time, above the event rate.
'use strict';

const kSpeeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10];
const kInk = Array.from({length: 511}, (_, n) => 1 - Math.pow(2, -n));  // one event gives half of it

/** Red, green, blue of a colour of report.css. */
function rgb(name) {
  const value = parseInt(colour(name).slice(1), 16);
  return [value >> 16, value >> 8 & 255, value & 255];
}

/** Draws one image on a canvas: its grey levels are counts, positive ones above the negative ones. */
class EventScreen {
  constructor(canvas) {
    this.canvas = canvas;
    this.store = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
    this.style = 'polarity';
    this.counts = null;
  }
  async load(png) {
    const image = this.image = new Image();
    image.src = 'data:image/png;base64,' + png;
    await image.decode();
    if (this.image !== image) return;  // a later one has been requested
    const width = image.naturalWidth, height = image.naturalHeight / 2;
    this.store.canvas.width = this.canvas.width = width;
    this.store.canvas.height = 2 * height;
    this.canvas.height = height;
    this.store.drawImage(image, 0, 0);
    this.counts = this.store.getImageData(0, 0, width, 2 * height).data;
    this.draw();
  }
  draw() {
    if (!this.counts) return;
    const context = this.canvas.getContext('2d'), out = context.createImageData(this.canvas.width, this.canvas.height);
    const paper = rgb('card'), inks = this.style === 'counts' ? [rgb('ink'), rgb('ink')] : [rgb('run0'), rgb('lost')];
    const half = out.data.length;
    for (let i = 0; i < half; i += 4) {
      const up = this.counts[i], down = this.counts[half + i], ink = kInk[up + down], c = inks[up >= down ? 0 : 1];
      for (let k = 0; k < 3; ++k) out.data[i + k] = paper[k] + ink * (c[k] - paper[k]);
      out.data[i + 3] = 255;
    }
    context.putImageData(out, 0, 0);
  }
}

/** Plays the time of the page. */
class Playing {
  constructor(button) {
    this.button = button;
    this.speed = 1;
    this.on = false;
    button.addEventListener('click', () => this.toggle());
  }
  toggle() {
    this.on = !this.on;
    this.button.textContent = this.on ? 'Pause' : 'Play';
    if (!this.on) return;
    if (time.cursor === null || time.cursor >= time.full[1]) time.point(time.full[0]);
    let before = performance.now();
    const go = now => {
      if (!this.on) return;
      time.point(time.cursor + this.speed * Math.max(0, now - before) / 1000);
      before = now;
      if (time.cursor >= time.full[1]) this.toggle(); else requestAnimationFrame(go);
    };
    requestAnimationFrame(go);
  }
}

function choice(label, values, chosen, change) {
  const select = make('select', {'aria-label': label}, ...values.map(([value, text]) => make('option', {value}, text)));
  select.value = chosen;
  select.addEventListener('change', () => change(select.value));
  return [make('label', {}, label, select), select];
}

function playerFacts(data) {
  const each = data.events_each ? data.events_each + ' events each' : 'of ' + number(1e3 * data.window_s, 'ms', 1);
  const all = data.pictures.reduce((sum, picture) => sum + picture.events, 0);
  return [
    ['recording', data.recording + ' (' + data.format + ')'],
    ['sensor', data.sensor.join(' × ') + ' px' + (data.binning > 1 ? ', ' + data.binning + ' × ' + data.binning + ' pixels summed here' : '')],
    ['pictures', data.pictures.length + ', ' + each + (data.every > 1 ? ', one of ' + data.every + ' kept (--max-mb); a shorter part (--start, --duration) keeps more' : '')],
    ['events', valueText(all) + ' in them'],
    ['frames', String(data.frames.length || 'none')],
  ];
}

/** The two images at the cursor's time, and their controls. */
function playerCard(data) {
  const events = make('canvas', {id: 'events', role: 'img', 'aria-label': 'events'}), eventsCaption = make('figcaption', {});
  const frame = make('img', {alt: 'frame', id: 'frame'}), frameCaption = make('figcaption', {});
  const slider = make('input', {type: 'range', id: 'scrubber', 'aria-label': 'time', min: time.full[0], max: time.full[1], step: 'any'});
  const button = make('button', {type: 'button', id: 'play'}, 'Play'), playing = new Playing(button), screen = new EventScreen(events);
  const [speedLabel, speed] = choice('speed', kSpeeds.map(value => [value, value + ' ×']), 1, value => { playing.speed = Number(value); });
  const [styleLabel, style] = choice('events as', [['polarity', 'polarity'], ['counts', 'counts']], data.style, value => { screen.style = value; screen.draw(); });
  screen.style = data.style;
  const begins = data.pictures.map(picture => picture.begin);
  const liveliest = data.pictures.reduce((best, picture) => picture.events > best.events ? picture : best).begin;
  let shown = null;
  const show = () => {
    const t = time.cursor === null ? liveliest : time.cursor, i = rowAt(begins, t), picture = data.pictures[i];
    slider.value = t;
    if (shown === i || !picture) return;
    shown = i;
    screen.load(picture.png);
    eventsCaption.textContent = valueText(picture.events) + ' events, ' + picture.begin.toFixed(3) + ' to ' + picture.t.toFixed(3) + ' s';
    const still = data.frames[picture.frame];
    if (!still) return;
    frame.src = 'data:image/jpeg;base64,' + still.jpeg;
    frameCaption.textContent = 'frame of ' + still.t.toFixed(3) + ' s';
  };
  const step = by => {
    if (playing.on) playing.toggle();
    time.point(begins[Math.min(Math.max(shown + by, 0), begins.length - 1)]);
  };
  const faster = by => {
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), kSpeeds.length - 1);
    playing.speed = Number(speed.value);
  };
  const keys = {' ': () => playing.toggle(), ',': () => step(-1), '.': () => step(1), '[': () => faster(-1), ']': () => faster(1),
                p: () => { style.selectedIndex = 1 - style.selectedIndex; style.dispatchEvent(new Event('change')); }};
  document.addEventListener('keydown', event => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || (event.key === ' ' && event.target.tagName === 'BUTTON')) return;
    event.preventDefault();
    keys[event.key]();
  });
  slider.addEventListener('input', () => time.point(Number(slider.value)));
  time.listeners.push(show);
  space = screen;  // redrawn after a change of the theme
  return make('div', {class: 'card player'},
              make('div', {class: 'shots'}, make('figure', {}, events, eventsCaption), data.frames.length ? make('figure', {}, frame, frameCaption) : null),
              slider, make('div', {class: 'tools'}, button, speedLabel, styleLabel),
              make('p', {class: 'hint'}, 'Polarity: blue where brighter, red where darker; more events give a stronger colour. ' +
                   'Keys: space plays and pauses, comma and full stop step by one picture, [ and ] change the speed, p the colours.'));
}

function buildPlayer(data) {
  clearPage({version: data.version, runs: []});
  document.title = data.recording + ' – Edged player';
  document.getElementById('title').textContent = data.recording;
  const facts = make('dl', {class: 'facts'}, ...playerFacts(data).map(([name, value]) => make('div', {}, make('dt', {}, name), make('dd', {}, value))));
  document.getElementById('footer').textContent = 'Written by edged ' + data.version + '. Times count from the first picture.';
  if (!data.pictures.length) return void section('No events', make('div', {class: 'card'}, facts));
  const last = data.pictures[data.pictures.length - 1];
  time = new TimeGroup(0, last.t);
  section('What the event camera saw', playerCard(data));
  const plots = make('div', {class: 'plots alone'});
  section('Over time', plots, make('p', {class: 'hint'}, 'A click jumps there. Drag zooms, a double click shows all; keys: arrows, + − and Home.'));
  const rate = data.pictures.map(picture => picture.events / Math.max(1e-6, picture.t - picture.begin));
  new TimePlot(time, {title: 'event rate', unit: '1/s', zero: true, series: [{t: data.pictures.map(picture => picture.begin), y: rate, label: '', colour: 'run0'}]}, plots);
  section('The recording', make('div', {class: 'card'}, facts));
  applyTheme();
  time.tell();
}

begin(buildPlayer);
