"""Logs as a campaign: a row for each span of time, with what the filter says of the knobs in it.

To the filter the knobs are a quadratic about where each season has moved, so a campaign of logs needs no further run.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....scenarios.measured.table import Campaign
from ....scenarios.nuisances import Nuisance
from ..library.knobs import Knob
from .curves import Curves
from .entries import Entries, Seen
from .formula import Parts
from .logs import Quadratics
from .observe import Observed
from .plant import Plant

#: Information of a direction of the knobs, over that of its prior, below which it is left out.
FAINT = 0.02


class Logged(Observed):
    """A campaign of spans of logs: entries are independent sums that tell how far the knobs have moved in a span.

    Args:
        plant: the rig
        campaign: a row for each span, a test each
        knobs: what may differ
        told: what each span says of what moves of its knobs do
        root: how each span's knobs differ from the machine's values, for independent normal numbers (n, k, r)
        curves: moves of knobs -> what they do
    """

    def __init__(
        self,
        plant: Plant,
        campaign: Campaign,
        knobs: Sequence[Knob],
        told: Quadratics,
        root: np.ndarray,
        curves: Curves,
    ) -> None:
        names = [knob.name for knob in knobs]
        differing = [*map(str, range(root.shape[2])), "day"]
        super().__init__(plant, campaign, [Nuisance(name, {}, 1.0, 1.0) for name in differing], {}, {})
        self.place, self.curves = {name: k for k, name in enumerate(names)}, curves
        sd = np.array([k.sd for k in knobs])
        own = [_told(eta, H, sd) for eta, H in zip(told.eta, told.H, strict=True)]
        #: Slopes of the entries by the knobs in their spans (m, k).
        self.by = np.concatenate([B for _, B in own])
        row = np.repeat(np.arange(campaign.n), [len(y) for y, _ in own])
        #: The same by what the machine's knobs differ by (m, r).
        self.tilt = self.felt(root, row)
        measured = np.concatenate([y for y, _ in own])
        none, ones = np.zeros(len(row), dtype=int), np.ones(len(row))
        self._hold(Entries(none - 1, none, row, row, measured, ones, row, none, ones))

    def felt(self, root: np.ndarray, row: np.ndarray) -> np.ndarray:
        """What columns of each span's knobs (n, k, r) do to entries in rows (m, r)."""
        return np.asarray(np.einsum("mk,mkr->mr", self.by, root[row]))

    def moves(self, parts: Parts) -> np.ndarray:
        """How far causes move the knobs in each span (n, k)."""
        found = np.zeros((self.campaign.n, self.by.shape[1]))
        for formula, t in parts:
            value, _, _ = formula.physics(t, {}, self.sensors, self.features)
            for name, moved in zip(formula.paths, value, strict=False):
                found[:, self.place[name]] += moved
        return found

    def at(self, z: np.ndarray, parts: Parts) -> Seen:
        """The entries and their derivatives; as for any campaign."""
        does, slope = self.curves.at(self.moves(parts))
        by = [self.tilt, np.zeros((self.m, 1))]
        for formula, t in parts:
            _, by_t, _ = formula.physics(t, {}, self.sensors, self.features)
            ways = [
                self.by[:, [k := self.place[name]]] * (slope[:, [k]] * way)[self.row]
                for name, way in zip(formula.paths, by_t, strict=False)
            ]
            by.append(np.sum(ways, axis=0))
        shown = self.tilt @ z[:-1] + (self.by * does[self.row]).sum(axis=1)
        return Seen(shown, np.concatenate(by, axis=1), np.zeros((self.m, len(self.given), self.height)))

    def tangents(self, z: np.ndarray, parts: Parts, candidates: Parts) -> np.ndarray:
        """First-order effects (m, k) of the sizes of candidates."""
        begin = len(z)
        effects = [self.at(z, [(formula, np.r_[0.0, t[1:]])]).by[:, begin] for formula, t in candidates]
        return np.array(effects).reshape(len(effects), self.m).T

    def shown_by(self, z: np.ndarray, parts: Parts) -> np.ndarray:
        """What the spans show (m,)."""
        return self.at(z, parts).shown


def _told(eta: np.ndarray, H: np.ndarray, sd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Independent sums (r,) with unit variance that say the same of the knobs, and their slopes by them (r, k)."""
    information, turn = np.linalg.eigh(sd[:, None] * H * sd)
    kept = information > FAINT
    root, turn = np.sqrt(information[kept]), turn[:, kept].T
    return (turn * sd) @ eta / root, root[:, None] * turn / sd
