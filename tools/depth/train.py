#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Trains the depth network on the samples of edged_depth_samples, on one thread; or measures one on held-out scenes.

  train.py --train 'DATA/train_*.bin' --minutes 30 --out small.pt
  train.py --train 'DATA/train_*.bin' --minutes 60 --out r.pt --start small.pt --memories 1 --sequence 20 --chunks 3 --batch 8
  train.py --held-out DATA/held.bin --evaluate small.pt --export small.onnx
"""
import argparse
import glob
import json
import math
import pathlib
import time

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch.nn import functional

from network import DepthNetwork
from onnx_graph import write_onnx

D_MAX, ALPHA = 12.0, 3.9  # y = 1 + ln(depth / D_MAX) / ALPHA: 0.24 m to 12 m
VOXEL_SCALE = 16.0
FOCAL_PX = 199.54  # of the simulated camera
SHRINK = 2  # the network sees the mean of 2 x 2 pixels: a quarter of the work, and finer detail is no help
CENTRE = slice(8, 24)  # of the 32 x 32 depth blocks: the central half of each side


class Samples:
    """Files of edged_depth_samples, mapped into memory."""

    def __init__(self, files):
        self.voxels, self.depths, self.scenes, self.windows = [], [], [], []
        for file in files:
            with open(file, "rb") as f:
                header = f.read(24)
            if header[:8] != b"EDGEDVX1":
                raise SystemExit(f"{file}: no file of edged_depth_samples")
            bins, side, depth_side, size = np.frombuffer(header, np.int32, 4, 8)
            rows = np.memmap(file, np.uint8, "r", 24)
            rows = rows[: len(rows) // size * size].reshape(-1, size)
            self.voxels.append(rows[:, 16 : 16 + bins * side * side].view(np.int8).reshape(-1, bins, side, side))
            self.depths.append(rows[:, 16 + bins * side * side :].view(np.uint16).reshape(-1, depth_side, depth_side))
            head = np.ascontiguousarray(rows[:, :8]).view(np.int32)
            self.scenes.append(head[:, 0]), self.windows.append(head[:, 1])
        self.file = np.concatenate([np.full(len(v), i) for i, v in enumerate(self.voxels)])
        self.row = np.concatenate([np.arange(len(v)) for v in self.voxels])
        self.scenes, self.windows = np.concatenate(self.scenes), np.concatenate(self.windows)

    def __len__(self):
        return len(self.row)

    def by_scene(self):
        """The samples of each scene, in the order of time."""
        order = np.lexsort((self.windows, self.scenes))
        return np.split(order, np.flatnonzero(np.diff(self.scenes[order])) + 1)

    def batch(self, indices):
        voxels = np.stack([self.voxels[self.file[i]][self.row[i]] for i in indices])
        depths = np.stack([self.depths[self.file[i]][self.row[i]] for i in indices]).astype(np.float32) * 1e-3
        voxels = torch.from_numpy(voxels.astype(np.float32) / VOXEL_SCALE)
        return functional.avg_pool2d(voxels, SHRINK), torch.from_numpy(depths)


class Streams:
    """Random stretches of scenes, `count` beside each other, handed out `length` windows at a time, `chunks` times each."""

    def __init__(self, samples, random, count, length, chunks):
        self.samples, self.random, self.length, self.chunks = samples, random, length, chunks
        self.scenes = [scene for scene in samples.by_scene() if len(scene) >= length]
        self.left, self.turned = [[] for _ in range(count)], [None] * count

    def start(self, k):
        scene = self.scenes[self.random.integers(len(self.scenes))]
        longest = min(len(scene) // self.length, self.chunks) * self.length
        begin = self.random.integers(len(scene) - longest + 1)
        self.left[k] = list(scene[begin : begin + longest])
        # Mirrors, a quarter turn, and the opposite contrast: none of them changes the depth.
        self.turned[k] = self.random.random(4) < 0.5

    def next(self):
        """voxels [length, count, bins, H, W], depths likewise, and which of the streams begin."""
        fresh = [not left for left in self.left]
        parts = []
        for k, begins in enumerate(fresh):
            if begins:
                self.start(k)
            voxels, depths = self.samples.batch(self.left[k][: self.length])
            del self.left[k][: self.length]
            mirror_x, mirror_y, turn, negative = self.turned[k]
            axes = [axis for axis, mirrored in ((-1, mirror_x), (-2, mirror_y)) if mirrored]
            voxels, depths = voxels.flip(axes), depths.flip(axes)
            if turn:
                voxels, depths = voxels.transpose(-2, -1), depths.transpose(-2, -1)
            parts.append((-voxels if negative else voxels, depths))
        return *(torch.stack(x, 1) for x in zip(*parts)), torch.tensor(fresh)


def log_depth(output):
    """[N, 32, 32], in blocks of 4 x 4 pixels of the image, of the normalised output."""
    return np.log(D_MAX) + ALPHA * (functional.avg_pool2d(output, 4 // SHRINK)[:, 0] - 1.0)


def loss_of(outputs, depths):
    """Absolute error of log depth: of every block, and half of it again for the mean of the central region; in a
    sequence, once more for what this mean does about its own average over the sequence. outputs, depths: a window each."""
    dense, centre = 0.0, []
    for output, depth in zip(outputs, depths):
        valid = (depth > 0).float()
        error = (log_depth(output) - torch.log(depth.clamp(0.25, 11.9))) * valid
        dense = dense + error.abs().sum() / valid.sum().clamp(min=1.0) / len(outputs)
        centre.append(error[:, CENTRE, CENTRE].mean((1, 2)))
    centre = torch.stack(centre)
    return dense + 0.5 * centre.abs().mean() + (centre - centre.mean(0)).abs().mean()


@torch.no_grad()
def central_depths(model, samples):
    """ln of the median depth of the central region of every sample: estimated (a recurrent network follows each scene from
    its first window) and true."""
    estimated, true = np.zeros(len(samples)), np.full(len(samples), np.nan)
    for indices in samples.by_scene():
        states = None
        for i in indices:
            voxels, depths = samples.batch([i])
            output, states = model(voxels, states)
            estimated[i] = log_depth(output)[:, CENTRE, CENTRE].median()
            d = depths[:, CENTRE, CENTRE]
            if (d > 0).any():
                true[i] = np.log(np.median(d[d > 0]))
    return estimated, true


def running_median(values):
    """Of all values before each one; the first has none and keeps itself."""
    return np.array([np.median(values[:i]) if i else values[0] for i in range(len(values))])


def smoothed(values, seconds):
    """Paper Eq. 4 as DepthFilter applies it, for windows of 50 ms."""
    share, out = 1.0 - math.exp(-0.05 / seconds), [values[0]]
    for value in values[1:]:
        out.append(share * value + (1.0 - share) * out[-1])
    return np.array(out)


def report(samples, estimated, true, constant):
    """Log-depth errors on held-out scenes, beside the guesses they must beat; and again with each scene's mean error taken
    away, which leaves how well the changes within a scene are followed."""
    good = np.isfinite(true)
    scenes, truth = samples.scenes[good], true[good]
    guesses = {"network": estimated[good], "constant": np.full_like(truth, constant)}
    rows = [np.flatnonzero(scenes == scene) for scene in np.unique(scenes)]
    for name, of in (("network, running median of its history", running_median),
                     ("network, Eq. 4 with 0.5 s", lambda x: smoothed(x, 0.5))):
        guesses[name] = np.zeros_like(truth)
        for r in rows:
            guesses[name][r] = of(guesses["network"][r])
    print(f"{len(truth)} windows of {len(rows)} held-out scenes; error of ln depth of the central region; within: without "
          "the mean error of each scene")
    for name, guess in guesses.items():
        x = guess - truth
        within = np.concatenate([x[r] - x[r].mean() for r in rows])
        print(f"  {name:42s} mean |e| {np.abs(x).mean():.3f}  median |e| {np.median(np.abs(x)):.3f}  rms "
              f"{np.sqrt((x * x).mean()):.3f}  bias {x.mean():+.3f}  AbsRel {np.abs(np.exp(x) - 1).mean():.3f}  within: "
              f"mean |e| {np.abs(within).mean():.3f}  rms {np.sqrt((within * within).mean()):.3f}")
    e = guesses["network"]
    medians = np.array([(np.median(e[r]), np.median(truth[r])) for r in rows])
    within = np.concatenate([np.stack([e[r] - e[r].mean(), truth[r] - truth[r].mean()], 1) for r in rows])
    print(f"  correlation of ln depth: all windows {np.corrcoef(e, truth)[0, 1]:.3f}, medians of scenes "
          f"{np.corrcoef(medians.T)[0, 1]:.3f}, within scenes {np.corrcoef(within.T)[0, 1]:.3f}")
    return float(np.sqrt(((e - truth) ** 2).mean()))


def rate_at(share):
    """Of the largest rate: a short rise, then half a cosine."""
    return min(1.0, (share + 1e-3) / 0.05) * 0.5 * (1.0 + math.cos(math.pi * min(1.0, share)))


def kept(states, fresh):
    """What a recurrent network knows of the streams that go on; nothing of those that begin. Gradients end here."""
    go_on = (~fresh).float().view(-1, 1, 1, 1)
    return [tuple(x.detach() * go_on for x in state) for state in states] if states else None


def train(arguments):
    torch.manual_seed(arguments.seed)
    random = np.random.default_rng(arguments.seed)
    model = DepthNetwork(base=arguments.base, memories=arguments.memories).to(memory_format=torch.channels_last)  # faster
    if arguments.start:
        print(f"{warm_start(model, read_parameters(arguments.start))} tensors of {arguments.start}")
    optimiser = torch.optim.Adam(model.parameters(), arguments.rate)
    begin, running, step, states = time.time(), 0.0, 0, None
    while (share := (time.time() - begin) / (60.0 * arguments.minutes)) < 1.0:
        if step % 200 == 0:  # the simulation of more samples may still be going on
            samples = Samples(sorted(glob.glob(arguments.train)))
            streams = Streams(samples, random, arguments.batch, arguments.sequence, arguments.chunks)
            torch.save(model.state_dict(), arguments.out)
            print(f"step {step}: loss {running:.4f}, {60 * arguments.minutes * share:.0f} s, {time.process_time():.0f} s of"
                  f" the processor, {len(samples)} samples of {len(samples.by_scene())} scenes", flush=True)
        for group in optimiser.param_groups:
            group["lr"] = arguments.rate * rate_at(share)
        voxels, depths, fresh = streams.next()
        states = kept(states, fresh)
        outputs = []
        for window in voxels:
            output, states = model(window.contiguous(memory_format=torch.channels_last), states)
            outputs.append(output)
        loss = loss_of(outputs, depths)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        step += 1
        running += (loss.item() - running) * max(0.005, 1.0 / step)
    torch.save(model.state_dict(), arguments.out)
    print(f"{step} steps of {arguments.batch} sequences of {arguments.sequence} windows; constant guess, the median of the "
          f"training samples: {np.exp(constant_guess(samples, random)):.3f} m")


def constant_guess(samples, random):
    _, depths = samples.batch(random.permutation(len(samples))[:2000])
    return float(np.median(np.log(np.median(depths[:, CENTRE, CENTRE].flatten(1).numpy(), axis=1).clip(0.05))))


def read_parameters(file):
    """Name -> tensor, of a file of --out or of an exported model."""
    if file.endswith(".onnx"):
        return {t.name: torch.from_numpy(numpy_helper.to_array(t).copy()) for t in onnx.load(file).graph.initializer}
    return torch.load(file)


def warm_start(model, parameters):
    """Takes over every tensor that fits: a recurrent network can go on from one without memory. Returns how many."""
    def plain(name):
        return name.replace("unetrecurrent", "unet").replace(".conv.conv2d", ".conv2d")

    given = {plain(name): p for name, p in parameters.items()}
    state, taken = model.state_dict(), {}
    for name, old in state.items():
        new = given.get(plain(name))
        if new is not None and new.shape == old.shape:
            taken[name] = new
    model.load_state_dict({**state, **taken})
    return len(taken)


def read_model(file):
    parameters = read_parameters(file)
    memories = sum(name.endswith("Gates.weight") for name in parameters)
    head = next(p for name, p in parameters.items() if name.endswith("head.conv2d.weight"))
    model = DepthNetwork(base=head.shape[0], memories=memories)
    if warm_start(model, parameters) != len(model.state_dict()):
        raise SystemExit(f"{file}: not a network of this program")
    return model.eval()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--train", help="pattern of sample files, read anew every 200 steps")
    parser.add_argument("--held-out", nargs="+", help="sample files, to measure on")
    parser.add_argument("--constant", type=float, default=1.83, help="the guess to compare with [m]; training prints one")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--memories", type=int, default=0, help="ConvLSTMs, in the deepest encoders")
    parser.add_argument("--sequence", type=int, default=1, help="windows of each scene a step follows")
    parser.add_argument("--chunks", type=int, default=1, help="steps that a recurrent network keeps its state for")
    parser.add_argument("--batch", type=int, default=16, help="scenes a step")
    parser.add_argument("--rate", type=float, default=2e-3, help="largest learning rate")
    parser.add_argument("--start", help="parameters to go on from: a file of --out, or .onnx")
    parser.add_argument("--base", type=int, default=8, help="channels of the first layer")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default="depth.pt")
    parser.add_argument("--evaluate", help="only measure these parameters, likewise")
    parser.add_argument("--export", help="and write them as this ONNX file")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    if not arguments.evaluate:
        return train(arguments)
    model, held = read_model(arguments.evaluate), Samples(arguments.held_out)
    sigma_ln = report(held, *central_depths(model, held), math.log(arguments.constant))
    if arguments.export:
        export(model, pathlib.Path(arguments.export), sigma_ln)


def export(model, path, sigma_ln):
    """The ONNX file and the json beside it, which says how its input is made and its output read."""
    parameters = {name: p.detach().numpy() for name, p in model.named_parameters()}
    info = write_onnx(parameters, path, "tools/depth/train.py; Apache-2.0")
    info = {"name": path.stem, "note": "trained by this project on simulated scenes, see docs/depth_model.md",
            "shrink": SHRINK, **info, "d_max_m": D_MAX, "alpha": ALPHA, "focal_px": FOCAL_PX, "window_s": 0.05,
            "sigma_ln": round(sigma_ln, 2)}
    path.with_suffix(".json").write_text(json.dumps(info, indent=1) + "\n")


if __name__ == "__main__":
    main()
