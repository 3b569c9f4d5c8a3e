#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Trains the depth network on the samples of edged_depth_samples, on one thread; or measures one on held-out scenes.

  train.py --train 'DATA/train_*.bin' --held-out DATA/held.bin --minutes 30 --out depth.pt
  train.py --held-out DATA/held.bin --evaluate depth.pt --export small.onnx
"""
import argparse
import glob
import json
import math
import pathlib
import time

import numpy as np
import torch
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
        self.voxels, self.depths, self.scenes, self.windows, self.events = [], [], [], [], []
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
            head = np.ascontiguousarray(rows[:, :12]).view(np.int32)
            self.scenes.append(head[:, 0]), self.windows.append(head[:, 1]), self.events.append(head[:, 2])
        self.file = np.concatenate([np.full(len(v), i) for i, v in enumerate(self.voxels)])
        self.row = np.concatenate([np.arange(len(v)) for v in self.voxels])
        self.scenes, self.windows = np.concatenate(self.scenes), np.concatenate(self.windows)
        self.events = np.concatenate(self.events)

    def __len__(self):
        return len(self.row)

    def batch(self, indices):
        voxels = np.stack([self.voxels[self.file[i]][self.row[i]] for i in indices])
        depths = np.stack([self.depths[self.file[i]][self.row[i]] for i in indices]).astype(np.float32) * 1e-3
        voxels = torch.from_numpy(voxels.astype(np.float32) / VOXEL_SCALE)
        return functional.avg_pool2d(voxels, SHRINK), torch.from_numpy(depths)


def augmented(voxels, depths, random):
    """Mirrors, a quarter turn, and the opposite contrast: none of them changes the depth."""
    if random.random() < 0.5:
        voxels, depths = voxels.flip(3), depths.flip(2)
    if random.random() < 0.5:
        voxels, depths = voxels.flip(2), depths.flip(1)
    if random.random() < 0.5:
        voxels, depths = voxels.transpose(2, 3), depths.transpose(1, 2)
    return (-voxels if random.random() < 0.5 else voxels), depths


def log_depth(output):
    """[N, 32, 32], in blocks of 4 x 4 pixels of the image, of the normalised output."""
    return np.log(D_MAX) + ALPHA * (functional.avg_pool2d(output, 4 // SHRINK)[:, 0] - 1.0)


def loss_of(output, depths):
    """Absolute error of log depth: of every block, and half of it again for the mean of the central region."""
    valid = (depths > 0).float()
    truth = torch.log(depths.clamp(0.25, 11.9))
    error = (log_depth(output) - truth) * valid
    dense = error.abs().sum() / valid.sum()
    centre = error[:, CENTRE, CENTRE].mean((1, 2)).abs().mean()
    return dense + 0.5 * centre


@torch.no_grad()
def central_depths(model, samples, batch=32):
    """ln of the median depth of the central region of every sample: estimated and true."""
    estimated, true = [], []
    for i in range(0, len(samples), batch):
        voxels, depths = samples.batch(range(i, min(i + batch, len(samples))))
        y = log_depth(model(voxels)[0])[:, CENTRE, CENTRE].flatten(1)
        d = depths[:, CENTRE, CENTRE].flatten(1)
        estimated.append(y.median(1).values.numpy())
        true.append(np.array([np.log(np.median(row[row > 0])) if (row > 0).any() else np.nan for row in d.numpy()]))
    return np.concatenate(estimated), np.concatenate(true)


def running_median(values):
    """Of all values before each one; the first has none and keeps itself."""
    return np.array([np.median(values[:i]) if i else values[0] for i in range(len(values))])


def report(samples, estimated, true, constant):
    """Log-depth errors on held-out scenes, beside the guesses they must beat."""
    good = np.isfinite(true)
    error = {name: guess[good] - true[good] for name, guess in (
        ("network", estimated), ("constant", np.full_like(true, constant)))}
    scenes = samples.scenes[good]
    e, t = estimated[good], true[good]
    history, within, scene_e, scene_t = np.zeros_like(e), [], [], []
    for scene in np.unique(scenes):
        m = scenes == scene
        history[m] = running_median(e[m])
        scene_e.append(np.median(e[m])), scene_t.append(np.median(t[m]))
        within.append((e[m] - e[m].mean(), t[m] - t[m].mean()))
    error["network, running median of its history"] = history - t
    print(f"{good.sum()} windows of {len(np.unique(scenes))} held-out scenes; error of ln depth of the central region")
    for name, x in error.items():
        print(f"  {name:42s} mean |e| {np.abs(x).mean():.3f}  median |e| {np.median(np.abs(x)):.3f}  rms "
              f"{np.sqrt((x * x).mean()):.3f}  bias {x.mean():+.3f}  AbsRel {np.abs(np.exp(x) - 1).mean():.3f}")
    we, wt = (np.concatenate(x) for x in zip(*within))
    print(f"  correlation of ln depth: all windows {np.corrcoef(e, t)[0, 1]:.3f}, medians of scenes "
          f"{np.corrcoef(scene_e, scene_t)[0, 1]:.3f}, within scenes {np.corrcoef(we, wt)[0, 1]:.3f}")
    return {name: float(np.sqrt((x * x).mean())) for name, x in error.items()}


def rate_at(share):
    """Of the largest rate: a short rise, then half a cosine."""
    return min(1.0, (share + 1e-3) / 0.05) * 0.5 * (1.0 + math.cos(math.pi * min(1.0, share)))


def train(arguments):
    torch.manual_seed(arguments.seed)
    random = np.random.default_rng(arguments.seed)
    model = DepthNetwork(base=arguments.base).to(memory_format=torch.channels_last)  # a third faster
    if arguments.start:
        model.load_state_dict(torch.load(arguments.start))
    optimiser = torch.optim.Adam(model.parameters(), arguments.rate)
    begin, running, step = time.time(), 0.0, 0
    while (share := (time.time() - begin) / (60.0 * arguments.minutes)) < 1.0:
        if step % 500 == 0:  # the simulation of more samples may still be going on
            samples = Samples(sorted(glob.glob(arguments.train)))
            torch.save(model.state_dict(), arguments.out)
            print(f"step {step}: loss {running:.4f}, {60 * arguments.minutes * share:.0f} s, {time.process_time():.0f} s of"
                  f" the processor, {len(samples)} samples of {len(np.unique(samples.scenes))} scenes", flush=True)
        for group in optimiser.param_groups:
            group["lr"] = arguments.rate * rate_at(share)
        voxels, depths = augmented(*samples.batch(random.integers(len(samples), size=arguments.batch)), random)
        loss = loss_of(model(voxels.contiguous(memory_format=torch.channels_last))[0], depths)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        step += 1
        running += (loss.item() - running) * max(0.005, 1.0 / step)
    constant = float(np.median(central_truths(samples, random)))
    torch.save(model.state_dict(), arguments.out)
    with open(arguments.out + ".json", "w") as f:
        json.dump({"steps": step, "samples": len(samples), "constant": constant}, f)
    print(f"{step} steps; constant guess {np.exp(constant):.2f} m, the median of the training samples")
    held = Samples(arguments.held_out)
    report(held, *central_depths(model, held), constant)


def central_truths(samples, random):
    _, depths = samples.batch(random.permutation(len(samples))[:2000])
    return np.log(np.median(depths[:, CENTRE, CENTRE].flatten(1).numpy(), axis=1).clip(0.05))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--train", help="pattern of sample files, read anew every 500 steps")
    parser.add_argument("--held-out", nargs="+", required=True)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--rate", type=float, default=2e-3, help="largest learning rate")
    parser.add_argument("--start", help="parameters to go on from")
    parser.add_argument("--base", type=int, default=8, help="channels of the first layer")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default="depth.pt")
    parser.add_argument("--evaluate", help="only measure these parameters")
    parser.add_argument("--export", help="and write them as this ONNX file")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    if not arguments.evaluate:
        return train(arguments)
    held = Samples(arguments.held_out)
    state = torch.load(arguments.evaluate)
    model = DepthNetwork(base=state["unet.head.conv2d.weight"].shape[0])
    model.load_state_dict(state)
    with open(arguments.evaluate + ".json") as f:
        errors = report(held, *central_depths(model, held), json.load(f)["constant"])
    if arguments.export:
        export(model, pathlib.Path(arguments.export), errors["network"])


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
