# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks share: recordings made once, runs of the program, what counts as a failure, and the progress bar."""
import argparse
import concurrent.futures
import csv
import datetime
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tarfile
import threading
import time

import page

ROOT = pathlib.Path(__file__).resolve().parent.parent
CACHE = pathlib.Path(os.environ.get("EDGED_CACHE", ROOT / "build"))  # holds a folder of each benchmark
DEFAULT_PROGRAM = os.environ.get("EDGED", ROOT / "build/release/bin/edged")
MODES = ["fused", "frames", "events"]
NEVER_GOOD, NOT_TRUSTED = 4, 5  # exit codes of edged run
MIRROR_RIG = "davis240c_ecd"
STREAMS = {"fused": ("events", "frames", "imu"), "frames": ("frames", "imu"), "events": ("events", "imu")}
# A run that loses its way has failed, and so has one that does not know that it has.
LEAST_COVERAGE = 0.5
WORST_SHARE_OF_PATH = 0.05
SHORTEST_PATH = 0.5  # [m] of which a share means something, as in the program
WHAT_FAILS = (f"Failed: never good, lost at the end, good for less than {LEAST_COVERAGE:.0%} of the time, or a mean error "
              f"above {WORST_SHARE_OF_PATH:.0%} of the path.")
# What decides between variants: it scatters far less between runs than the ATE.
LOCAL, LOCAL_HEAD = "local_error_3s_m", "local 3 s [mm]"
WHAT_LOCAL = "Local 3 s: RMS of the ATE of every window of 3 s aligned by itself, from 4 s on"


class ProgramError(Exception):
    """The program refused or crashed; its own words."""


def call(command, accepted=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode not in accepted:
        raise ProgramError(f"{' '.join(map(str, command))}\n{done.stderr.strip()}")
    return done.stdout


def new_parser(doc, cache=None, data=False, modes=MODES, settings=True, out=None, jobs=1, jobs_of="runs"):
    """The options that benchmarks share. cache: the name of its folder; out: what --out is where it is not given, None: there is no
    --out; jobs: how many at a time, 0: one a core, None: there is no --jobs."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edged", default=DEFAULT_PROGRAM, type=pathlib.Path,
                        help="the program [$EDGED, or build/release/bin/edged]")
    if data:
        parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("EDGED_DATA", ROOT / "../shared/data"),
                            help="folder that holds mirror/ and euroc_mh01/ [$EDGED_DATA, or ../shared/data]")
    if cache:
        parser.add_argument("--cache", default=CACHE / cache, type=pathlib.Path, help=f"recordings and run folders [build/{cache}]")
    if out is not None:
        parser.add_argument("--out", type=pathlib.Path,
                            help="file for the tables: .md, and .html beside it, or .html alone" + (f" [{out}]" if out else ""))
    if modes:
        parser.add_argument("--modes", nargs="+", default=modes, choices=MODES, metavar="MODE", help=f"[{' '.join(modes)}]")
    if settings:
        parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="option of the odometry; may be repeated")
    if jobs is not None:
        parser.add_argument("--jobs", type=int, default=jobs or os.cpu_count(),
                            help=f"{jobs_of} at a time [{jobs or 'one a core'}]")
    return parser


def check_program(edged):
    if not edged.is_file():
        sys.exit(f"{edged}: no such program; build it, or give --edged")


def begin(options, *chosen):
    """Checks the program and makes the folder options.runs, for runs of this build of it with these options."""
    check_program(options.edged)
    options.runs = options.cache / f"runs_{build_id(options.edged, *chosen)}"
    options.runs.mkdir(parents=True, exist_ok=True)


def measured(edged):
    """What a table begins with: by which program, when, with which command."""
    script = pathlib.Path(sys.argv[0]).resolve()
    name = script.relative_to(ROOT) if script.is_relative_to(ROOT) else script
    today = datetime.date.today()
    return (f"{call([edged, '--version']).strip()}, {today.day} {today:%B %Y}, "
            f"`{shlex.join([str(name), *sys.argv[1:]])}`:")


def simulated(edged, cache, preset, seed, duration=None, fresh=False, settings=(), name=None, extra=()):
    """The folder of the recording in the cache, made if it is not there or was made with other options. name: in place of
    the preset's; extra: further arguments."""
    chosen = ["--preset", preset, "--seed", str(seed), *extra]
    if duration is not None:
        chosen += ["--duration", f"{duration:g}"]
    for setting in settings:
        chosen += ["--set", setting]
    folder = cache / (f"{name or preset}_{seed}" + ("" if duration is None else f"_{duration:g}s"))
    resolved = call([edged, "simulate", *chosen, "--list"]) + "".join(f"# {argument}\n" for argument in extra)
    made_with = folder.with_name(folder.name + ".simulation.yaml")  # in the folder, `edged doctor` would wonder about it
    if not fresh and folder.is_dir() and made_with.is_file() and made_with.read_text() == resolved:
        return folder
    # Named last: an interrupted simulation is none.
    unfinished = folder.with_name(folder.name + ".unfinished")
    for old in (folder, unfinished):
        shutil.rmtree(old, ignore_errors=True)
    call([edged, "simulate", *chosen, "--out", unfinished, "--quiet"])
    made_with.write_text(resolved)
    unfinished.rename(folder)
    return folder


def all_simulated(edged, cache, flights, jobs):
    """The folders of (preset, seed, duration), in their order, `jobs` made at a time."""
    progress = Progress(len(flights))

    def simulate(flight):
        progress.step(flight, f"{flight[0]} {flight[1]} simulated")
        folder = simulated(edged, cache, *flight)
        progress.step(flight, "", done=1)
        return folder

    return in_parallel(simulate, flights, jobs, progress)


def unpacked_mirrors(data, cache):
    """Folders of the mirrors that come as archives, unpacked in the cache."""
    folders = []
    for archive in sorted((data / "mirror").glob("*.tar.xz")):
        folder = cache / archive.name.removesuffix(".tar.xz")
        if not folder.is_dir():
            unfinished = folder.with_name(folder.name + ".unfinished")
            with tarfile.open(archive) as tar:
                tar.extractall(unfinished)
            (unfinished / folder.name).rename(folder)
            unfinished.rmdir()
        folders.append(folder)
    return folders


def data_recordings(data, cache):
    """(name, path, rig) of the mirrors, unpacked in the cache, and of EuRoC's MH_01, as far as they are there."""
    mirrors = [*unpacked_mirrors(data, cache), *sorted((data / "mirror").glob("*.h5"))]
    found = [(path.stem, path, MIRROR_RIG) for path in mirrors]
    if (data / "euroc_mh01").is_dir():
        found.append(("euroc_mh01", data / "euroc_mh01", None))
    return found


def calibration_option(rig):
    """rig: the name of one that ships, the path of a file, or None where the recording brings its own."""
    return [] if rig is None else ["--calib" if isinstance(rig, pathlib.Path) else "--rig", rig]


def info(edged, cache, path, rig, extra=()):
    """What `edged info` says of a recording; kept in the cache. extra: further arguments that say what is read."""
    read = "".join(map(str, extra))
    known = cache / "info" / f"{file_name(str(path.resolve()) + read)}_{path.stat().st_mtime_ns}.json"
    if not known.exists():
        known.parent.mkdir(parents=True, exist_ok=True)
        known.write_text(call([edged, "info", path, "--json", "--quiet", *calibration_option(rig), *extra]))
    return json.loads(known.read_text())


def extent(edged, cache, path, rig, modes, extra=()):
    """Begin of the recording [s], and from when to when all streams are there that a mode needs, by mode, of those that it has
    sensors for. extra: as of info."""
    streams = info(edged, cache, path, rig, extra)
    there = {kind: streams[kind] for kind in ("events", "frames", "imu") if streams[kind]["count"] > 0}
    return 1e-9 * min((stream["begin_ns"] for stream in there.values()), default=0), {
        mode: (1e-9 * max(there[kind]["begin_ns"] for kind in STREAMS[mode]),
               1e-9 * min(there[kind]["end_ns"] for kind in STREAMS[mode]))
        for mode in modes if there.keys() >= set(STREAMS[mode])}


def build_id(edged, *options):
    """Names the build of the program and the options of its runs: runs of another are kept apart."""
    return hashlib.sha256(edged.read_bytes() + repr(options).encode()).hexdigest()[:8]


def estimate(edged, recording, mode, out, settings=(), rig=None, extra=()):
    """Runs the odometry, with extra arguments; the content of metrics.json. An earlier run in out is replaced."""
    if (out / "config_resolved.yaml").exists():  # not by --force: `sweep --against` runs builds that do not know it
        shutil.rmtree(out)
    command = [edged, "run", recording, "--mode", mode, "--out", out, "--json", "--quiet", *extra]
    command += calibration_option(rig)
    for setting in settings:
        command += ["--set", setting]
    return json.loads(call(command, accepted=(0, NEVER_GOOD, NOT_TRUSTED)))


def estimate_once(edged, recording, mode, out, settings=(), rig=None, extra=()):
    """The same; a run that is finished is kept. One that Ctrl-C ended has written its metrics, too."""
    written = out / "metrics.json"
    metrics = json.loads(written.read_text()) if written.exists() else None
    finished = metrics is not None and metrics["status"] != "interrupted"
    return metrics if finished else estimate(edged, recording, mode, out, settings, rig, extra)


def state_rows(folder):
    """The rows of states.csv, one a packet: texts by column."""
    with open(folder / "states.csv", encoding="utf-8") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


def read_states(folder):
    """(seconds, status, position) of every packet."""
    return [(1e-9 * int(row["t_ns"]), row["status"],
             tuple(float(row[key]) for key in ("px_m", "py_m", "pz_m")) if row["px_m"] else None) for row in state_rows(folder)]


def failure(metrics):
    """Why the run counts as failed; empty when it does not."""
    evaluation = metrics["evaluation"]
    if evaluation is None or metrics["first_good_s"] is None:
        return "never good"
    if metrics["status"] not in ("good", "degraded"):
        return "lost at the end"
    if metrics["coverage"] < LEAST_COVERAGE:
        return f"coverage {metrics['coverage']:.0%}"
    share = evaluation["ate_m"]["mean"] / max(evaluation["path_length_m"], SHORTEST_PATH)
    return f"error {share:.1%} of the path" if share > WORST_SHARE_OF_PATH else ""


def scored(runs, key):
    """The figures of the runs that have not failed and have one: a short run has no local error."""
    return [metrics[key] for metrics in runs if not failure(metrics) and metrics[key] is not None]


def file_name(text):
    return re.sub(r"[^\w.+]+", "_", text)


def clock(seconds):
    minutes = int(seconds) // 60
    return f"{minutes // 60}:{minutes % 60:02d} h" if minutes >= 60 else f"{minutes}:{int(seconds) % 60:02d} min"


class Progress:
    """Done of total in percent, time taken and left: a bar on a terminal that is written over; in a file, a line each."""

    def __init__(self, total):
        self.total, self.done, self.begin = total, 0, time.monotonic()
        self.active, self.lock = {}, threading.Lock()

    def step(self, job, what, done=0):
        """The job is now at `what` (empty: it has ended), with `done` more pieces of work behind it."""
        with self.lock:
            self.done += done
            self.active.pop(job, None)
            if what:
                self.active[job] = what
            print(self.line(), end="" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)

    def line(self):
        elapsed = time.monotonic() - self.begin
        left = f", {clock(elapsed / self.done * (self.total - self.done))} left" if self.done else ""
        text = f"{100 * self.done // max(1, self.total)} %, {self.done} of {self.total}, {clock(elapsed)}{left}: {', '.join(self.active.values())}"
        if not sys.stderr.isatty():
            return text
        filled = 20 * self.done // max(1, self.total)
        return f"\r\033[K[{'#' * filled}{'.' * (20 - filled)}] {text}"[:shutil.get_terminal_size().columns + 3]

    def finish(self):
        if sys.stderr.isatty():
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def in_parallel(work, items, jobs, progress):
    """work(item) of every item, in their order, `jobs` at a time. A program error or Ctrl-C ends the program after the
    runs in hand."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(work, item) for item in items]
        try:
            for future in concurrent.futures.as_completed(futures):
                future.result()
            return [future.result() for future in futures]
        except BaseException as error:
            pool.shutdown(wait=True, cancel_futures=True)
            progress.finish()
            sys.exit(str(error) if isinstance(error, ProgramError) else 130)
        finally:
            progress.finish()


def markdown(rows):
    """Lines of a table whose first row is the head and whose second row holds the alignment."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in rows]


def write_table(file, text):
    """A benchmark's report as Markdown with an html page beside it; with that alone where the file is named so."""
    file.parent.mkdir(parents=True, exist_ok=True)
    if file.suffix != ".html":
        file.write_text(text)
    file.with_suffix(".html").write_text(page.page(text))


def put(options, text, default=None):
    """Prints a report, and writes it into the file of --out."""
    print(text, end="")
    if options.out or default:
        write_table(options.out or default, text)
