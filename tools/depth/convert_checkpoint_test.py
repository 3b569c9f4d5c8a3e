#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Tests of convert_checkpoint.py on checkpoints made here; ends with 77 (skipped) where torch or onnx is missing."""
import json
import pathlib
import sys
import tempfile
import unittest

try:
    import numpy as np
    import onnx
    import torch
    from onnx import numpy_helper
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from convert_checkpoint import check_architecture, convert, read_checkpoint
from network import DepthNetwork

MODEL = {"num_bins": 5, "skip_type": "sum", "recurrent_block_type": "convlstm", "num_encoders": 3, "base_num_channels": 32,
         "num_residual_blocks": 2, "use_upsample_conv": True, "norm": "none"}


class Evil:
    """Writes a file when a plain loader reads it."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (self.path, "w"))


def checkpoint(base=32, recurrent=True, **changes):
    torch.manual_seed(1)
    network = DepthNetwork(base=base, memories=3 if recurrent else 0)
    return {"arch": "E2VIDRecurrent" if recurrent else "E2VID", "state_dict": network.state_dict(),
            "model": {**MODEL, "base_num_channels": base, **changes}}


class ConvertCheckpoint(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = pathlib.Path(self.folder.name) / "c.pth.tar"
        self.out = pathlib.Path(self.folder.name) / "c.onnx"
        self.addCleanup(self.folder.cleanup)

    def converted(self, content, zipped):
        torch.save(content, self.file, _use_new_zipfile_serialization=zipped)
        return convert(self.file, self.out, 80.0, 0.0)

    def test_the_published_structure_in_both_formats_keeps_every_number(self):
        content = checkpoint()
        for zipped in (False, True):
            self.assertEqual(self.converted(content, zipped), 10_710_401)
            graph = onnx.load(str(self.out)).graph
            stored = {t.name: numpy_helper.to_array(t) for t in graph.initializer}
            for name, tensor in content["state_dict"].items():
                np.testing.assert_array_equal(stored[name], tensor.numpy())
            self.assertEqual([i.name for i in graph.input], ["events", "h1_in", "c1_in", "h2_in", "c2_in", "h3_in", "c3_in"])
            info = json.loads(self.out.with_suffix(".json").read_text())
            self.assertEqual((info["bins"], info["multiple"], info["d_max_m"]), (5, 8, 80.0))
            self.assertEqual([s["channels"] for s in info["states"]], [64, 64, 128, 128, 256, 256])

    def test_a_network_without_memory_has_no_states(self):
        self.converted(checkpoint(base=2, recurrent=False), True)
        self.assertEqual(json.loads(self.out.with_suffix(".json").read_text())["states"], [])

    def test_a_tensor_that_is_a_view_is_read_right(self):
        content = checkpoint(base=2)
        content["state_dict"]["unetrecurrent.pred.conv2d.bias"] = torch.arange(10.0)[7:8]
        name = "unetrecurrent.resblocks.0.conv1.weight"
        content["state_dict"][name] = content["state_dict"][name].transpose(2, 3)
        for zipped in (False, True):
            torch.save(content, self.file, _use_new_zipfile_serialization=zipped)
            _, parameters = read_checkpoint(self.file)
            self.assertEqual(parameters["unetrecurrent.pred.conv2d.bias"], [7.0])
            np.testing.assert_array_equal(parameters[name], content["state_dict"][name].numpy())

    def test_code_in_the_file_is_not_run(self):
        trap = pathlib.Path(self.folder.name) / "trap"
        for zipped in (False, True):
            self.converted({**checkpoint(base=2), "monitor": Evil(str(trap)), "optimizer": {"x": [Evil(str(trap))]}}, zipped)
            self.assertFalse(trap.exists())

    def test_the_model_may_stand_in_the_config(self):
        content = checkpoint(base=2)
        content["config"] = {"model": content.pop("model")}
        self.converted(content, False)

    def test_another_network_is_refused_with_the_reason(self):
        for changes, reason in (({"norm": "BN"}, "norm"), ({"skip_type": "concat"}, "skip_type"), ({"num_bins": 10}, "num_bins"),
                                ({"base_num_channels": 16}, "base_num_channels"), ({"num_encoders": 4}, "num_encoders")):
            content = checkpoint(base=2, **{**{"base_num_channels": 2}, **changes})
            torch.save(content, self.file)
            with self.assertRaisesRegex(ValueError, reason):
                check_architecture(*read_checkpoint(self.file))

    def test_missing_and_surplus_tensors_are_refused(self):
        content = checkpoint(base=2)
        content["state_dict"]["unetrecurrent.extra.weight"] = torch.zeros(1)
        with self.assertRaisesRegex(ValueError, "no place for 'unetrecurrent.extra.weight'"):
            self.converted(content, True)
        del content["state_dict"]["unetrecurrent.extra.weight"], content["state_dict"]["unetrecurrent.head.conv2d.bias"]
        with self.assertRaisesRegex(ValueError, "lack 'unetrecurrent.head.conv2d.bias'"):
            self.converted(content, True)

    def test_what_is_no_checkpoint_is_refused(self):
        for content in (b"", b"hello", b"\x80\x02}q\x00.", b"PK\x03\x04 not a zip"):
            self.file.write_bytes(content)
            with self.assertRaises(ValueError):
                read_checkpoint(self.file)
        torch.save([1, 2], self.file)
        with self.assertRaisesRegex(ValueError, "state_dict"):
            read_checkpoint(self.file)

    def test_a_file_cut_short_is_refused(self):
        torch.save(checkpoint(base=2), self.file, _use_new_zipfile_serialization=False)
        self.file.write_bytes(self.file.read_bytes()[:-200])
        with self.assertRaises(ValueError):
            read_checkpoint(self.file)


if __name__ == "__main__":
    unittest.main()
