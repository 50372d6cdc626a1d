#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Fits the network of cairn/regions/object_hints.hpp.

fit_hints.py gather TOOL STORE FRAMES...: the inputs of the network and the truth for folders of frames, in colour and
in grey, into the folder STORE.
fit_hints.py fit STORE... [--work FOLDER] [--out FOLDER] [--steps N] [--rate R] [--width W] [--worlds N] [--start FILE] [--keep S]: fits
to such stores.

For each cell of about four pixels, the network predicts whether it belongs to an object, whether it is on an object's outline,
and the centre and size of its object. It is then quantised: weights to 8 bits per output channel, activations to
integers. What is drawn in a step depends on its number, on how many there are and on the start, and a checkpoint is
written every ten minutes: a fit that was stopped goes on, to the same weights as one that was not. A graphics processor is used if PyTorch
finds one, and products of bfloat16 where they are fast; the weights then differ from those of another processor.
"""
import argparse
import ctypes
import hashlib
import os
import pathlib
import time

import fitted_files
import numpy as np

from fit import SEED, frames_in, run_tool

BATCH = 24  # half of it in colour, half in grey
RATE = 0.02  # by which filters turn in a step, at most: see orthogonal_steps()
RATE_OF_OTHERS, DECAY = 3e-3, 2e-3  # of what is no filter: the lesser of this and 0.3 of the filters' rate
WARM_UP = 0.1  # share of the steps
CLOSE_UPS = 0.3  # share of the samples that simulate a narrower field of view
PASTES = 0.35  # chance, taken twice, that an object of another frame is pasted
MARKS, AT_BORDER = 0.5, 0.4  # chance of a flat mark on the floor, and that it is at the left or right border
CALM = 0.2  # share of the steps, the last ones, without close-ups and pastes
WIDTH, HEIGHT = 160, 120  # cells of a frame, or of what is seen of a larger one
CHANNELS, OWN = 16, 12  # channels of a cell; the last ones follow from its own and those around it
REACH = 8  # cells: of what is around one
LEAST_SPREADS = 5 / 64, 10 / 64, 10 / 64  # of brightness and colours
FIRST, SECOND, THIRD, FOURTH, LAST = 32, 64, 112, 48, 48  # channels at 1/2, 1/4, 1/8 and 1/16, at 1/32, and before the output
SHARED_ROOT = 24  # root of the size, in cells, of an object whose cells count as much as the background's
UNIT = 64  # scale of the input
DONT_CARE = 255
GREATEST = 4096  # activation: kMaxActivation
# Outputs: log-odds of an object and of an outline, quantised to 1/16; offset to the centre in units of 16 cells,
# quantised to 1/8 cell; log₂ of the size, quantised to 1/16.
STEPS_PER_UNIT = [16, 16, 128, 128, 16]
CHECKPOINT_SECONDS = 600
CALIBRATION = 200  # frames that show how large activations are
COUNTED = 40  # batches that show what batch normalisation sees


# ---- frames

def gather(tool, store, frames):
    """Writes `cells` (int16) and `truth` (uint8: 0 no object) of frames 0, 1 … in colour and in grey, in turn; nothing
    if that is done."""
    parts = os.cpu_count()
    store.mkdir(parents=True, exist_ok=True)
    done = store / "frames.txt"
    listed = "".join(f"{frame}\n" for frame in frames)
    if done.exists() and done.read_text() == listed:
        return
    done.unlink(missing_ok=True)
    jobs = [(frame, colour, "") for frame in frames for colour in ("colour", "grey")]
    run_tool(tool, store, jobs, lambda i: "- - -", "--inputs", store / "inputs@", parts=parts)
    cells = np.lib.format.open_memmap(store / "cells.npy", "w+", np.int16, (len(jobs), OWN, HEIGHT, WIDTH))
    truth = np.lib.format.open_memmap(store / "truth.npy", "w+", np.uint8, (len(jobs), HEIGHT, WIDTH))
    for part in range(parts):
        values = np.fromfile(store / f"inputs{part}", np.int16)
        if not len(values):  # fewer frames than processors
            continue
        width, height = map(int, values[1:3])
        area = width * height
        check_twin(values[4:4 + area * CHANNELS].reshape(height, width, CHANNELS))
        for row in values.reshape(-1, 4 + area * (CHANNELS + 1)):
            if (row[1], row[2], row[3]) != (width, height, 0):
                raise SystemExit("fit_hints.py: frames of one size, with complete truth, are expected")
            job = parts * int(row[0]) + part
            # Of a larger image, which has more cells, a window; with what was normalised by the whole image as it is. A flat
            # one, which has fewer rows, is in the middle.
            random = np.random.RandomState([SEED, job])
            rows, columns = min(height, HEIGHT), min(width, WIDTH)
            x, y = random.randint(width - columns + 1), random.randint(height - rows + 1)
            top, left = (HEIGHT - rows) // 2, (WIDTH - columns) // 2
            window, place = np.s_[y:y + rows, x:x + columns], np.s_[..., top:top + rows, left:left + columns]
            cells[job][place] = row[4:4 + area * CHANNELS].reshape(height, width, CHANNELS)[window][..., :OWN].transpose(2, 0, 1)
            ids = row[4 + area * CHANNELS:].reshape(height, width)[window]
            truth[job] = DONT_CARE
            truth[job][place] = np.where(ids < 0, DONT_CARE, ids)
        (store / f"inputs{part}").unlink()
        (store / f"jobs{part}").unlink()
    done.write_text(listed)


def check_twin(cells):
    """Stores lack the channels that with_surroundings() computes: it must compute what the library does."""
    import torch

    whole = torch.from_numpy(cells.transpose(2, 0, 1)[None] / UNIT).float()
    inside = torch.ones(1, *cells.shape[:2], dtype=torch.bool)
    off = (with_surroundings(whole[:, :OWN], inside) - whole).abs().max()
    if off > 1 / UNIT:
        raise SystemExit(f"fit_hints.py: channels {OWN} to {CHANNELS - 1} are not those of the library: off by {off:.3f}")


class Frames:
    """All frames of the stores; number 2i is frame i in colour, 2i + 1 in grey."""

    def __init__(self, stores, limit, device):
        import torch

        self.device = device
        cells = [np.load(store / "cells.npy", mmap_mode="c") for store in stores]
        truth = [np.load(store / "truth.npy", mmap_mode="c") for store in stores]
        cells[0], truth[0] = cells[0][:2 * limit], truth[0][:2 * limit]
        self.starts = np.cumsum([0, *map(len, cells)])
        self.cells, self.truth = cells, truth
        if device.type != "cpu":  # all of them fit there
            self.cells = torch.cat([torch.from_numpy(np.ascontiguousarray(c)).to(device) for c in cells])
            self.truth = torch.cat([torch.from_numpy(np.ascontiguousarray(t)).to(device) for t in truth])

    def __len__(self):
        return int(self.starts[-1]) // 2

    def take(self, number):
        """Inputs and true objects of a frame."""
        import torch

        if self.device.type != "cpu":
            return self.cells[number], self.truth[number]
        store = np.searchsorted(self.starts, number, "right") - 1
        at = number - self.starts[store]
        return torch.from_numpy(self.cells[store][at]), torch.from_numpy(self.truth[store][at])

    def inputs_to_calibrate(self):
        """The network's input for frames from all over, one by one."""
        for number in np.linspace(0, 2 * len(self) - 1, CALIBRATION).astype(int):
            yield with_surroundings(self.take(number)[0][None].float() / UNIT)


def with_surroundings(own, inside=None):
    """The channels of cells, and those that compare them with the cells around: hint_input() computes the same. `inside`:
    cells of the image; without it, those that are not padding."""
    import torch
    from torch.nn import functional as F

    def around(values):
        before = F.pad(values, (REACH + 1, REACH)).cumsum(-1)
        values = before[..., 2 * REACH + 1:] - before[..., :-2 * REACH - 1]
        before = F.pad(values, (0, 0, REACH + 1, REACH)).cumsum(-2)
        return before[..., 2 * REACH + 1:, :] - before[..., :-2 * REACH - 1, :]

    counts = ((own != 0).any(1) if inside is None else inside)[:, None].float()
    matched = (own[:, 4:5] > 0).float()
    look = own[:, :3] * counts
    count, of_matched, disparities, looks, squares = around(torch.cat(
        [counts, matched, own[:, 3:4] * matched, look, look ** 2], 1)).split((1, 1, 1, 3, 3), 1)
    mean = looks / count.clamp(min=0.5)
    spread = (squares / count.clamp(min=0.5) - mean ** 2).clamp(min=0).sqrt()
    least = torch.tensor(LEAST_SPREADS, device=own.device)[:, None, None]
    nearer = 8 * matched * (own[:, 3:4] - disparities / of_matched.clamp(min=0.5))
    relative = torch.cat([(look - mean * counts) / (spread + least), nearer], 1).clamp(-4, 4)
    return torch.cat([own, relative], 1)


# ---- samples

class Sampler:
    """Batches of frames that are mirrored, scaled, shifted, brightened, without a floor …"""

    def __init__(self, frames, steps, seed=SEED):
        import torch

        self.frames, self.first_calm, self.seed = frames, round((1 - CALM) * steps), seed
        self.down = torch.arange(HEIGHT, device=frames.device, dtype=torch.float32)[:, None]
        self.across = torch.arange(WIDTH, device=frames.device, dtype=torch.float32)[None]

    def numbers(self, step):
        """Every frame comes once in a round."""
        half, count = BATCH // 2, len(self.frames)
        at = np.arange(step * half, (step + 1) * half)
        order = {r: np.random.RandomState([self.seed, r]).permutation(count) for r in np.unique(at // count)}
        scenes = np.array([order[i // count][i % count] for i in at])
        return np.concatenate([2 * scenes, 2 * np.roll(scenes, half // 2) + 1])

    def batch(self, step):
        """Inputs and targets."""
        import torch

        random = torch.Generator(self.frames.device).manual_seed(1000003 * self.seed + step)

        def uniform(low, high, shape=(BATCH, 1, 1)):
            return low + (high - low) * torch.rand(*shape, generator=random, device=self.frames.device)

        cells, truth = zip(*map(self.frames.take, self.numbers(step)))
        is_calm = step >= self.first_calm
        narrower = uniform(0, 1) < (0 if is_calm else CLOSE_UPS)
        scale = torch.exp(torch.where(narrower, uniform(0.25, 0.9), uniform(-0.25, 0.25)))
        x = (self.across + 0.5 - WIDTH / 2 - uniform(-0.1, 0.1) * WIDTH) / scale + WIDTH / 2
        y = (self.down + 0.5 - HEIGHT / 2 - uniform(-0.1, 0.1) * HEIGHT) / scale + HEIGHT / 2
        x = torch.where(uniform(0, 1) < 0.5, WIDTH - x, x).floor().long()
        y = y.floor().long()
        inside = (x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT)
        x, y = x.clamp(0, WIDTH - 1), y.clamp(0, HEIGHT - 1)

        def moved(frame, to_x, to_y):
            return frame.index_select(-2, to_y[:, 0]).index_select(-1, to_x[0])

        data = torch.stack([moved(frame, *to) for frame, *to in zip(cells, x, y)])
        inside &= (data != 0).any(1)  # in a flat image, there is nothing above and below
        data = data * (inside[:, None] / UNIT)
        ids = torch.stack([moved(frame, *to) for frame, *to in zip(truth, x, y)]).long()
        ids[~inside] = DONT_CARE
        self.see_closer(data, scale, inside, narrower)
        for number in () if is_calm else (253, 254):
            self.paste(data, ids, number, uniform)
        self.mark(data, ids, uniform)
        noise = torch.randn(BATCH, HEIGHT, WIDTH, generator=random, device=x.device)
        data[:, 0] = data[:, 0] * uniform(0.8, 1.25) + uniform(-0.2, 0.2) + noise * uniform(0, 0.03)
        data[:, 1:3] *= uniform(0.7, 1.4)[:, None]
        data[:, [3, 7]] *= uniform(0.85, 1.15)[:, None]
        data[:, 5:7] *= uniform(0.8, 1.25)[:, None]
        without = (uniform(0, 1) >= 0.1).float()
        data[:, 5] *= without  # no floor
        data[:, 7] *= without
        data[:, 6] *= (uniform(0, 1) >= 0.1).float()  # no background
        return with_surroundings(data, inside).contiguous(memory_format=torch.channels_last), self.targets(ids)

    def see_closer(self, all_data, scale, inside, narrower):
        """A crop as a camera with a narrower field of view would see it; recomputes the inputs that hint_input()
        normalises by the image."""
        import torch

        chosen = narrower[:, 0, 0].nonzero()[:, 0]
        if len(chosen) == 0:
            return
        data, inside = all_data[chosen], inside[chosen]
        count = inside.sum((1, 2), keepdim=True).clamp(min=1)
        mean = (data[:, 0] * inside).sum((1, 2), keepdim=True) / count
        spread = (((data[:, 0] - mean) ** 2 * inside).sum((1, 2), keepdim=True) / count).sqrt()
        data[:, 0] = ((data[:, 0] - mean) / (spread + 0.1)).clamp(-4, 4)
        nearest = torch.where(data[:, 4] > 0, data[:, 3], torch.nan).flatten(1).nanquantile(0.98, 1)
        nearest = nearest.nan_to_num(1.0).clamp(min=0.02)[:, None, None, None]
        data[:, [3, 7]] = (data[:, [3, 7]] / nearest).clamp(max=2)
        data[:, 5:7] = (data[:, 5:7] * scale[chosen, None]).clamp(-1, 3)
        data[:, 10] = 2 * self.down / HEIGHT - 1
        all_data[chosen] = data * inside[:, None]

    def paste(self, data, ids, number, uniform):
        """Pastes an object of a sample's neighbour in front of what is there, mostly onto another object."""
        import torch

        device = data.device
        neighbour = torch.cat([half.roll(1) for half in torch.arange(BATCH, device=device).split(BATCH // 2)])
        to = (uniform(0, 1)[:, 0, 0] < PASTES).nonzero()[:, 0]
        if len(to) == 0:
            return
        from_ = neighbour[to]
        from_ids, to_ids = ids[from_], ids[to]
        counts = torch.zeros(len(to), 256, device=device).scatter_add(
            1, from_ids.flatten(1), torch.ones(len(to), HEIGHT * WIDTH, device=device))
        fits = (counts > 16) & (counts < 0.15 * HEIGHT * WIDTH)
        fits[:, 0] = fits[:, DONT_CARE] = False
        score, chosen = (fits * uniform(0.01, 1, fits.shape)).max(1)
        mask = (from_ids == chosen[:, None, None]) & (score > 0)[:, None, None]
        area = mask.sum((1, 2), keepdim=True).clamp(min=1)
        centre_x = (mask * self.across).sum((1, 2), keepdim=True) / area
        centre_y = (mask * self.down).sum((1, 2), keepdim=True) / area
        onto_object = uniform(0, 1, (len(to), 1, 1)) < 0.7
        wanted = torch.where(onto_object, (to_ids > 0) & (to_ids < DONT_CARE), to_ids < DONT_CARE)
        place = (wanted * uniform(0.01, 1, wanted.shape)).flatten(1).argmax(1)[:, None, None]
        reach = area.sqrt()
        move_x = (place % WIDTH - centre_x + reach * uniform(-1, 1, reach.shape)).round().long()
        move_y = (torch.div(place, WIDTH, rounding_mode="floor") - centre_y + reach * uniform(-0.5, 0.5, reach.shape)).round().long()
        # From here on, lists of cells: the pasted ones.
        sample, y, x = mask.nonzero().unbind(1)
        from_y, from_x = y, x
        y, x = y + move_y[sample, 0, 0], x + move_x[sample, 0, 0]
        is_there = (x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT)
        is_there &= to_ids[sample, y.clamp(0, HEIGHT - 1), x.clamp(0, WIDTH - 1)] < DONT_CARE
        sample, y, x, from_y, from_x = (v[is_there] for v in (sample, y, x, from_y, from_x))
        new, old = data[from_[sample], :, from_y, from_x], data[to[sample], :, y, x]

        def of_cells(values):
            all_cells = torch.zeros(mask.shape, device=device)
            all_cells[sample, y, x] = values
            return all_cells

        def total(values):
            return of_cells(values).sum((1, 2))

        # Scaled to be in front of what it hides.
        has = (new[:, 4] > 0).float()
        own = total(new[:, 3] * has) / total(has).clamp(min=1)
        behind = of_cells(old[:, 3]).amax((1, 2))
        nearer = ((behind * uniform(1.02, 1.35, behind.shape) + 0.02) / own.clamp(min=0.02)).clamp(0.3, 3)
        disparity = (new[:, 3] * nearer[sample]).clamp(0, 2)
        # Quarters of a pixel per unit of channel 3, from the cells whose difference from the ground is not limited.
        whole = data[to]
        above = whole[:, 3] - whole[:, 7]
        known = (whole[:, 4] > 0) & (whole[:, 7] > 0) & (whole[:, 5].abs() < 0.95)
        unit = (whole[:, 5] * above * known).sum((1, 2)) / (above ** 2 * known).sum((1, 2)).clamp(min=1e-3)
        unit = unit[sample]
        new[:, 5] = torch.where((old[:, 7] > 0) & (new[:, 4] > 0), (unit * (disparity - old[:, 7])).clamp(-1, 3), 0.0)
        background = unit * old[:, 3] - old[:, 6]
        over = torch.where(old[:, 6] > 2.95, 3.0, (unit * disparity - background).clamp(-1, 3))
        new[:, 6] = torch.where((old[:, 4] > 0) & (new[:, 4] > 0) & (unit > 0), over, new[:, 6])
        new[:, 3] = disparity
        for kept in (7, 10, 11):
            new[:, kept] = old[:, kept]
        data[to[sample], :, y, x] = new
        ids[to[sample], y, x] = number

    def mark(self, data, ids, uniform):
        """Draws a flat round or rectangular mark, no object, where there may be floor: a lid, a drain, a sticker. At its rim,
        and sometimes within, there are disparities of the floor."""
        import torch

        width = torch.exp(uniform(np.log(4), np.log(22)))
        height = width * uniform(0.3, 1)
        power = torch.where(uniform(0, 1) < 0.7, 2.0, 6.0)
        border = torch.where(uniform(0, 1) < 0.5, 0.0, float(WIDTH)) + uniform(-8, 8)
        x = self.across - torch.where(uniform(0, 1) < AT_BORDER, border, uniform(0, WIDTH))
        y = self.down - uniform(0, HEIGHT)
        radius = ((x / width).abs() ** power + (y / height).abs() ** power) ** (1 / power)
        floor = (uniform(0, 1) < MARKS) & (ids == 0) & (data[:, 7] > 0)
        floor &= (data[:, 4] == 0) | (data[:, 5].abs() < 0.35)
        on_mark = floor & (radius <= 1)
        rim = floor & ((radius - 1).abs() * height < 0.8)
        sign = torch.where(uniform(0, 1) < 0.5, -1.0, 1.0)
        data[:, 0] += on_mark * sign * uniform(0.2, 2)
        for colour in (1, 2):
            data[:, colour] += on_mark * data[:, 11] * uniform(-0.4, 0.4)
        cells = (BATCH, HEIGHT, WIDTH)
        data[:, 8] = torch.where(rim, torch.maximum(data[:, 8], uniform(0.2, 4) * uniform(0.6, 1, cells)), data[:, 8])
        data[:, 9] = torch.where(rim & (uniform(0, 1, cells) < 0.7), uniform(0.3, 1, cells), data[:, 9])
        seen = rim | (on_mark & (uniform(0, 1) < 0.5))
        seen &= (data[:, 4] == 0) & (uniform(0, 1, cells) < uniform(0.5, 1))
        off = uniform(-0.12, 0.12, cells)
        for channel, value in ((3, data[:, 7]), (4, uniform(0.3, 1, cells)), (5, off), (6, off)):
            data[:, channel] = torch.where(seen, value, data[:, channel])

    def targets(self, ids):
        """Per cell: object, outline, centre (2), log₂ of the size, root of the size, known."""
        import torch

        known = ids < DONT_CARE
        is_object = known & (ids > 0)
        out = torch.zeros(BATCH, 7, HEIGHT, WIDTH, device=ids.device)
        out[:, 0], out[:, 6] = is_object, known
        outline = torch.zeros_like(known)
        for down, across in ((0, 1), (1, 0)):
            here, there = ids[:, :HEIGHT - down, :WIDTH - across], ids[:, down:, across:]
            parts = (here != there) & (here < DONT_CARE) & (there < DONT_CARE)
            outline[:, :HEIGHT - down, :WIDTH - across] |= parts
            outline[:, down:, across:] |= parts
        out[:, 1] = outline
        flat = torch.where(known, ids, 0).flatten(1)

        def sums(values):
            return torch.zeros(BATCH, 256, device=ids.device).scatter_add(1, flat, values.flatten(1))

        grid = torch.zeros(BATCH, HEIGHT, WIDTH, device=ids.device)
        size = sums(grid + 1)
        least = size.clamp(min=1)
        table = torch.stack([sums(grid + self.across) / least, sums(grid + self.down) / least, least.log2(), size.sqrt()])
        table[:, :, 0] = 0
        for k in range(4):
            out[:, 2 + k] = table[k].gather(1, flat).view(BATCH, HEIGHT, WIDTH)
        return out


# ---- network

def network(width):
    from torch import nn
    import torch

    def layer(inputs, outputs, stride=1, side=3):
        return nn.Sequential(nn.Conv2d(inputs, outputs, side, stride, side // 2, bias=False), nn.BatchNorm2d(outputs),
                             nn.ReLU())

    first, second, third, fourth, last = (int(8 * round(width * n / 8)) for n in (FIRST, SECOND, THIRD, FOURTH, LAST))

    class Network(nn.Module):
        def __init__(self):
            super().__init__()
            self.steps = nn.ModuleList([
                layer(CHANNELS, first, 2), layer(first, first), layer(first, second, 2), layer(second, second),
                layer(second, third, 2), layer(third, third), layer(third, third),
                layer(third, third, 2), layer(third, third), layer(third, third),
                layer(third, fourth, 2), layer(fourth, fourth), layer(fourth, fourth), layer(fourth, third, 1, 1),
                layer(third, third, 1, 1), layer(third, third), layer(third, second, 1, 1), layer(second, second),
                layer(second, first, 1, 1), layer(first, last)])
            self.end = nn.Conv2d(last, 4 * len(STEPS_PER_UNIT), 1)
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
                return nn.functional.interpolate(small, scale_factor=2)[:, :, :like.shape[2], :like.shape[3]] + like

            half = run((0, 1), data)
            quarter = run((2, 3), half)
            eighth = run((4, 5, 6), quarter)
            sixteenth = run((7, 8, 9), eighth)
            up = run((10, 11, 12, 13), sixteenth)
            up = run((14,), doubled(up, sixteenth))
            up = run((15, 16), doubled(up, eighth))
            up = run((17, 18), doubled(up, quarter))
            up = run((19,), doubled(up, half))
            with torch.autocast(data.device.type, enabled=False):
                return nn.functional.pixel_shuffle(self.end(up.float()), 2)

    return Network()


def of_library(net, path, frames):
    """Sets the weights to those of a file of the library, as if every activation had the scale of the input: the
    function is the same. What batch normalisation would have seen is taken from frames. The network may be wider than
    that of the file: the further channels of a layer see all inputs at random, and no older channel sees them, so the
    function is the same then, too (the idea of Chen et al. 2016, "Net2Net")."""
    import torch

    def tensor(values):
        return torch.tensor(np.array(values, np.float32))

    olds, layers = [], fitted_files.read_network(path)
    if len(layers) != len(net.steps) + 1:
        raise SystemExit(f"fit_hints.py: the network of {path} has {len(layers)} layers, expected {len(net.steps) + 1}")
    for step, (shape, whole, bias, scale) in zip([*net.steps, net.end], layers):
        inputs, outputs, side = shape[:3]
        is_end = step is net.end
        unit = scale.astype(np.float64)
        if is_end:  # the kernels need a multiple of 8 outputs
            outputs = 4 * len(STEPS_PER_UNIT)
            unit = unit * UNIT / np.pad(np.repeat(np.array(STEPS_PER_UNIT, float), 4), (0, 4), constant_values=1)
        weight = whole.reshape(side, side, inputs, -1).transpose(3, 2, 0, 1) * unit[:, None, None, None]
        offset = bias * unit / UNIT
        olds.append(outputs)
        of_step = (step if is_end else step[0]).weight
        if min(of_step.shape[0] - outputs, of_step.shape[1] - inputs) < 0:
            raise SystemExit(f"fit_hints.py: the network of {path} is wider than the one to be fitted")
        with torch.no_grad():
            of_step[:outputs, inputs:] = 0
            of_step[:outputs, :inputs] = tensor(weight[:outputs])
            if is_end:
                step.bias.copy_(tensor(offset[:outputs]))
            else:
                norm = step[1]
                norm.bias[:outputs] = tensor(offset)
                norm.running_mean.zero_(), norm.running_var.fill_(1 - norm.eps)
    norms = [step[1] for step in net.steps]
    seen = {norm: [] for norm in norms}
    hooks = [norm.register_forward_hook(lambda norm, given, _: seen[norm].append(torch.stack(
        [given[0].mean((0, 2, 3)), (given[0] ** 2).mean((0, 2, 3))]))) for norm in norms]
    net.eval()
    with torch.no_grad():
        for data in frames.inputs_to_calibrate():
            net(data)
        for hook in hooks:
            hook.remove()
        for step, old in zip(net.steps, olds):
            convolution, norm = step[0], step[1]
            mean, square = torch.stack(seen[norm]).mean(0)
            variance = (square - mean ** 2).clamp(min=1e-4)
            norm.bias[:old] += mean[:old]
            norm.weight[:old] = (variance + norm.eps).sqrt()[:old]
            # The length of a filter changes nothing but the size of its steps.
            length = convolution.weight.flatten(1).norm(dim=1).clamp(min=1e-6)
            convolution.weight /= length[:, None, None, None]
            norm.running_mean.copy_(mean / length)
            norm.running_var.copy_(variance / length ** 2)
    net.train()


def towards_start(net, start, share, frames):
    """Weights that are `share` of `start`, a state of the network, and the rest those of `net`, with the statistics of batch normalisation
    measured again: a mean has less noise than either."""
    import torch

    with torch.no_grad():
        for new, old in zip(net.state_dict().values(), start.values()):
            if new.dtype.is_floating_point:
                new.lerp_(old, share)
        for step in net.steps:
            step[1].reset_running_stats()
            step[1].momentum = None  # the mean of all batches
        sampler = Sampler(frames, 1)  # calm: no close-ups, no pasted objects
        net.train()
        for turn in range(COUNTED):
            net(sampler.batch(1 + turn)[0])
    return net.eval()


def loss_of(output, truth, down, across):
    """The four parts of the loss: object, outline, centre, size."""
    import torch
    from torch.nn import functional as F

    def shared(output, truth, weight, **more):
        return (F.binary_cross_entropy_with_logits(output, truth, reduction="none", **more) * weight).sum() / (weight.sum() + 1)

    known, objects, root = truth[:, 6], truth[:, 0], truth[:, 5] + 1
    # Each object is weighted by the root of its size.
    weight = objects / root
    x = (across + 16 * output[:, 2] - truth[:, 2]) / root
    y = (down + 16 * output[:, 3] - truth[:, 3]) / root
    middle = F.smooth_l1_loss(x, 0 * x, reduction="none", beta=0.1) + F.smooth_l1_loss(y, 0 * y, reduction="none", beta=0.1)
    size = F.smooth_l1_loss(output[:, 4], truth[:, 4], reduction="none", beta=0.3)
    # Small objects are the ones that are lost: a cell of theirs counts more.
    share = torch.where(objects > 0, (SHARED_ROOT / root).clamp(0.5, 3), known)
    return torch.stack([shared(output[:, 0], objects, known * share),
                        shared(output[:, 1], truth[:, 1], known, pos_weight=torch.tensor(2.0, device=output.device)),
                        (middle * weight).sum() / (weight.sum() + 1), 0.3 * (size * weight).sum() / (weight.sum() + 1)])


def has_fast_bfloat16(device):
    """Whether products of 16-bit floating-point numbers are faster than those of 32 bits: on a processor, with AMX."""
    import torch

    if device.type != "cpu":
        return torch.cuda.is_bf16_supported()
    processor = pathlib.Path("/proc/cpuinfo")
    return processor.exists() and "amx_bf16" in processor.read_text()


def orthogonal(matrix, kind):
    """Nearly U·Vᵀ of the singular value decomposition U·S·Vᵀ: five Newton-Schulz steps (Jordan et al. 2024, "Muon: An
    optimizer for hidden layers in neural networks"), in numbers of this kind."""
    out = (matrix / (matrix.norm() + 1e-7)).to(kind)
    is_tall = out.shape[0] > out.shape[1]
    out = out.T if is_tall else out
    for _ in range(5):
        square = out @ out.T
        out = 3.4445 * out + (-4.7750 * square + 2.0315 * square @ square) @ out
    return (out.T if is_tall else out).float()


def orthogonal_steps(filters, rate, kind):
    """An optimizer of the filters of convolutions before batch normalisation, whose length means nothing: every step
    turns all of a layer's filters by the same share of their length, in the mean, along the nearest orthogonal matrix
    to the momentum of the gradient (source: see orthogonal())."""
    import torch

    class Orthogonal(torch.optim.Optimizer):
        @torch.no_grad()
        def step(self):
            for group in self.param_groups:
                for weight in group["params"]:
                    momentum = self.state[weight].setdefault("momentum", torch.zeros_like(weight))
                    momentum.mul_(0.95).add_(weight.grad)
                    ahead = (weight.grad + 0.95 * momentum).flatten(1)
                    weight.mul_(len(weight) ** 0.5 / weight.norm())
                    weight.sub_(orthogonal(ahead, kind).view(weight.shape), alpha=group["lr"])

    return Orthogonal(filters, {"lr": rate})


def fitted(frames, steps, width, checkpoint, start=None, rate=RATE, keep=0.0):
    """A network fitted to the frames; its weights are an exponential average over the last steps, and a share `keep` of the start's."""
    import torch

    torch.manual_seed(SEED)
    torch.set_num_threads(2)  # sums depend on it
    device = frames.device
    net, mean = (network(width).to(device, memory_format=torch.channels_last) for _ in range(2))
    if start and start.suffix == ".bin":
        of_library(net, start, frames)
    elif start:
        net.load_state_dict(torch.load(start, map_location=device))
    first_state = {name: value.clone() for name, value in net.state_dict().items()}
    mean.load_state_dict(first_state)
    kept, new = ([v for v in one.state_dict().values() if v.dtype.is_floating_point] for one in (mean, net))
    digest = start and hashlib.sha256(start.read_bytes()).hexdigest()
    # A fit that goes on does not see again what the one before it saw.
    sampler = Sampler(frames, steps, int(digest[:6], 16) if digest else SEED)
    filters = [step[0].weight for step in net.steps]
    others = [p for p in net.parameters() if all(p is not f for f in filters)]
    short = has_fast_bfloat16(device)
    optimizers = [orthogonal_steps(filters, rate, torch.bfloat16 if short else torch.float32),
                  torch.optim.AdamW(others, min(RATE_OF_OTHERS, 0.3 * rate), weight_decay=DECAY)]
    schedules = [torch.optim.lr_scheduler.LambdaLR(
        o, lambda step: min((step + 1) / (WARM_UP * steps), (1 - step / steps) / (1 - WARM_UP))) for o in optimizers]
    key = {"steps": steps, "rate": rate, "frames": len(frames), "bfloat16": short, "start": digest,
           "shapes": [tuple(v.shape) for v in net.state_dict().values()]}
    parts = {"net": net, "mean": mean} | {f"optimizer{i}": o for i, o in enumerate(optimizers)} \
        | {f"schedule{i}": s for i, s in enumerate(schedules)}
    first = 0
    if checkpoint.exists():
        state = torch.load(checkpoint, map_location=device)
        if state.get("key") == key:
            first = state["step"]
            for name, part in parts.items():
                part.load_state_dict(state[name])
            print(f"goes on after step {first}", flush=True)
    begin = saved = time.time()
    losses = torch.zeros(4, device=device)
    for step in range(first, steps):
        data, truth = sampler.batch(step)
        with torch.autocast(device.type, torch.bfloat16, enabled=short):
            output = net(data)
        loss = loss_of(output, truth, sampler.down, sampler.across)
        net.zero_grad()
        loss.sum().backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        for part in (*optimizers, *schedules):
            part.step()
        losses += (loss.detach() - losses) * (0.02 if step > first else 1)
        with torch.no_grad():
            torch._foreach_mul_(kept, 0.99)
            torch._foreach_add_(kept, new, alpha=0.01)
        if (step + 1) % 100 == 0:
            print(f"{time.time() - begin:6.0f} s  step {step + 1}: {' '.join(f'{v:.3f}' for v in losses.tolist())}", flush=True)
        if time.time() - saved > CHECKPOINT_SECONDS:
            saved = time.time()
            unfinished = checkpoint.with_suffix(".unfinished")
            torch.save({name: part.state_dict() for name, part in parts.items()}
                       | {"step": step + 1, "key": key}, unfinished)
            unfinished.replace(checkpoint)
    return (towards_start(mean, first_state, keep, frames) if keep > 0 else mean).cpu().eval()


def rounded(net, frames):
    """The layers as integers: (inputs, outputs, side, stride, least), weights, biases and scales of each."""
    import torch

    seen = [0.0] * len(net.steps)
    with torch.no_grad():
        for data in frames.inputs_to_calibrate():
            net(data.cpu(), seen)
    # Summands need a common scale: the decoder's 1×1 layers use that of the encoder's.
    for small, like in ((13, 9), (14, 6), (16, 3), (18, 1)):
        seen[small] = seen[like] = max(seen[small], seen[like])
    scales = [GREATEST / 2 / max(s, 1e-6) for s in seen]  # headroom: twice the largest activation seen
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
        of = scales[i - 1] if i else UNIT
        unit = np.maximum(np.abs(weight).max(axis=(1, 2, 3)), 1e-9) / 127
        whole = np.round(weight / unit[:, None, None, None]).astype(np.int64)
        whole_bias = np.round(bias / unit * of).astype(np.int64)
        side, stride = convolution.kernel_size[0], convolution.stride[0]
        assert (np.abs(whole).sum(axis=(1, 2, 3)) * GREATEST + np.abs(whole_bias)).max() < 2**31, "a sum may overflow"
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


def keep_memory():
    """Large arrays are not given back to the system in every step: that takes as long as the sums themselves."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):  # glibc: no mmap, no trimming, at least 512 MB more at a time
        for option, value in ((-4, 0), (-1, 2**31 - 1), (-2, 2**29)):
            libc.mallopt(option, value)


def fit(arguments):
    import torch

    keep_memory()
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    frames = Frames(arguments.stores, arguments.worlds, device)
    print(f"{len(frames)} frames, {arguments.steps} steps, on {device}", flush=True)
    arguments.work.mkdir(parents=True, exist_ok=True)
    net = fitted(frames, arguments.steps, arguments.width, arguments.work / f"{arguments.name}.checkpoint",
                 arguments.start, arguments.rate, arguments.keep)
    torch.save(net.state_dict(), arguments.work / f"{arguments.name}.pt")
    layers = rounded(net, frames)
    write(layers, arguments.work / arguments.name)
    if arguments.out:
        write_fitted(layers, arguments.out / "hints.bin")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("gather")
    command.add_argument("tool", type=pathlib.Path)
    command.add_argument("store", type=pathlib.Path)
    command.add_argument("folders", type=pathlib.Path, nargs="+", help="folders of frames")
    command = commands.add_parser("fit")
    command.add_argument("stores", type=pathlib.Path, nargs="+")
    command.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/fit"))
    command.add_argument("--out", type=pathlib.Path, help="where the fitted numbers are written (cairn/fitted)")
    command.add_argument("--width", type=float, default=1.0, help="of all layers")
    command.add_argument("--name", default="hints", help="of the file in the work folder")
    command.add_argument("--start", type=pathlib.Path,
                         help="weights of an earlier fit (.pt) or of the library (hints.bin); the fit goes on from it")
    command.add_argument("--steps", type=int, default=22000)
    command.add_argument("--rate", type=float, default=RATE, help="by which filters turn in a step, at most; less where a fit goes on")
    command.add_argument("--keep", type=float, default=0.0, help="share of the start's weights in the result")
    command.add_argument("--worlds", type=int, default=10**9, help="frames used of the first store")
    arguments = parser.parse_args()
    if arguments.command == "fit":
        if not 0 <= arguments.keep < 1:
            parser.error(f"--keep: found {arguments.keep:g}, expected 0 to less than 1")
        if arguments.keep > 0 and not arguments.start:
            parser.error("--keep: needs --start, of which a share is kept")
        return fit(arguments)
    gather(arguments.tool, arguments.store, [f for folder in arguments.folders for f in frames_in(folder)])


if __name__ == "__main__":
    main()
