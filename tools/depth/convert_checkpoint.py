#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Turns an e2depth checkpoint (.pth.tar of torch) into an ONNX file for Edged. Needs numpy and onnx, not torch.

  convert_checkpoint.py E2DEPTH_si_grad_loss_mixed.pth.tar --out e2depth.onnx
  edged run RECORDING --set depth.source=network --set depth.network.model=e2depth.onnx

A checkpoint is a pickle, which may run any code when it is read. Here only tensors and plain containers are read; whatever
else the file names becomes an empty placeholder, and nothing of it is imported or called.
"""
import argparse
import collections
import io
import json
import pathlib
import pickle
import struct
import sys
import zipfile

import numpy as np

from onnx_graph import write_onnx

LEGACY_MAGIC = 0x1950A86A20F9469CFC6C
TYPES = {"FloatStorage": "<f4", "DoubleStorage": "<f8", "HalfStorage": "<f2", "LongStorage": "<i8", "IntStorage": "<i4",
         "ShortStorage": "<i2", "CharStorage": "i1", "ByteStorage": "u1", "BoolStorage": "?"}
MODEL = {"skip_type": ("sum",), "recurrent_block_type": ("convlstm",), "use_upsample_conv": (True,),
         "norm": (None, "none", "None"), "num_residual_blocks": (2,)}


class Placeholder:
    """Stands for an object of a class that is not read; swallows what a pickle does to objects."""

    def __new__(cls, *_, **__):
        return object.__new__(cls)

    def __init__(self, *_, **__):
        pass

    def __setstate__(self, _):
        pass

    def __setitem__(self, *_):
        pass

    def append(self, _):
        pass

    def extend(self, _):
        pass


class Tensor:
    """Where a tensor lies; legacy files hold the numbers only after the pickle."""

    def __init__(self, storage, offset, size, stride, *_):
        self.storage, self.offset, self.size, self.stride = storage, offset, tuple(size), tuple(stride)

    def __setstate__(self, _):
        pass

    def array(self, storages):
        kind, key, _ = self.storage
        numbers = np.frombuffer(storages[key], kind)
        last = self.offset + sum((n - 1) * s for n, s in zip(self.size, self.stride))
        if min(self.size, default=1) < 1 or self.offset < 0 or min(self.stride, default=0) < 0 or last >= len(numbers):
            raise ValueError(f"a tensor of size {self.size} does not fit its storage of {len(numbers)} numbers")
        strides = [s * numbers.itemsize for s in self.stride]
        return np.lib.stride_tricks.as_strided(numbers[self.offset:], self.size, strides).copy()


class Storage:
    """A storage class of torch, only by its name."""

    def __init__(self, kind):
        self.kind = kind


class RestrictedUnpickler(pickle.Unpickler):
    def find_class(self, module, name):
        if (module, name) == ("collections", "OrderedDict"):
            return collections.OrderedDict
        if (module, name) == ("torch", "Size"):
            return tuple
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return Tensor
        if (module, name) == ("torch._utils", "_rebuild_parameter"):
            return lambda tensor, *_: tensor
        if module == "torch" and name in TYPES:
            return Storage(TYPES[name])
        return Placeholder

    def persistent_load(self, pid):
        if not isinstance(pid, tuple) or len(pid) < 5 or pid[0] != "storage" or not isinstance(pid[1], Storage):
            return Placeholder()
        if len(pid) > 5 and pid[5] is not None:
            raise ValueError("a storage is a view of another one, which is not supported")
        return pid[1].kind, str(pid[2]), int(pid[4])


def read_zip(file):
    with zipfile.ZipFile(file) as archive:
        pickles = [n for n in archive.namelist() if n.endswith("/data.pkl")]
        if len(pickles) != 1:
            raise ValueError("it holds no data.pkl")
        folder = pickles[0][: -len("data.pkl")] + "data/"
        root = RestrictedUnpickler(io.BytesIO(archive.read(pickles[0]))).load()
        return root, {n[len(folder):]: archive.read(n) for n in archive.namelist() if n.startswith(folder)}


def read_legacy(file):
    with open(file, "rb") as stream:
        if RestrictedUnpickler(stream).load() != LEGACY_MAGIC:
            raise ValueError("it does not begin as a torch file does")
        RestrictedUnpickler(stream).load(), RestrictedUnpickler(stream).load()  # protocol, machine
        kinds = {}

        class Recorder(RestrictedUnpickler):
            def persistent_load(self, pid):
                storage = super().persistent_load(pid)
                if isinstance(storage, tuple):
                    kinds[storage[1]] = storage
                return storage

        root = Recorder(stream).load()
        storages = {}
        for key in map(str, RestrictedUnpickler(stream).load()):
            count, = struct.unpack("<q", stream.read(8))
            storages[key] = stream.read(count * np.dtype(kinds[key][0]).itemsize)
        return root, storages


def read_checkpoint(file):
    """The checkpoint's dict, and its parameters as arrays by name. Raises ValueError for any other content."""
    try:
        root, storages = (read_zip if zipfile.is_zipfile(file) else read_legacy)(file)
    except (pickle.UnpicklingError, EOFError, struct.error, KeyError, AttributeError, IndexError, TypeError) as error:
        raise ValueError(f"it is no torch checkpoint ({type(error).__name__}: {error})") from None
    if not isinstance(root, dict) or not isinstance(root.get("state_dict"), dict):
        raise ValueError("it has no 'state_dict'")
    parameters = {name: t.array(storages) for name, t in root["state_dict"].items() if isinstance(t, Tensor)}
    if not parameters:
        raise ValueError("its 'state_dict' holds no tensors")
    return root, parameters


def check_architecture(root, parameters):
    """Raises ValueError when the network is another one than onnx_graph.py writes."""
    if (arch := root.get("arch")) not in ("E2VIDRecurrent", "E2VID"):
        raise ValueError(f"its arch is {arch!r}; only E2VIDRecurrent and E2VID can be converted")
    config = root.get("config")
    model = root.get("model") or (config.get("model") if isinstance(config, dict) else None)
    if not isinstance(model, dict):
        raise ValueError("it has no 'model' entry that says what the network is")
    for key, allowed in MODEL.items():
        if key in model and model[key] not in allowed:
            raise ValueError(f"its model has {key} = {model[key]!r}; only {allowed[-1]!r} can be converted")
    prefix = next(iter(parameters)).split(".")[0]
    head = parameters.get(f"{prefix}.head.conv2d.weight")
    found = {"num_bins": None if head is None else head.shape[1], "base_num_channels": None if head is None else head.shape[0],
             "num_encoders": len({n.split(".")[2] for n in parameters if n.startswith(f"{prefix}.encoders.")})}
    for key, value in found.items():
        if model.get(key) != value:
            raise ValueError(f"its model has {key} = {model.get(key)!r}, but its tensors {value!r}")


def convert(file, out, d_max, focal):
    root, parameters = read_checkpoint(file)
    check_architecture(root, parameters)
    info = write_onnx(parameters, out, f"converted from {pathlib.Path(file).name}")
    info = {"name": out.stem, "note": f"converted from {pathlib.Path(file).name}; its scale is loose, see docs/depth_model.md",
            **info, "d_max_m": d_max, "alpha": 3.70378, "focal_px": focal, "window_s": 0.05, "sigma_ln": 0.7}
    out.with_suffix(".json").write_text(json.dumps(info, indent=1) + "\n")
    return sum(p.size for p in parameters.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="MODEL.onnx; MODEL.json is written beside it")
    parser.add_argument("--d-max", type=float, default=80.0, help="clip distance of the training [m]")
    parser.add_argument("--focal", type=float, default=0.0, help="focal length in training [px]; 0: depths are not scaled")
    arguments = parser.parse_args()
    try:
        count = convert(arguments.checkpoint, arguments.out, arguments.d_max, arguments.focal)
    except (ValueError, OSError) as error:
        print(f"convert_checkpoint.py: {arguments.checkpoint}: {error}", file=sys.stderr)
        return 1
    print(f"{arguments.out}: {count} parameters")
    return 0


if __name__ == "__main__":
    sys.exit(main())
