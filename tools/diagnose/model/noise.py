"""The scatter of all readings: a sum of named covariance terms, each made by one function here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from scipy.linalg import block_diag

from .entries import DWELL, Measured, Seen, Term

#: Prior standard deviations of the logarithms of scales: readings of a sensor.
READING = 0.25
#: Of the room.
INPUT = 0.35
#: Days.
DAY = 0.35
#: Share of a nuisance's prior by which another filling or mounting changes it.
REFILLED = 0.5
#: Share of a loss's prior by which another oil changes it beside its viscosity: additives and base oils of the same one
#: differ in friction as much as a rig does from its file. Of the measured campaign, oils left out: 5.1 K without, 4.0.
OIL = 1.0
#: The same beside a healthy campaign, where that prior is four times as wide.
OIL_BESIDE_REFERENCE = 0.25
#: Share of a nuisance's prior by which it follows speed, load and room otherwise than its law, over a spread of each.
#: Of 15 sound machines whose losses so do, 8 raised an alarm without it, 1 with it, none with .25, which finds fewer.
LAW = 0.15
#: The same of what rules give: against SKF's, bearings after Palmgren have .5; seals of ISO/TR 14179-2 .25.
ROUGH_LAW = 0.5
#: Share of the tolerance by which an instrument drifts from one campaign to the next; of torques, zeroed anew.
DRIFT = (0.2, 0.5)
#: A further probe of the same body stands elsewhere: standard deviation of the share of the wall or room it sees.
PLACEMENT_ERROR = 0.08
#: What the model leaves of a rig that a reference tells: share of the typical reading's rise or torque, per feature.
REMAINDER = {"temperature": 0.8, "other": 0.0005}
#: Over how long a way in the conditions, in units of their spread, a remainder is smooth.
SMOOTH = 1.3
#: Variance of a smoothed course over that of independent samples, which those of a probe are not quite.
ALLOWED = 1.5
#: What the model leaves of a course [K].
LEFT = 0.25
#: Over how long a share of the dwell.
LENGTH = 0.3
#: Decay, per dwell, of what a start at another temperature than that of the room as read leaves in a course.
BEGUN = 3.0
#: Powers of the share of the dwell to come by which a remainder fades along a course: the highest are the first
#: minutes, when every rig's gears, oil and wall warm in their own way, and the oil is as thick as the room is cold.
FADING = (1, 2, 4, 8, 16)


def input_scatter(o: Measured, seen: Seen) -> Iterator[tuple[str, np.ndarray]]:
    """Scatter of each given sensor, through the model: name and effects of all rows' readings (m, n)."""
    same = o.campaign.test[o.row][:, None] == o.campaign.test[None, :]
    for g, s in enumerate(o.given):
        effect = seen.local[:, g][:, o.half]  # m, n: by the reading of each row's half, in the entry's own test
        yield s.name, s.repeat_sd * effect * same


def given_tolerance(o: Measured, seen: Seen) -> Iterator[tuple[str, np.ndarray]]:
    """Fixed tolerance of each given sensor, through the model: name and effect (m,)."""
    for g, s in enumerate(o.given):
        signs = o.signs[s.name][o.rows][o.campaign.test[o.row]]  # m, H
        yield s.name, -s.offset_sd * (seen.local[:, g] * signs).sum(axis=1)


def placement_error(o: Measured, seen: Seen) -> np.ndarray:
    """Placement error of every further probe of a body: effects (m, k) of reading partly what surrounds it."""
    columns, known, place = [], set[str](), list(zip(o.row, shares(o), strict=True))
    walls = [i for i, s in enumerate(o.read) if s.kind == "wall_temp"]
    for i, s in enumerate(o.read):
        if s.kind.endswith("_temp") and s.reads in known and walls:
            mine, others = ((o.entries.sensor == k).nonzero()[0] for k in (i, walls[0]))
            own, wall = ({place[e]: seen.shown[e] for e in entries} for entries in (mine, others))
            effect = np.array([own[at] - wall.get(at, own[at]) if at in own else 0.0 for at in place])
            columns.append(np.where(o.entries.sensor == i, PLACEMENT_ERROR * effect, 0.0))
        known.add(s.reads)
    return np.array(columns).reshape(len(columns), o.m).T


def per_group(effect: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """One column for each group of entries (m, groups)."""
    labels = np.unique(groups)
    return np.asarray(effect[:, None] * (groups[:, None] == labels))


def walk(effect: np.ndarray, test: np.ndarray) -> np.ndarray:
    """Effects (m, tests) of the steps to each test, the first from where the instrument was adjusted."""
    return np.asarray(effect[:, None] * (test[:, None] >= np.arange(int(test.max()) + 1)))


def smooth_features(campaigns: Sequence[Measured], points: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Features of a smooth remainder, the same in all campaigns: constant and linear ones (n, c); all, with products
    and squares (n, k). The last `points` campaigns do not count in where they are zero and one.
    """
    raw = [np.array([*(o.sensors[s.name] for s in o.given), o.campaign.direction]) for o in campaigns]
    whole = np.concatenate(raw[: len(raw) - points], axis=1)
    centre, spread = whole.mean(axis=1, keepdims=True), whole.std(axis=1, keepdims=True)
    kept = (spread > 1e-9 * np.maximum(abs(whole).max(axis=1, keepdims=True), 1e-12))[:, 0]
    room = [s.kind == "ambient" for s in campaigns[0].given] + [False]
    levels = np.array([len(np.unique(values)) for values in whole])[kept]
    found = []
    for values in raw:
        z = ((values - centre) / np.maximum(spread, 1e-12))[kept]
        quiet = np.array(room)[kept]
        own = [np.ones(values.shape[1]), *z]
        linear = np.array(own).T
        moving, curved = z[~quiet], levels[~quiet] > 2  # a square needs three levels in all campaigns together
        own += [a * b for i, a in enumerate(moving) for k, b in enumerate(moving[i:], start=i) if k > i or curved[i]]
        found.append((linear, np.array(own).T))
    return found


def remainder(campaigns: Sequence[Measured], points: int) -> np.ndarray:
    """Effects (M, k) of what no parameter removes of a rig that is not the model, the same in all its campaigns."""
    blocks, first = [], campaigns[0]
    for o, (linear, own) in zip(campaigns, smooth_features(campaigns, points), strict=True):
        fades = fading(o, linear) if any(c.campaign.series for c in campaigns) else np.zeros((o.m, 0))
        columns, names = [], [s.name for s in o.read]
        for s in first.read:
            index = names.index(s.name) if s.name in names else len(names)
            size = REMAINDER["other"] * np.nanmean(np.abs(first.campaign.values[s.name]))
            sd = REMAINDER["temperature"] if s.kind.endswith("_temp") else size
            mine = (o.entries.sensor == index)[:, None]
            columns += [np.where(mine, sd * own[o.row], 0.0), np.where(mine, sd * fades, 0.0)]
        blocks.append(np.concatenate(columns, axis=1))
    return np.concatenate(blocks)


def alike(o: Measured) -> np.ndarray:
    """Correlation (m, m) of what is smooth in the conditions and the running order, for one sensor."""
    features = np.column_stack([o.conditions(), 2.0 * o.campaign.progress])[o.row]
    features = np.column_stack([features, SMOOTH / LENGTH * shares(o)]) if o.campaign.series else features
    distance = ((features[:, None, :] - features[None, :, :]) ** 2).sum(axis=2)
    return np.asarray(np.exp(-0.5 * distance / SMOOTH**2))


def by_name(parts: Iterable[tuple[str, int, np.ndarray]], sizes: Sequence[int]) -> dict[str, np.ndarray]:
    """Columns of all parts of a name, side by side in the whole vector (M, sum k).

    Args:
        parts: name, number of the campaign, its columns
        sizes: entries of each campaign
    """
    ends, groups = np.cumsum(sizes), dict[str, list[np.ndarray]]()
    for name, k, columns in parts:
        whole = np.zeros((ends[-1], columns.shape[1]))
        whole[ends[k] - sizes[k] : ends[k]] = columns
        groups.setdefault(name, []).append(whole)
    return {name: np.concatenate(own, axis=1) for name, own in groups.items()}


def terms(
    campaigns: Sequence[Measured], seen: Sequence[Seen], day_sd: float, sd: np.ndarray, points: int = 0
) -> list[Term]:
    """All terms of some campaigns of one rig with the same instruments, at a linearisation.

    Args:
        campaigns: the first is the one in which causes act
        seen: what each shows there
        day_sd: standard deviation of the cooling from day to day
        sd: standard deviations of the nuisances but for the cooling of a day, which comes last
        points: how many campaigns, the last ones, are not measured but foreseen
    """
    sizes = [o.m for o in campaigns]
    pairs = list(enumerate(zip(campaigns, seen, strict=True)))
    each = [(k, o, i, s) for k, (o, _) in pairs for i, s in enumerate(o.read)]
    read = by_name([(s.name, k, np.where(o.kind == i, s.repeat_sd**2, 0.0)[:, None]) for k, o, i, s in each], sizes)
    found = [Term(f"readings of {name}", variance=v.sum(axis=1), loose=READING) for name, v in read.items()]
    inputs = [(n, k, c) for k, (o, s) in pairs for n, c in input_scatter(o, s)]
    given = by_name(sorted(inputs, key=lambda part: part[0]), sizes)
    found += [Term(f"readings of {name}", columns, loose=INPUT) for name, columns in given.items()]
    fixed = [(s.name, k, np.where(o.entries.sensor == i, s.offset_sd, 0.0)[:, None]) for k, o, i, s in each]
    fixed += [(n, k, c[:, None]) for k, (o, s) in pairs for n, c in given_tolerance(o, s)]
    torques = {s.name for s in campaigns[0].campaign.sensors if s.kind == "torque"}
    for name, own in by_name(fixed, sizes).items():
        found.append(Term(f"tolerance of {name}", np.column_stack([own.sum(axis=1), DRIFT[name in torques] * own])))
    days = (day_sd * per_group(s.by[:, len(sd)], o.campaign.test[o.row]) for _, (o, s) in pairs)
    found.append(Term("days", own := block_diag(*days), loose=DAY, passing=own))
    found.append(Term("further probes", block_diag(*(placement_error(o, s) for _, (o, s) in pairs))))
    fillings = [("fillings", k, c) for k, (o, s) in pairs for c in _fillings(o, s)]
    found += [Term(name, columns, passing=columns) for name, columns in by_name(fillings, sizes).items()]
    measured = len(campaigns) - points
    names = np.unique([oil for o in campaigns for oil in o.campaign.oil])
    if len(names) > 1:
        share = OIL if measured == 1 else OIL_BESIDE_REFERENCE
        found.append(Term("oils", np.concatenate([share * _oils(o, s, names) for _, (o, s) in pairs])))
    if measured == 1:
        found.append(Term("laws", laws(campaigns, seen, sd, points)))
    if any(o.campaign.series for o in campaigns):
        found += _logged(campaigns)
    if measured > 1:
        found.append(Term("remainder", remainder(campaigns, points)))
    return found


def _logged(campaigns: Sequence[Measured]) -> Iterator[Term]:
    """Terms of logged courses."""
    yield Term("courses", covariance=block_diag(*map(smoothed, campaigns)))
    yield Term("model of courses", covariance=block_diag(*map(model_error, campaigns)))
    yield Term("starts", block_diag(*map(start_error, campaigns)))
    stated = np.concatenate([o.entries.sensor < 0 for o in campaigns])
    yield Term("dwells as logged", variance=DWELL**2 * stated)


def laws(campaigns: Sequence[Measured], seen: Sequence[Seen], sd: np.ndarray, points: int) -> np.ndarray:
    """Effects (M, k), by nuisance, of losses and heat paths that follow the point otherwise than their laws say.

    With a healthy campaign of the same rig the remainder says it.
    """
    blocks = []
    for o, s, (linear, _) in zip(campaigns, seen, smooth_features(campaigns, points), strict=True):
        by = law_shares(o, sd) * s.by[:, : len(sd)]
        blocks.append((by[:, :, None] * linear[o.row, None, 1:]).reshape(o.m, -1))
    return np.concatenate(blocks)


def by_law(o: Measured) -> np.ndarray:
    """Covariance of how a nuisance does so in each row (n, n), in shares squared."""
    linear = smooth_features([o], 0)[0][0][:, 1:]
    return np.asarray(linear @ linear.T)


def law_shares(o: Measured, sd: np.ndarray) -> np.ndarray:
    """Standard deviation by which each nuisance does so (nz,)."""
    near = np.array([nuisance.near for nuisance in o.nuisances[:-1]])
    return np.where((near < 1) & (sd == 1), ROUGH_LAW, LAW * sd)


def _fillings(o: Measured, seen: Seen) -> Iterator[np.ndarray]:
    """Effects (m, fillings) of what another filling or mounting changes."""
    labels = np.unique(o.campaign.mounting, return_inverse=True)[1]
    if labels.max() == 0:
        return
    for k, nuisance in enumerate(o.nuisances):
        if nuisance.refilled:
            yield REFILLED * per_group(seen.by[:, k], labels[o.campaign.test[o.row]])


def _oils(o: Measured, seen: Seen, names: np.ndarray) -> np.ndarray:
    """Effects (m, k) of what each oil makes of the losses beside its viscosity, the same in all campaigns."""
    same = np.array(o.campaign.oil)[o.campaign.test[o.row]][:, None] == names
    losses = seen.by[:, [k for k, nuisance in enumerate(o.nuisances) if nuisance.by_oil]]
    return np.asarray((losses[:, :, None] * same[:, None, :]).reshape(o.m, -1))


def along(o: Measured) -> np.ndarray:
    """Which entries lie along logged courses (m,)."""
    return np.asarray((o.kind >= len(o.read)) & (o.entries.sensor >= 0))


def shares(o: Measured) -> np.ndarray:
    """Share of its dwell at which each entry was read (m,)."""
    return np.asarray(o.entries.share[o.entries.at])


def smoothed(o: Measured) -> np.ndarray:
    """Scatter of the smooth curves through all samples (m, m)."""
    found, names = np.zeros((o.m, o.m)), [s.name for s in o.read]
    for course in o.campaign.series.courses if o.campaign.series else ():
        i, known = names.index(course.sensor), np.isfinite(course.values)
        own = np.flatnonzero(along(o) & (o.entries.sensor == i) & (o.row == course.row))
        if len(own):  # else it is left out
            found[np.ix_(own, own)] = ALLOWED * o.read[i].repeat_sd ** 2 * course.scatter[np.ix_(known, known)]
    return found


def model_error(o: Measured) -> np.ndarray:
    """What the model leaves of each course, smooth along it (m, m)."""
    mine, share = along(o), shares(o)
    same = (o.kind[:, None] == o.kind) & (o.row[:, None] == o.row) & np.outer(mine, mine)
    return np.asarray(same * LEFT**2 * np.exp(-0.5 * ((share[:, None] - share) / LENGTH) ** 2))


def start_error(o: Measured) -> np.ndarray:
    """Effects (m, rows) of dwells that begin at another temperature than the room's reading tells."""
    room = [s.repeat_sd for s in o.given if s.kind == "ambient"]
    fades = along(o) * np.exp(-BEGUN * shares(o)) * (room[0] if room else 0.0)
    return np.asarray(fades[:, None] * (o.row[:, None] == np.unique(o.row[along(o)])))


def fading(o: Measured, linear: np.ndarray) -> np.ndarray:
    """Features (m, k), by those of the conditions (n, c), of a remainder that fades along courses.

    First dwells and later ones are apart.
    """
    later = o.half[o.row] > 0
    left = [(1 - shares(o)) ** power * side for power in FADING for side in (later, ~later)]
    return np.concatenate([(along(o) * fades)[:, None] * linear[o.row] for fades in left], axis=1)
