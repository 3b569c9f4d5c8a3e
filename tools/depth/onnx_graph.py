#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Writes the depth network as an ONNX file (opset 11) from its named parameters: numpy and onnx are enough.

Inputs `events` [1, bins, H, W] and, for a recurrent network, `h1_in`, `c1_in`, ...; outputs `depth` [1, 1, H, W] (the
normalised log depth) and `h1_out`, `c1_out`, ..., to be fed back in the next window.
"""
import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

FLOAT = TensorProto.FLOAT


class GraphWriter:
    def __init__(self, parameters, root):
        self.parameters, self.root = parameters, root
        self.nodes, self.constants, self.inputs, self.outputs, self.used = [], [], [], [], set()

    def node(self, operation, inputs, output=None, outputs=None, **attributes):
        names = outputs or [output or f"t{len(self.nodes)}"]
        self.nodes.append(helper.make_node(operation, inputs, names, name=f"n{len(self.nodes)}", **attributes))
        return names if outputs else names[0]

    def constant(self, name, array):
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
        return name

    def shape(self, name):
        return self.parameters[f"{self.root}.{name}.weight"].shape

    def conv(self, x, name, stride=1):
        names = []
        for part in ("weight", "bias"):
            key = f"{self.root}.{name}.{part}"
            if key not in self.parameters:
                raise ValueError(f"the parameters lack '{key}'")
            self.used.add(key)
            names.append(self.constant(key, self.parameters[key].astype(np.float32)))
        kernel = self.parameters[f"{self.root}.{name}.weight"].shape[2]
        return self.node("Conv", [x, *names], kernel_shape=[kernel] * 2, strides=[stride] * 2, pads=[kernel // 2] * 4)

    def conv_relu(self, x, name, stride=1):
        return self.node("Relu", [self.conv(x, name, stride)])

    def add_input(self, name, channels, divisor):
        side = (lambda s: s) if divisor == 1 else (lambda s: f"{s}/{divisor}")
        self.inputs.append(helper.make_tensor_value_info(name, FLOAT, [1, channels, side("H"), side("W")]))
        return name

    def add_output(self, name, channels, divisor):
        side = (lambda s: s) if divisor == 1 else (lambda s: f"{s}/{divisor}")
        self.outputs.append(helper.make_tensor_value_info(name, FLOAT, [1, channels, side("H"), side("W")]))

    def lstm(self, x, index, name):
        """Gates in the order input, remember, output, cell; no peepholes."""
        channels, divisor, k = self.shape(name)[0] // 4, 2 << index, index + 1
        h, c = (self.add_input(f"{s}{k}_in", channels, divisor) for s in "hc")
        gates = self.conv(self.node("Concat", [x, h], axis=1), name)
        parts = self.node("Split", [gates], outputs=[f"g{k}_{i}" for i in range(4)], axis=1, split=[channels] * 4)
        take, keep, give = (self.node("Sigmoid", [p]) for p in parts[:3])
        cell = self.node("Tanh", [parts[3]])
        c = self.node("Add", [self.node("Mul", [keep, c]), self.node("Mul", [take, cell])], f"c{k}_out")
        h = self.node("Mul", [give, self.node("Tanh", [c])], f"h{k}_out")
        for s in "hc":
            self.add_output(f"{s}{k}_out", channels, divisor)
        return h

    def upsample(self, x):
        return self.node("Resize", [x, "roi", "scales"], mode="linear", coordinate_transformation_mode="half_pixel")


def write_onnx(parameters, path, source):
    """parameters: name -> array, as in network.py. Returns what the file beside the model must say of its shape.

    Raises ValueError when a parameter is missing or not part of the graph.
    """
    root = next(iter(parameters)).split(".")[0]
    writer = GraphWriter(parameters, root)
    encoders = len({name.split(".")[2] for name in parameters if name.startswith(f"{root}.encoders.")})
    bins = writer.shape("head.conv2d")[1]
    writer.constant("roi", np.zeros(0, np.float32))
    writer.constant("scales", np.array([1, 1, 2, 2], np.float32))
    head = x = writer.conv_relu(writer.add_input("events", bins, 1), "head.conv2d")
    skips, states = [], []
    for i in range(encoders):
        recurrent = f"{root}.encoders.{i}.recurrent_block.Gates.weight" in parameters
        x = writer.conv_relu(x, f"encoders.{i}.conv.conv2d" if recurrent else f"encoders.{i}.conv2d", 2)
        if recurrent:
            x = writer.lstm(x, i, f"encoders.{i}.recurrent_block.Gates")
            channels = int(writer.shape(f"encoders.{i}.conv.conv2d")[0])
            states += [{"name": f"{s}{i + 1}", "channels": channels, "divisor": 2 << i} for s in "hc"]
        skips.append(x)
    for i in range(2):
        y = writer.conv(writer.conv_relu(x, f"resblocks.{i}.conv1"), f"resblocks.{i}.conv2")
        x = writer.node("Relu", [writer.node("Add", [x, y])])
    for i, skip in enumerate(reversed(skips)):
        x = writer.conv_relu(writer.upsample(writer.node("Add", [x, skip])), f"decoders.{i}.conv2d")
    writer.node("Sigmoid", [writer.conv(writer.node("Add", [x, head]), "pred.conv2d")], "depth")
    writer.outputs.insert(0, helper.make_tensor_value_info("depth", FLOAT, [1, 1, "H", "W"]))
    if unknown := set(parameters) - writer.used:
        raise ValueError(f"the network has no place for '{min(unknown)}'")
    graph = helper.make_graph(writer.nodes, "depth", writer.inputs, writer.outputs, writer.constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 11)], producer_name="edged")
    model.ir_version, model.doc_string = 6, source
    onnx.checker.check_model(model)
    onnx.save(model, str(path))
    return {"bins": int(bins), "multiple": 1 << encoders, "states": states}
