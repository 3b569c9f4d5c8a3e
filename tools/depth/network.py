#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The depth network in torch: a U-Net with additive skips, a ConvLSTM in as many of its deepest encoders as wanted (all of
them in e2depth), parameters named as in e2depth's files.

Hidalgo-Carrio, Gehrig, Scaramuzza, "Learning Monocular Dense Depth from Events", 3DV 2020. The input is a normalised
voxel grid [N, bins, H, W], H and W multiples of 2^encoders; the output [N, 1, H, W] is the normalised log depth in (0, 1).
"""
import torch
from torch import nn
from torch.nn import functional


class Conv(nn.Module):
    def __init__(self, inputs, outputs, kernel, stride=1):
        super().__init__()
        self.conv2d = nn.Conv2d(inputs, outputs, kernel, stride, kernel // 2)

    def forward(self, x):
        return functional.relu(self.conv2d(x))


class ConvLstm(nn.Module):
    def __init__(self, channels):
        super().__init__()
        self.Gates = nn.Conv2d(2 * channels, 4 * channels, 3, padding=1)

    def forward(self, x, state):
        """state: (h, c) or None for the start. Returns the new (h, c)."""
        h, c = state if state is not None else (torch.zeros_like(x), torch.zeros_like(x))
        take, keep, give, cell = self.Gates(torch.cat([x, h], 1)).chunk(4, 1)
        c = torch.sigmoid(keep) * c + torch.sigmoid(take) * torch.tanh(cell)
        return torch.sigmoid(give) * torch.tanh(c), c


class RecurrentEncoder(nn.Module):
    def __init__(self, inputs, outputs):
        super().__init__()
        self.conv = Conv(inputs, outputs, 5, 2)
        self.recurrent_block = ConvLstm(outputs)


class Residual(nn.Module):
    def __init__(self, channels):
        super().__init__()
        self.conv1 = nn.Conv2d(channels, channels, 3, padding=1)
        self.conv2 = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, x):
        return functional.relu(x + self.conv2(functional.relu(self.conv1(x))))


class UNet(nn.Module):
    def __init__(self, base, encoders, bins, memories):
        super().__init__()
        widths = [base << i for i in range(encoders + 1)]
        self.head = Conv(bins, base, 5)
        self.encoders = nn.ModuleList(RecurrentEncoder(a, b) if i + memories >= encoders else Conv(a, b, 5, 2)
                                      for i, (a, b) in enumerate(zip(widths, widths[1:])))
        self.resblocks = nn.ModuleList(Residual(widths[-1]) for _ in range(2))
        self.decoders = nn.ModuleList(Conv(b, a, 5) for a, b in reversed(list(zip(widths, widths[1:]))))
        self.pred = nn.Module()
        self.pred.conv2d = nn.Conv2d(base, 1, 1)

    def forward(self, x, states=None):
        """Returns the output and the new states, one (h, c) a ConvLSTM."""
        head = x = self.head(x)
        skips, new_states = [], []
        for encoder in self.encoders:
            if isinstance(encoder, RecurrentEncoder):
                before = states[len(new_states)] if states else None
                new_states.append(encoder.recurrent_block(encoder.conv(x), before))
                x = new_states[-1][0]
            else:
                x = encoder(x)
            skips.append(x)
        for block in self.resblocks:
            x = block(x)
        for skip, decoder in zip(reversed(skips), self.decoders):
            x = decoder(functional.interpolate(x + skip, scale_factor=2, mode="bilinear", align_corners=False))
        return torch.sigmoid(self.pred.conv2d(x + head)), new_states


class DepthNetwork(nn.Module):
    """Only so that the names of the parameters begin as in the original's files."""

    def __init__(self, base=8, encoders=3, bins=5, memories=0):
        super().__init__()
        self.root = "unetrecurrent" if memories else "unet"
        setattr(self, self.root, UNet(base, encoders, bins, memories))

    def forward(self, x, states=None):
        return getattr(self, self.root)(x, states)
