#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What a model costs in LibTorch (python3-torch), to set beside `edged depth`, which runs OpenCV's dnn: milliseconds
of one core a window of a DAVIS240C's central region.

  time_torch.py config/depth/small.onnx ...
"""
import json
import pathlib
import sys
import time

import numpy as np
import torch

from train import read_model

SEEN = (128, 160)  # 122 x 152 pixels filled up to multiples of 16


def main():
    torch.set_num_threads(1)
    for file in sys.argv[1:]:
        info = json.loads(pathlib.Path(file).with_suffix(".json").read_text())
        shrink = info.get("shrink", 1)
        voxels = torch.randn(1, info["bins"], SEEN[0] // shrink, SEEN[1] // shrink)
        times = []
        with torch.no_grad():
            model = read_model(file)
            _, states = model(voxels)  # the first run sets up more than the others
            for _ in range(41):
                begin = time.process_time()
                _, states = model(voxels, states)
                times.append(1e3 * (time.process_time() - begin))
        print(f"{file}: {np.median(times):.1f} ms")


if __name__ == "__main__":
    main()
