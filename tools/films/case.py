"""What a film map is of: one contact with its oil and the ranges of load, speed and temperature."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

from ...model.contact import Contact, Lubricant
from ...model.core.component import Component
from ...model.core.flat import Quantity
from ...model.errors import Problems, ScenarioError, suggestion
from ...model.laws.oil import density, kinematic_viscosity, pressure_viscosity
from ...model.parts.contacts import TellsFilmContact
from ...model.parts.lubrication import LubricantProperties
from ...model.run.steady import steady
from ...model.units import to_si
from ...scenarios.document import read_toml, sources_of
from ...scenarios.scenario import Scenario
from ...scenarios.values import oil_values
from ..solve.losses import values_of
from ..solve.sampling import Axis, axes, read
from ..solve.settings import flat_of
from ..solve.steady import conditions

#: What a map varies: unit, meaning, lowest value.
AXES = {
    "F": Quantity("F", "N", "normal force", low=0.0, low_open=True),
    "u_m": Quantity("u_m", "m/s", "mean speed of the surfaces", low=0.0, low_open=True),
    "T": Quantity("T", "K", "temperature of the oil", low=200.0, high=500.0),
}
#: Units of the values of a contact and of an oil in a case file; those that have to be there come first.
NEEDED = {"R_x": "m", "length": "m", "E_eff": "Pa"}
MAY_BE = {"F": "N", "u_m": "m/s", "R_y": "m", "edge_radius": "m", "slide_roll": "1", "sigma": "m", "mu_boundary": "1"}
OIL = {"eta_0": "Pa.s", "alpha_p": "1/Pa"}
OIL_MAY_BE = {"T": "K", "p_r": "Pa", "tau_eyring": "Pa"}
#: Ranges of load and speed of the map of a part, over the value at the operating point [1].
ABOUT = {"F": (0.05, 2.0), "u_m": (0.25, 2.0)}
#: Temperatures of the map of a part [K].
WARM = (313.15, 373.15)

#: Load [N] and mean speed [m/s] at the operating point below which there is none but what blurs its sign.
LEAST = (1.0, 1e-3)
#: Load of a line contact per length below which nothing but the drag of seals and bearings loads it [N/m].
LEAST_LINE = 1e3

#: Dynamic viscosity [Pa.s] and pressure-viscosity coefficient [1/Pa] at a temperature [K].
Oil = Callable[[float], tuple[float, float]]


@dataclass(frozen=True)
class MapCase:
    """One contact and how it is varied.

    Args:
        name: of the file or the rig
        part: of a rig, else empty
        contact: the contact at one point; load, speeds and oil are those of the map's points
        oil: viscosity and its rise with pressure, at a temperature
        slide_roll: sliding speed over mean speed [1]
        sigma: composite roughness [m]; None where it is not known
        mu_boundary: friction coefficient of touching surfaces [1]; None where it is not known
        axes: what is varied, from where to where, in SI
        fixed: what is not varied, in SI
    """

    name: str
    part: str
    contact: Contact
    oil: Oil
    slide_roll: float
    sigma: float | None
    mu_boundary: float | None
    axes: tuple[Axis, ...]
    fixed: Mapping[str, float]


def parse_ranges(vary: Sequence[str]) -> dict[str, Axis]:
    """The ranges written on the command line or in a case file.

    Raises:
        ScenarioError: all that cannot be read, or names nothing that a map varies
    """
    if not vary:
        return {}
    written = read(vary)
    wrong = Problems(
        f'--vary: a map does not vary "{w.name}".{suggestion(w.name, AXES)} It varies: {", ".join(AXES)}.'
        for w in written
        if w.name not in AXES
    )
    wrong += [f"--vary {w.name}: write LOW..HIGH for a map." for w in written if w.kind != "uniform"]
    wrong.check()
    return {axis.name: axis for axis in axes(written, AXES)}


def from_file(path: Path, vary: Sequence[str]) -> MapCase:
    """The contact of a case file: tables [contact], [oil] and [vary].

    Args:
        path: the TOML file
        vary: ranges of the command line, in the place of those of the file

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    raw, problems = read_toml(path), Problems()
    found: dict[str, dict[str, float]] = {}
    oil_name = raw.get("oil", {}).get("oil") if isinstance(raw.get("oil"), Mapping) else None
    oil_needed = {} if oil_name else OIL
    for table, needed, may_be in (("contact", NEEDED, MAY_BE), ("oil", oil_needed, OIL | OIL_MAY_BE)):
        found[table], wrong = _values(f"{path.name} [{table}]", raw.get(table), needed, may_be)
        problems += wrong
    problems += [
        f"{path.name}: unknown table [{k}].{suggestion(k, ('contact', 'oil', 'vary'))}"
        for k in raw
        if k not in ("contact", "oil", "vary")
    ]
    ranges: dict[str, Axis] = {}
    with problems:
        in_file = raw.get("vary", {})
        ranges = parse_ranges([f"{k}={v}" for k, v in in_file.items() if k != "source"]) | parse_ranges(vary)
    oil = _find_oil(str(oil_name), found["oil"], problems) if oil_name else _constant_oil(found["oil"])
    known = {"F": found["contact"].get("F"), "u_m": found["contact"].get("u_m"), "T": found["oil"].get("T")}
    if not oil_name:
        known["T"] = known["T"] or 313.15  # the oil is the same at any temperature
    problems += [
        f"{path.name} [contact]: {key} is missing ({AXES[key].doc}). Give it, or its range in [vary]."
        for key, value in known.items()
        if value is None and key not in ranges
    ]
    problems.check()
    fixed = {key: float(value) for key, value in known.items() if value is not None and key not in ranges}
    return _case((path.stem, ""), found["contact"], found["oil"], oil, ranges, fixed)


def _case(
    about: tuple[str, str],
    values: Mapping[str, float],
    liquid: Mapping[str, float],
    oil: Oil,
    ranges: Mapping[str, Axis],
    fixed: Mapping[str, float],
) -> MapCase:
    """A case of values in SI. Raises ScenarioError where they make no contact."""
    first = {key: ranges[key].first if key in ranges else fixed[key] for key in AXES}
    eta_0, alpha_p = oil(first["T"])
    usual = Lubricant(eta_0, alpha_p)
    oil_there = replace(usual, p_r=liquid.get("p_r", usual.p_r), tau_eyring=liquid.get("tau_eyring", usual.tau_eyring))
    contact = Contact(
        F=first["F"],
        R_x=values["R_x"],
        u_1=first["u_m"],
        u_2=first["u_m"],
        E_eff=values["E_eff"],
        lubricant=oil_there,
        R_y=values.get("R_y", inf),
        length=values["length"],
        edge_radius=values.get("edge_radius", 0.0),
        mu_boundary=values.get("mu_boundary", 0.0),
    )
    ordered = tuple(ranges[key] for key in AXES if key in ranges)
    if not ordered:
        raise ScenarioError(
            f'{about[0]}: nothing is varied. Give [vary] or --vary, for example --vary "u_m=0.1..5 m/s".'
        )
    slide_roll, sigma, mu_boundary = values.get("slide_roll", 0.0), values.get("sigma"), values.get("mu_boundary")
    return MapCase(*about, contact, oil, slide_roll, sigma, mu_boundary, ordered, dict(fixed))


def _values(
    where: str, table: object, needed: Mapping[str, str], may_be: Mapping[str, str]
) -> tuple[dict[str, float], Problems]:
    """The numbers of a table in SI, and all that is wrong with it."""
    if not isinstance(table, Mapping):
        return {}, Problems([f"{where}: is missing. Give a table with {', '.join(needed) or 'oil'}."])
    units = {**needed, **may_be}
    values: dict[str, float] = {}
    sourced = {k: v for k, v in table.items() if k != "oil"} | {"source": table.get("source")}
    problems = Problems(sources_of(where, sourced)[1])
    for key, raw in table.items():
        if key in ("source", "sources", "oil", "doc"):
            continue
        if key not in units:
            problems.append(f'{where}: unknown key "{key}".{suggestion(key, units)}')
            continue
        with problems:
            values[key] = to_si(raw, units[key], name=f"{where}: {key}")
    positive = [key for key in values if key not in ("slide_roll", "edge_radius", "mu_boundary", "alpha_p", "T")]
    problems += [
        f"{where}: {key} = {values[key]:g} is out of range. Give a value above 0."
        for key in positive
        if not values[key] > 0
    ]
    problems += [f"{where}: {key} is missing. Give it in {unit}." for key, unit in needed.items() if key not in table]
    return values, problems


def _constant_oil(values: Mapping[str, float]) -> Oil:
    """An oil whose viscosity is given."""
    return lambda T: (values["eta_0"], values["alpha_p"])


def _find_oil(name: str, values: Mapping[str, float], problems: Problems) -> Oil:
    """An oil of the catalogue; values beside it stand in its place."""
    with problems:
        oil = oil_of(oil_values(name))
        return lambda T: (values.get("eta_0", oil(T)[0]), values.get("alpha_p", oil(T)[1]))
    return _constant_oil(values)


def oil_of(values: Mapping[str, float]) -> Oil:
    """The oil of the values of a lubricant part, in SI."""

    def at(T: float) -> tuple[float, float]:
        nu = kinematic_viscosity(T, values["nu_40"], values["nu_100"], values.get("T_pour", 0.0))
        eta_0 = nu * density(T, values["rho_15"], values["alpha_T"])
        return float(eta_0), float(pressure_viscosity(nu, values["s_p"], values["t_p"]))

    return at


def from_rig(scenario: Scenario, part: str | None, vary: Sequence[str]) -> MapCase:
    """The contact of a part at the rig's operating point, its load and speed varied about it.

    Args:
        scenario: the rig
        part: name of the part; the only one that has a contact if None
        vary: ranges in the place of those about the operating point

    Raises:
        ScenarioError: no such part, a part without a contact, several parts, or a part without load
    """
    assembly = scenario.spec.assembly()
    told = {p.name: p for p in assembly.parts if isinstance(p, TellsFilmContact)}
    chosen = told[_choose_part(scenario, part, tuple(told))]
    flat = flat_of(scenario)
    result = steady(flat, conditions(scenario, flat))
    c = chosen.film_contact(values_of(chosen, flat, result))
    u_m = abs(c.u_1 + c.u_2) / 2
    least = max(LEAST[0], LEAST_LINE * c.length if c.R_y == inf else 0.0)
    if min(c.F / least, u_m / LEAST[1]) < 1:
        raise ScenarioError(
            f"{scenario.name}: {chosen.name} carries {c.F:g} N at {u_m:g} m/s at the operating point: a contact "
            "without load or speed has no film. Give the rig an operating point with both."
        )
    ranges = {k: Axis(k, "uniform", ABOUT[k][0] * v, ABOUT[k][1] * v) for k, v in (("F", c.F), ("u_m", u_m))}
    ranges |= {"T": Axis("T", "uniform", *WARM)} | parse_ranges(vary)
    values: dict[str, Any] = {"R_x": c.R_x, "length": c.length, "E_eff": c.E_eff, "sigma": c.sigma, "R_y": c.R_y}
    values["slide_roll"] = abs(c.u_1 - c.u_2) / u_m
    values |= {} if c.mu_boundary is None else {"mu_boundary": c.mu_boundary}
    lubricants = [p for p in assembly.parts if isinstance(p, LubricantProperties)]
    oil = oil_of(lubricant_of(assembly.connections, chosen.name, lubricants).values)
    return _case((scenario.name, chosen.name), values, {}, oil, ranges, {})


def _choose_part(scenario: Scenario, part: str | None, told: tuple[str, ...]) -> str:
    """Name of the part whose contact it is."""
    parts = [p.name for p in scenario.spec.parts]
    if part is not None and part not in parts:
        raise ScenarioError(f'{scenario.name}: there is no part "{part}".{suggestion(part, parts)}')
    if part is not None and part not in told:
        raise ScenarioError(
            f"{scenario.name}: {part} has no contact with a film. Parts with one: {', '.join(told) or 'none'}."
        )
    if part is None and len(told) != 1:
        many = f"several parts have a contact. Name one of them with --part: {', '.join(told)}."
        none = "no part has a contact with a film. Take another rig, or describe the contact in a TOML file."
        raise ScenarioError(f"{scenario.name}: {many if told else none}")
    return part or told[0]


def lubricant_of(nets: Sequence[Sequence[str]], part: str, lubricants: Sequence[Component]) -> Component:
    """The lubricant that a part is connected to, the first one where none is.

    Args:
        nets: groups of ports that meet
        part: name of the part
        lubricants: oils and greases
    """
    near = [net for net in nets if f"{part}.lubricant" in net]
    return next((p for p in lubricants for net in near if f"{p.name}.lubricant" in net), lubricants[0])
