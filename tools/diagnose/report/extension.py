"""The extended model as a rig file: the rig as the data calibrate it, with what the causes change and add.

Faults of instruments and of the procedure, and what differs from test to test, are no matter of the machine: they stand
in comments above it. How uncertain the data leave its values stands in tables of values that are uncertain together.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ....model.machines.roles import takes_power
from ....model.machines.spec import PartSpec
from ....model.parts.free_form import EXTRA_PARTS
from ....model.units import from_si
from ....scenarios.nuisances import Nuisance
from ....scenarios.scenario import Scenario
from ....scenarios.write import DIAGNOSED, rig_text
from ..answer.estimate import posterior
from ..answer.findings import Calibrated
from ..infer.fit import Vector
from ..infer.found import Found, Hypothesis
from ..library.cause import Form, Row, Theta
from ..library.check import parameters
from ..model.formula import FEATURES
from ..setting import Setting
from . import phrases
from .phrases import name_of

#: Names of the parts that causes add.
ADDED = "extra_"
#: Here and in the extended rig: a found part can stand beside that of a new search.
FOUND = "found_"
#: How a line above a rig file ends that tells a value which is cut.
CUT = "no more than this is possible."
#: Part of a standard deviation that its derivative is taken over.
STEP = 0.05
#: Share of a value below which a change is left out.
LITTLE = 1e-5


@dataclass(frozen=True)
class Applied:
    """A cause in the form and with the size and shapes that were found."""

    id: str
    doc: str
    form: Form
    theta: Theta

    @property
    def told(self) -> str:
        """Cause, form and parameters."""
        form = f" ({self.form.name})" if self.form.name else ""
        return ", ".join([f"{self.id}{form}", *(f"{k} = {phrases.number(float(v), 4)}" for k, v in self.theta.items())])


@dataclass(frozen=True)
class Extended:
    """A rig as the data calibrate it, with causes: what it is, and the words above its file."""

    scenario: Scenario
    head: tuple[str, ...]

    @property
    def cut(self) -> tuple[str, ...]:
        """Its values that would be beyond what is possible."""
        return tuple(line for line in self.head if line.endswith(CUT))

    @property
    def values(self) -> dict[str, float]:
        """Numbers of its parts by path."""
        known = self.scenario.settable()
        own = ((f"{p.name}.{key}", value) for p in self.scenario.spec.parts for key, value in p.values.items())
        return {path: float(value) for path, value in own if path in known}

    def text(self, uncertain: Mapping[str, Mapping[str, float]]) -> str:
        """The text of a rig file, with reason -> path -> what its value changes by at one standard deviation."""
        told = replace(self.scenario, joint_uncertainties=uncertain)
        return "\n".join(f"# {line}" for line in self.head) + "\n" + rig_text(told)


def directions(
    values: Callable[[np.ndarray], Mapping[str, float]], x: np.ndarray, covariance: np.ndarray
) -> dict[str, dict[str, float]]:
    """How values are uncertain together, to first order: independent directions, the largest relative one first.

    Args:
        values: of a rig by path, as they follow from fitted parameters (d,)
        x: the parameters as found (d,)
        covariance: theirs (d, d)

    Returns:
        name of a direction -> path -> change at one standard deviation [SI]
    """
    at, rows = values(x), []
    for k, step in enumerate(STEP * np.sqrt(np.diag(covariance))):
        # what does nothing at an end is left out there
        ends = [{**at, **values(x + sign * step * np.eye(len(x))[k])} for sign in (-1.0, 1.0)]
        rows.append([(ends[1][path] - ends[0][path]) / (2 * step) for path in at])
    scale = np.array([abs(value) or 1.0 for value in at.values()])
    slopes = np.array(rows).T / scale[:, None]  # (values, d)
    turned, sizes, _ = np.linalg.svd(slopes @ np.linalg.cholesky(covariance), full_matrices=False)
    found = {}
    signs = np.sign(turned[np.abs(turned).argmax(axis=0), range(len(sizes))])  # either would do
    for n, change in enumerate((signs * sizes * turned).T, start=1):
        pairs = zip(at, change, change * scale, strict=True)
        if moved := {path: float(f"{size:.6g}") for path, share, size in pairs if abs(share) > LITTLE}:
            found[f"posterior_{n}"] = moved
    return found


def extended(
    scenario: Scenario,
    calibrated: Mapping[str, float],
    applied: Sequence[Applied],
    data: str,
    oils: int = 1,
    also: Sequence[Applied] = (),
) -> Extended:
    """The rig with what the data say of it.

    Args:
        scenario: the rig
        calibrated: path -> value as the data calibrate it, with the causes [SI]
        applied: the causes
        data: name of the data
        oils: how many oils the tests ran with
        also: what calibration adds to the rig
    """
    rig, notes = _with_values(scenario, calibrated, f"calibrated: diagnosis of {data}")
    for one in (*also, *applied):
        rig, left = _added(rig, one, data, oils)
        notes += left
    causes = " and ".join(f"{name_of(a.id)} ({a.id})" for a in applied) or "calibrated, no cause added"
    doc = f"{rig.doc.rstrip('.')}; as diagnosed from {data}: {causes}."
    head = [f"Written by `gearheat diagnose` from {data}: {causes}.", *notes]
    clean = replace(rig, doc=doc, spec=replace(rig.spec, doc=doc), entries={})
    return Extended(clean, tuple(head))


def _with_values(scenario: Scenario, values: Mapping[str, float], source: str) -> tuple[Scenario, list[str]]:
    """The scenario with values that it has, none beyond what is possible, and what was cut."""
    known = scenario.settable()
    wanted = {path: float(value) for path, value in values.items() if path in known}
    cut = {path: float(np.clip(value, known[path].low, known[path].high)) for path, value in wanted.items()}
    notes = [f"{p} would be {phrases.number(v, 4)}; {CUT}" for p, v in wanted.items() if v != cut[p]]
    return scenario.with_values(cut, source), notes


def _added(scenario: Scenario, one: Applied, data: str, oils: int) -> tuple[Scenario, list[str]]:
    """The scenario with a cause, and what of it the machine cannot hold."""
    form, outside = one.form, f"Not a matter of the machine, hence not below: {one.told}."
    with_parts = scenario.spec.with_parts(form.parts, form.connections, EXTRA_PARTS)
    changed = _changed(form, one.theta, parameters(with_parts))
    if not changed:
        by_test = form.values is not None or form.spread
        return scenario, [f"{outside} {'It differs from test to test.' if by_test else one.doc}"]
    names = _names(form.parts, {p.name for p in scenario.spec.parts})
    parts = [replace(p, name=names[p.name]) for p in form.parts]
    nets = [tuple(_renamed(port, names) for port in net) for net in form.connections]
    neutral = {f"{p.name}.{key}": value for p in form.parts for key, value in p.values.items()}
    values = {_renamed(path, names): value for path, value in (neutral | changed).items()}
    lossy = [p.name for p in parts if takes_power(with_parts.types[p.type])]
    losses = {**scenario.losses, **{f"P_{name}_W": (f"{name}.P",) for name in lossy}}
    oil = {path.rpartition(".")[0] for path in changed} & {n for n, own in scenario.entries.items() if "oil" in own}
    notes = [f"{one.told}: the values below are of the rig's own oil; others change alike."] if oil and oils > 1 else []
    source = f"inferred: for the rig's own oil, diagnosis of {data}" if notes else f"{DIAGNOSED} {data}, {one.id}"
    if form.shown is not None or form.truth is not None or form.pace is not None:
        notes.append(f"{outside} Its part in the machine is below.")
    spec = scenario.spec.with_parts(parts, nets, EXTRA_PARTS)
    changed_rig, cut = _with_values(replace(scenario, spec=spec, losses=losses), values, source)
    return changed_rig, notes + cut


def _changed(form: Form, theta: Theta, base: Mapping[str, float]) -> dict[str, float] | None:
    """Values that a form changes in every test alike; None where it depends on the test or changes none."""
    if form.values is None or form.spread:
        return None
    features = ca.vertsplit(ca.SX.sym("feature", len(FEATURES)))
    found = form.values(theta, Row(base, defaultdict(lambda: ca.SX.sym("reading")), *features))
    alike = not ca.symvar(ca.SX(ca.vertcat(*found.values())))
    return {path: float(value) for path, value in found.items()} if alike else None


def _names(parts: Sequence[PartSpec], taken: set[str]) -> dict[str, str]:
    """Names for found parts that no part of the rig has."""
    names: dict[str, str] = {}
    for part in parts:
        wanted, held = FOUND + part.name.removeprefix(ADDED), taken | set(names.values())
        numbered = (wanted, *(f"{wanted}_{n}" for n in range(2, len(held) + 3)))
        names[part.name] = next(name for name in numbered if name not in held)
    return names


def _renamed(path: str, names: Mapping[str, str]) -> str:
    """A port or a value of a part under the part's new name."""
    part, _, rest = path.partition(".")
    return f"{names.get(part, part)}.{rest}"


def values(found: Found, z: np.ndarray) -> dict[str, float]:
    """Values of the rig by path as nuisances (n,) calibrate them [SI], those of added parts among them."""
    plant, told = found.problem.data.plant, dict[str, float]()
    for nuisance, change in zip(found.problem.data.nuisances, z, strict=False):
        for path, exponent in nuisance.paths.items():
            before = told.get(path, float(plant.p[plant.place[path]]))
            told[path] = before * float(np.exp(exponent * nuisance.sd * change))
    return told


def calibrated(setting: Setting, found: Found, h: Hypothesis) -> tuple[Calibrated, ...]:
    """Values that the data moved, in the units of the rig file."""
    known, z, told = setting.scenario.settable(), found.null.look.z, []
    states = [values(found, each) for each in (0 * z, z, h.fit.look.z)]
    for path in states[0]:
        if path in known:
            unit = known[path].unit
            file, nominal, extended = (from_si(state[path], unit) for state in states)
            causes = extended if h.causes else None
            told.append(Calibrated(path=path, unit=unit, file=file, nominal=nominal, extended=causes))
    return tuple(told)


def rig_file(setting: Setting, found: Found, h: Hypothesis) -> tuple[str, tuple[str, ...]]:
    """The text of the rig file, calibrated, with the causes of a hypothesis, how uncertain both are; what is cut."""
    data, scenario = found.problem.data.campaign, replace(setting.scenario, spec=setting.spec)
    oils = dict.fromkeys(data.oil)
    if len(oils) == 1 and (own := found.problem.data.oils.get(next(iter(oils)))):
        known = scenario.settable()
        filled = {path: value for path, value in own.items() if path in known}
        scenario = scenario.with_values(filled, f"inferred: the oil of {data.name}")

    spreads = [f for e in h.extras if (f := e.of.formula)]
    scattered = [Applied(f.cause.id, f.cause.doc, Form(f.form.name, spread=f.form.spread), {}) for f in spreads]

    def at(x: np.ndarray) -> Extended:
        z, acting = Vector(found.problem, h.fit.look).split(x)
        told = values(found, z)
        added = [calibration(n, told) for n in found.problem.data.nuisances if n.parts]
        causes = [Applied(a.id, a.formula.cause.doc, a.formula.form, a.formula.theta(a.t)) for a in acting]
        return extended(scenario, told, [*causes, *scattered], data.name, len(oils), added)

    x = h.fit.look.x
    uncertain = directions(lambda near: at(near).values, x, posterior(found.problem, h.fit))
    rig = at(x)
    return rig.text(uncertain), rig.cut


def calibration(nuisance: Nuisance, told: Mapping[str, float]) -> Applied:
    """What calibration adds to a rig, as if it were a cause."""
    own = {path: told[path] for path in nuisance.paths}
    form = Form(parts=nuisance.parts, connections=nuisance.connections, values=lambda theta, row: own)
    return Applied(f"calibration of {nuisance.name}", "Calibration adds it.", form, {})
