#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Makes the tiny networks of network_test.cpp, with what torch computes for a fixed input: src/edged/depth/testdata."""
import json
import pathlib

import numpy as np
import torch

from network import DepthNetwork
from onnx_graph import write_onnx

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "src" / "edged" / "depth" / "testdata"


def fixed_grid(step, height=16, width=24):
    b, y, x = np.meshgrid(np.arange(5), np.arange(height), np.arange(width), indexing="ij")
    grid = np.sin(0.7 * b + 0.3 * y + 0.5 * x + step)
    grid[(b + x + y) % 3 == 0] = 0.0
    return torch.from_numpy(grid[None].astype(np.float32))


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, memories in (("tiny", 0), ("tiny_recurrent", 3), ("tiny_deep", 1)):  # ConvLSTMs
        torch.manual_seed(5)
        model = DepthNetwork(base=1, encoders=3, memories=memories).eval()
        with torch.no_grad():
            for key, p in model.named_parameters():
                p.mul_(2.5 if key.endswith("weight") else 1.0)  # fresh weights hardly let the input through
            model_states, expected = None, []
            for step in range(3):
                output, model_states = model(fixed_grid(step), model_states)
                expected.append([float(f"{v:.7g}") for v in output[0, 0, ::5, ::7].flatten()])
        state = {key: p.detach().numpy() for key, p in model.named_parameters()}
        info = write_onnx(state, FOLDER / f"{name}.onnx", "random weights, for a test")
        info = {"name": name, **info, "d_max_m": 10.0, "alpha": 3.70378, "expected": expected}
        (FOLDER / f"{name}.json").write_text(json.dumps(info, indent=1) + "\n")
        print(name, min(expected[0]), max(expected[0]))


if __name__ == "__main__":
    main()
