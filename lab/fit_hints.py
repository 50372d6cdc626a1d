#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Fits the network of cairn/regions/object_hints.hpp to the fit set.

fit_hints.py TOOL DATA [--rooms FOLDER] [--work FOLDER] [--out FOLDER] [--steps N]

For each cell of about 2×2 pixels, the network predicts whether it belongs to an object, whether it is on an object's
outline, and the centre and size of its object. It is fitted once without each of two halves of the scenes, so that
fit.py has for each frame the output of a network that has not seen it, and once on all scenes. It is then quantised:
weights to 8 bits per output channel, activations to integers. Everything is seeded and each network uses one thread:
the same frames give the same weights on the same processor.
"""
import argparse
import pathlib
import subprocess
import sys
import time

import fitted_files
import numpy as np

from fit import HALVES, SEED, WEIGHTS, fit_sets, fold_of, jobs_of, run_tool

BATCH = 12
RATE, DECAY = 3e-3, 2e-3
CLOSE_UPS = 0.3  # share of the samples that simulate a narrower field of view
WIDTH, HEIGHT = 160, 120  # cells of the canvas that frames are fitted on
CHANNELS = 12
FIRST, SECOND, THIRD, LAST = 16, 40, 48, 32  # channels at 1/2, 1/4, 1/8 and 1/16, and before the output
UNIT = 64  # scale of the input
GREATEST = 8191  # activation: kMaxActivation
# Outputs: log-odds of an object and of an outline, quantised to 1/16; offset to the centre in units of 16 cells,
# quantised to 1/8 cell; log₂ of the size, quantised to 1/16.
STEPS_PER_UNIT = [16, 16, 128, 128, 16]


def load(path, jobs):
    """For each job: channels, true objects, whether the truth is partial."""
    frames = [None] * len(jobs)
    for part in range(2):
        values, at = np.fromfile(f"{path}{part}", np.int16), 0
        while at < len(values):
            job, width, height, partial = (int(v) for v in values[at:at + 4])
            cells = values[at + 4:at + 4 + width * height * CHANNELS].reshape(height, width, CHANNELS)
            at += 4 + width * height * CHANNELS
            truth = values[at:at + width * height].reshape(height, width)
            at += width * height
            frames[2 * job + part] = (np.ascontiguousarray(cells.transpose(2, 0, 1)), truth, bool(partial))
    return frames


DOWN, ACROSS = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)


def targets(truth):
    """Per cell: object, outline, centre (2), log₂ of the size, root of the size, known."""
    out = np.zeros((7, HEIGHT, WIDTH), np.float32)
    out[0], out[6] = truth > 0, truth >= 0
    for down, across in ((0, 1), (1, 0)):
        here, there = truth[:HEIGHT - down, :WIDTH - across], truth[down:, across:]
        parts = (here != there) & (here >= 0) & (there >= 0)
        out[1, :HEIGHT - down, :WIDTH - across] += parts
        out[1, down:, across:] += parts
    out[1] = out[1] > 0
    which = np.maximum(truth, 0)
    flat = which.ravel()
    size = np.bincount(flat).astype(np.float32)
    least = np.maximum(size, 1)
    table = np.stack([np.bincount(flat, ACROSS.ravel()) / least, np.bincount(flat, DOWN.ravel()) / least,
                      np.log2(least), np.sqrt(size)])
    table[:, 0] = 0
    out[2:6] = table[:, which]
    return out


def see_closer(data, scale, inside):
    """A crop as a camera with a narrower field of view would see it; recomputes the inputs that hint_input()
    normalises by the image."""
    brightness = data[0][inside]
    data[0][inside] = np.clip((brightness - brightness.mean()) / (brightness.std() + 0.1), -4, 4)
    matched = inside & (data[4] > 0)
    if matched.any():
        data[[3, 7]] = np.minimum(data[[3, 7]] / max(np.quantile(data[3][matched], 0.98), 0.02), 2)
    data[5:7] = np.clip(data[5:7] * scale, -1, 3)  # disparity differences
    data[10][inside] = np.broadcast_to(2 * DOWN[:, :1] / HEIGHT - 1, inside.shape)[inside]


class Samples:
    """Augmented frames on the canvas: mirrored, scaled, shifted, brightened, without a floor …"""

    def __init__(self, frames):
        self.frames, self.random = frames, np.random.RandomState(SEED)

    def sample(self, i):
        cells, truth, partial = self.frames[i]
        height, width = truth.shape
        random = self.random
        narrower = random.rand() < CLOSE_UPS
        scale = np.exp(random.uniform(0.25, 0.8) if narrower else random.uniform(-0.25, 0.25)) * WIDTH / width
        x = (np.arange(WIDTH) + 0.5 - WIDTH / 2 - random.uniform(-0.1, 0.1) * WIDTH) / scale + width / 2
        y = (np.arange(HEIGHT) + 0.5 - HEIGHT / 2 - random.uniform(-0.1, 0.1) * HEIGHT) / scale + height / 2
        if random.rand() < 0.5:
            x = width - x
        x, y = np.floor(x).astype(int), np.floor(y).astype(int)
        outside = ~(((y >= 0) & (y < height))[:, None] & ((x >= 0) & (x < width))[None])
        at = np.clip(y, 0, height - 1)[:, None] * width + np.clip(x, 0, width - 1)[None]
        data = cells.reshape(CHANNELS, -1).take(at.ravel(), axis=1).reshape(CHANNELS, HEIGHT, WIDTH)
        data = data.astype(np.float32) / UNIT
        data[:, outside] = 0
        ids = truth.ravel()[at]
        ids[outside] = -1
        if narrower:
            see_closer(data, scale * width / WIDTH, ~outside)
        if partial:
            ids[ids == 0] = -1  # may be an unlabelled object
        data[0] = data[0] * random.uniform(0.8, 1.25) + random.uniform(-0.2, 0.2)
        data[0] += random.standard_normal((HEIGHT, WIDTH)).astype(np.float32) * random.uniform(0, 0.06)
        data[1:3] *= random.uniform(0.7, 1.4)
        nearer = random.uniform(0.85, 1.15)
        data[[3, 7]] *= nearer
        data[5:7] *= random.uniform(0.8, 1.25)
        if random.rand() < 0.1:
            data[[5, 7]] = 0  # no floor
        if random.rand() < 0.1:
            data[6] = 0  # no background
        return data, targets(ids)


def network():
    from torch import nn
    import torch

    def layer(inputs, outputs, stride=1, side=3):
        return nn.Sequential(nn.Conv2d(inputs, outputs, side, stride, side // 2, bias=False), nn.BatchNorm2d(outputs),
                             nn.ReLU())

    class Network(nn.Module):
        def __init__(self):
            super().__init__()
            self.steps = nn.ModuleList([
                layer(CHANNELS, FIRST, 2), layer(FIRST, FIRST), layer(FIRST, SECOND, 2), layer(SECOND, SECOND),
                layer(SECOND, THIRD, 2), layer(THIRD, THIRD), layer(THIRD, THIRD),
                layer(THIRD, THIRD, 2), layer(THIRD, THIRD), layer(THIRD, THIRD),
                layer(THIRD, THIRD, 1, 1), layer(THIRD, THIRD), layer(THIRD, SECOND, 1, 1), layer(SECOND, SECOND),
                layer(SECOND, FIRST, 1, 1), layer(FIRST, LAST)])
            self.end = nn.Conv2d(LAST, 4 * len(STEPS_PER_UNIT), 1)
            with torch.no_grad():
                self.end.bias.copy_(torch.tensor([-2.0, -2.5, 0, 0, 8]).repeat_interleave(4))

        def forward(self, data, seen=None):
            """`seen`: called with the largest activation after each layer."""
            def run(steps, data):
                for i in steps:
                    data = self.steps[i](data)
                    if seen is not None:
                        seen[i] = max(seen[i], float(data.max()))
                return data

            def doubled(small, like):
                return small.repeat_interleave(2, 2).repeat_interleave(2, 3)[:, :, :like.shape[2], :like.shape[3]] + like

            half = run((0, 1), data)
            quarter = run((2, 3), half)
            eighth = run((4, 5, 6), quarter)
            up = run((10,), run((7, 8, 9), eighth))
            up = run((12,), run((11,), doubled(up, eighth)))
            up = run((14,), run((13,), doubled(up, quarter)))
            up = run((15,), doubled(up, half))
            return nn.functional.pixel_shuffle(self.end(up), 2)

    return Network()


def loss_of(output, truth):
    import torch
    from torch.nn import functional as F

    def shared(output, truth, weight, **more):
        return (F.binary_cross_entropy_with_logits(output, truth, reduction="none", **more) * weight).sum() / (weight.sum() + 1)

    known, objects, root = truth[:, 6], truth[:, 0], truth[:, 5] + 1
    # Each object is weighted by the root of its size.
    weight = objects / root
    x = (torch.from_numpy(ACROSS) + 16 * output[:, 2] - truth[:, 2]) / root
    y = (torch.from_numpy(DOWN) + 16 * output[:, 3] - truth[:, 3]) / root
    middle = F.smooth_l1_loss(x, 0 * x, reduction="none", beta=0.1) + F.smooth_l1_loss(y, 0 * y, reduction="none", beta=0.1)
    size = F.smooth_l1_loss(output[:, 4], truth[:, 4], reduction="none", beta=0.3)
    parts = [shared(output[:, 0], objects, known),
             shared(output[:, 1], truth[:, 1], known, pos_weight=torch.tensor(2.0)),
             (middle * weight).sum() / (weight.sum() + 1), 0.3 * (size * weight).sum() / (weight.sum() + 1)]
    return sum(parts), np.array([float(part) for part in parts])


def fitted(frames, often, steps):
    """A network fitted to the frames, each used `often` times; its weights are an exponential average over the last
    steps."""
    import torch

    torch.manual_seed(SEED)
    torch.set_num_threads(1)
    net, mean = network().to(memory_format=torch.channels_last), network()
    mean.load_state_dict(net.state_dict())
    samples = Samples(frames)
    order = np.repeat(np.arange(len(frames)), often)
    optimizer = torch.optim.AdamW(net.parameters(), RATE, weight_decay=DECAY)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps, pct_start=0.15)
    random, queue, losses = np.random.RandomState(SEED), [], np.zeros(4)
    begin = time.time()
    for step in range(1, steps + 1):
        if len(queue) < BATCH:
            queue = list(random.permutation(order))
        drawn = [samples.sample(queue.pop()) for _ in range(BATCH)]
        data = torch.from_numpy(np.stack([d for d, _ in drawn])).contiguous(memory_format=torch.channels_last)
        loss, parts = loss_of(net(data), torch.from_numpy(np.stack([t for _, t in drawn])))
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        optimizer.step()
        schedule.step()
        losses += (parts - losses) * 0.02 if step > 1 else parts
        with torch.no_grad():
            for kept, new in zip(mean.state_dict().values(), net.state_dict().values()):
                kept.copy_(new) if not kept.dtype.is_floating_point else kept.lerp_(new, 0.01)
        if step % 100 == 0:
            print(f"{time.time() - begin:6.0f} s  step {step}: {' '.join(f'{v:.3f}' for v in losses)}", flush=True)
    return mean.eval()


def rounded(net, frames):
    """The layers as integers: (inputs, outputs, side, stride, least), weights, biases and scales of each."""
    import torch

    seen = [0.0] * len(net.steps)
    with torch.no_grad():
        for cells, _, _ in frames:
            net(torch.from_numpy(cells[None].astype(np.float32) / UNIT), seen)
    # Summands need a common scale: the decoder's 1×1 layers use that of the encoder's.
    for small, like in ((10, 6), (12, 3), (14, 1)):
        seen[small] = seen[like] = max(seen[small], seen[like])
    scales = [GREATEST / 3 / max(s, 1e-6) for s in seen]  # headroom: three times the largest activation seen
    source = {0: UNIT, 15: scales[14], 13: scales[12], 11: scales[10]}
    source |= {2: scales[1], 4: scales[3], 7: scales[6], 10: scales[9], 12: scales[11], 14: scales[13]}
    layers = []
    for i, step in enumerate([*net.steps, net.end]):
        end = i == len(net.steps)
        convolution = step if end else step[0]
        weight = convolution.weight.detach().numpy().astype(np.float64)
        if end:
            # The kernels need a multiple of 8 outputs.
            steps = np.repeat(np.array(STEPS_PER_UNIT, float), 4)
            weight = np.concatenate([weight * steps[:, None, None, None], np.zeros((4, *weight.shape[1:]))])
            bias, into = np.concatenate([convolution.bias.detach().numpy() * steps, np.zeros(4)]), 1.0
            # All weights of an output channel have the same scale.
        else:
            norm = step[1]
            gain = (norm.weight / torch.sqrt(norm.running_var + norm.eps)).detach().numpy().astype(np.float64)
            bias = norm.bias.detach().numpy() - norm.running_mean.detach().numpy() * gain
            weight, into = weight * gain[:, None, None, None], scales[i]
        of = scales[15] if end else source.get(i, scales[i - 1])
        unit = np.maximum(np.abs(weight).max(axis=(1, 2, 3)), 1e-9) / 127
        whole = np.round(weight / unit[:, None, None, None]).astype(np.int64)
        whole_bias = np.round(bias / unit * of).astype(np.int64)
        assert (np.abs(whole).sum(axis=(1, 2, 3)) * GREATEST + np.abs(whole_bias)).max() < 2**31, "a sum may overflow"
        side, stride = convolution.kernel_size[0], convolution.stride[0]
        layers.append(((whole.shape[1], whole.shape[0], side, stride, -GREATEST if end else 0),
                       whole.transpose(2, 3, 1, 0).ravel(), whole_bias, (unit / of * into).astype(np.float32)))
    return layers


def write(layers, path):
    with open(path, "w") as out:
        for shape, _, _, _ in layers:
            out.write(" ".join(map(str, shape)) + "\n")
        for part in (1, 2, 3):
            for layer in layers:
                out.write(" ".join(f"{v:.9g}" if part == 3 else str(v) for v in layer[part]) + "\n")


def write_fitted(layers, path):
    def all_of(part):
        return [v for layer in layers for v in layer[part]]

    fitted_files.write_network(path, [shape for shape, _, _, _ in layers], all_of(1), all_of(2), all_of(3))


def fit_one(arguments, jobs, half):
    """Runs in its own process: fits without one half of the scenes, or on all."""
    frames = load(arguments.work / "inputs", jobs)
    takes = [i for i, job in enumerate(jobs) if half == "all" or fold_of(job[0], HALVES) != int(half)]
    often = [int(WEIGHTS.get(jobs[i][2], 1)) for i in takes]
    net = fitted([frames[i] for i in takes], often, arguments.steps)
    import torch
    torch.save(net.state_dict(), arguments.work / f"network_{half}.pt")
    layers = rounded(net, [frames[i] for i in takes[::5]])
    write(layers, arguments.work / f"hints_{half}")
    if half == "all" and arguments.out:
        write_fitted(layers, arguments.out / "hints.bin")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--rooms", type=pathlib.Path, help="more rooms, rendered by tools/render")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/fit"))
    parser.add_argument("--out", type=pathlib.Path, help="where the fitted numbers are written (cairn/fitted)")
    parser.add_argument("--steps", type=int, default=4800)
    parser.add_argument("--only", help="one half, or all: results in the work folder are reused")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    jobs = jobs_of(fit_sets(arguments.data, arguments.rooms))
    if arguments.only:
        return fit_one(arguments, jobs, arguments.only)
    run_tool(arguments.tool, arguments.work, jobs, lambda i: "- - -", "--inputs", arguments.work / "inputs@")
    waiting = ["all", *map(str, range(HALVES))]
    running = []
    while waiting or running:
        while waiting and len(running) < 2:
            running.append(subprocess.Popen([sys.executable, *sys.argv, "--only", waiting.pop(0)]))
        if running[0].wait():
            for other in running[1:]:
                other.terminate()
            sys.exit("fit_hints.py: a network could not be fitted")
        running.pop(0)


if __name__ == "__main__":
    main()
