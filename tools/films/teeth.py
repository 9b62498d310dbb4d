"""What the teeth of a rig feel at its operating point: temperatures, films and safeties of every mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from ...model.core.component import Component, Equation, equation
from ...model.core.declare import Output
from ...model.errors import Problems, ScenarioError
from ...model.laws.oil import T_0
from ...model.machines.spec import PartSpec, Spec
from ...model.parts.flanks import Flanks, flanks_of
from ...model.parts.gears import GearPair
from ...model.parts.lubrication import LubricantProperties
from ...model.parts.planetary import PlanetarySet
from ...model.parts.ports import Flange, HeatPort, Lubricant
from ...model.run.steady import steady
from ...scenarios.given import RigLike, Settings, scenario_of
from ...scenarios.scenario import Scenario
from ..show.display import Answer, Table
from ..show.picture import Picture
from ..solve.losses import values_of
from ..solve.settings import adjust, find_unchecked, flat_of
from ..solve.steady import conditions
from .case import LEAST, LEAST_LINE, lubricant_of, oil_of
from .flank_methods import MicropittingTest, Point, Rating, rate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: First and last load stage of the scuffing test.
SCUFFING_STAGES = (1, 14)
#: Columns of the table: the network, and the standards each by its own friction and temperature of the teeth.
HEAD = ("", "network", "flash", "integral", "micropitting")
#: Rows of the table: key and meaning.
ROWS = {
    "T_bulk_C": "teeth [degC]",
    "mu": "friction",
    "flash_K": "largest flash [K]",
    "T_contact_C": "hottest contact [degC]",
    "T_integral_C": "integral temperature [degC]",
    "lambda_GF": "thinnest film over roughness",
    "S_flash": "safety, flash temperature",
    "S_integral": "safety, integral temperature",
    "S_micropitting": "safety, micropitting",
}
#: What the figures rest on.
ASSUMPTIONS = (
    "case-hardened steel of one kind, ground teeth without tip relief, dip lubrication",
    "either gear may drive: the less favourable direction counts",
)


@dataclass(frozen=True, eq=False, repr=False)
class TeethFelt(Answer):
    """What the teeth of a rig feel.

    Attributes:
        paths: mesh -> points along its path of contact
    """

    paths: Mapping[str, list[Point]]

    def tables(self) -> dict[str, Table]:
        """Head and rows of the table of each mesh."""
        return {mesh["mesh"]: (HEAD, _rows_of(mesh)) for mesh in self.found["meshes"]}

    def drawing(self) -> Picture:
        """Temperature of the contact and film over roughness along the path of contact of each mesh."""
        from ..show.drawing import COLOURS, empty, legend

        figure, panels = empty(8.0, 3.2 * len(self.paths) + 0.5, len(self.paths), 1)
        for panel, mesh in zip(panels, self.found["meshes"], strict=True):
            self._draw(panel, mesh, COLOURS)
        legend(figure, panels[0])
        return Picture(figure, self.title, "Distances are from the pitch point, towards the tip of the first gear.")

    def _draw(self, panel: Axes, mesh: Mapping[str, Any], colours: tuple[str, ...]) -> None:
        points, columns = self.paths[mesh["mesh"]], mesh["columns"]
        x = [1e3 * point.y for point in points]
        film = panel.twinx()
        panel.plot(x, [point.T - T_0 for point in points], color=colours[1], label="contact [degC]")
        panel.axhline(columns["network"]["T_bulk_C"], color=colours[1], ls=":", label="teeth [degC]")
        film.plot(x, [point.Lambda for point in points], color=colours[0])
        film.axhline(columns["limit"]["lambda_GF"], color=colours[0], ls=":")
        for label, style in (("film over roughness (right)", "-"), ("permissible (right)", ":")):
            panel.plot([], [], color=colours[0], ls=style, label=label)
        film.set(ylim=(0, None), ylabel="film over roughness")
        film.grid(visible=False)
        panel.set(title=mesh["mesh"], xlabel="along the path of contact [mm]", ylabel="temperature [degC]")


def teeth(
    rig: RigLike,
    set: Settings = (),
    *,
    load_factor: float = 1.0,
    scuffing_stage: int = 12,
    micropitting_stage: int = 10,
) -> TeethFelt:
    """Temperatures, films and safeties against scuffing and micropitting of every mesh of a rig.

    Args:
        rig: name, file or rig
        set: values by name: texts with units, quantities of pint, or numbers in SI
        load_factor: on the load of the flanks, K_A K_V K_Hb K_Ha of ISO 6336-1
        scuffing_stage: failure load stage of the oil in the FZG test A/8,3/90; DIN 51517-3 asks CLP oils for 12
        micropitting_stage: failure load stage of the oil in the micropitting test C-GF/8,3/90, 5 to 10

    Raises:
        GearheatError: all that is wrong with what is asked, such as a mesh without load

    Example:
        >>> import gearheat as gh
        >>> felt = gh.teeth("helical_two_stage")
        >>> [mesh["mesh"] for mesh in felt.found["meshes"]]
        ['stage_1', 'stage_2']
    """
    _check_options(load_factor, scuffing_stage, micropitting_stage)
    scenario = adjust(scenario_of(rig), set)
    meshes, paths = [], {}
    for flanks, T_bulk, oil in _meshes(scenario, load_factor, scuffing_stage, micropitting_stage):
        points, columns = rate(flanks, T_bulk, oil)
        paths[flanks.name] = points
        path = [asdict(point) for point in points]
        meshes.append({"mesh": flanks.name, "T_oil_C": oil.T_oil - T_0, "columns": columns, "path": path})
    found = {
        "schema": "gearheat.teeth/1",
        "rig": scenario.name,
        "plot": None,
        "load_factor": load_factor,
        "scuffing_stage": scuffing_stage,
        "micropitting_stage": micropitting_stage,
        "meshes": meshes,
        "assumptions": [
            *ASSUMPTIONS,
            f"oil that fails at stage {scuffing_stage} of the scuffing test A/8,3/90 and at stage {micropitting_stage} "
            "of the micropitting test C-GF/8,3/90",
        ],
        "unchecked": find_unchecked(scenario, flat_of(scenario)),
    }
    rows = [(f"{mesh['mesh']}: {row[0]}", *row[1:]) for mesh in meshes for row in _rows_of(mesh)]
    return TeethFelt(found, paths, heading=f"{scenario.name}: teeth", shown=(HEAD, rows))


def _rows_of(mesh: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """Rows of a table under `HEAD`, of an entry of `meshes`."""
    columns = [mesh["columns"].get(name, {}) for name in HEAD[1:]]
    return [(doc, *(column.get(key) for column in columns)) for key, doc in ROWS.items()]


#: Largest factor on the load of flanks.
MOST_FACTOR = 100.0


def _check_options(load_factor: float, scuffing_stage: int, micropitting_stage: int) -> None:
    """Raises ScenarioError for options out of their range."""
    test, problems = MicropittingTest(), Problems()
    if load_factor > MOST_FACTOR:
        problems.append(f"--load-factor {load_factor:g}: give a factor of at most {MOST_FACTOR:g}, 1.25 for example.")
    if not load_factor > 0:
        problems.append(f"--load-factor {load_factor:g}: give a factor above 0, 1.25 for example.")
    for option, stage, first, last in (
        ("--scuffing-stage", scuffing_stage, *SCUFFING_STAGES),
        ("--micropitting-stage", micropitting_stage, test.first, test.first + len(test.tau) - 1),
    ):
        if not first <= stage <= last:
            problems.append(f"{option} {stage}: the test has load stages. Give one from {first} to {last}.")
    problems.check()


def _meshes(scenario: Scenario, K: float, scuffing: int, micropitting: int) -> Iterator[tuple[Flanks, float, Rating]]:
    """Each mesh at the operating point with the temperature of its gears [K] and its oil.

    Raises:
        ScenarioError: there is none, or one carries nothing or stands still
    """
    parts = {part.name: part for part in scenario.spec.assembly().parts}
    toothed = [part for part in parts.values() if isinstance(part, GearPair | PlanetarySet)]
    if not toothed:
        raise ScenarioError(f"{scenario.name}: no part has involute teeth. Take a rig with a gear pair or planets.")
    probed = replace(scenario, spec=_with_readings(scenario.spec, toothed))
    flat = flat_of(probed)
    result, problems, found = steady(flat, conditions(probed, flat)), Problems(), []
    lubricants = [part for part in parts.values() if isinstance(part, LubricantProperties)]
    for part in toothed:
        read = {port: float(result[f"{_reading(part, port)}.{kind.key}"][0]) for port, kind in _readings(part)}
        values = values_of(part, flat, result) | {f"{port}.w": value for port, value in read.items()}
        T_bulk, T_oil = read["gears"], read["lubricant"]
        lubricant = lubricant_of(scenario.spec.connections, part.name, lubricants).values
        oil = Rating(K, scuffing, micropitting, oil_of(lubricant), T_oil, lubricant["X_L"], lubricant["nu_40"])
        for flanks in flanks_of(part, values):
            found.append((flanks, T_bulk, oil))
            line_load, u_m = flanks.F_bt / flanks.b, flanks.w * flanks.rho_C
            if line_load < LEAST_LINE or u_m < LEAST[1]:
                problems.append(
                    f"{scenario.name}: {flanks.name} carries {1e-3 * line_load:.3g} N/mm at {u_m:.3g} m/s at the "
                    "operating point: teeth without load or speed have no film, friction or safety. Set both."
                )
    problems.check()
    yield from found


class Reading(Component):
    """Reads a potential at its port, and takes nothing."""

    key: ClassVar[str] = "T"


class HeatReading(Reading):
    """Temperature of a body."""

    port = HeatPort()
    T = Output("K", "temperature", nominal=350.0)

    def equations(self) -> Iterator[Equation]:
        """It takes no heat."""
        yield equation("temperature read", self.T, self.port.T)
        yield equation("no heat", self.port.Q_flow, 0.0)


class OilReading(Reading):
    """Temperature of a lubricant."""

    port = Lubricant()
    T = Output("K", "temperature", nominal=350.0)

    def equations(self) -> Iterator[Equation]:
        """Where it is used."""
        yield equation("temperature read", self.T, self.port.T)


class SpeedReading(Reading):
    """Speed of a shaft."""

    key = "w"
    port = Flange()
    w = Output("rad/s", "angular velocity", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """It takes no torque."""
        yield equation("speed read", self.w, self.port.w)
        yield equation("no torque", self.port.tau, 0.0)


#: Port of a part with teeth -> the part that reads it; a gear pair has no sun and no carrier.
READINGS: Mapping[str, type[Reading]] = {
    "gears": HeatReading,
    "lubricant": OilReading,
    "sun": SpeedReading,
    "carrier": SpeedReading,
}


def _readings(part: Component) -> list[tuple[str, type[Reading]]]:
    """The ports that are read of a part with teeth."""
    return [(port, kind) for port, kind in READINGS.items() if port in part.ports]


def _with_readings(spec: Spec, parts: Sequence[Component]) -> Spec:
    """The spec with a reading of each of `READINGS` at some parts with teeth."""
    wanted = [(part, port, kind.__name__) for part in parts for port, kind in _readings(part)]
    probes = [PartSpec(_reading(part, port), kind) for part, port, kind in wanted]
    nets = [(f"{_reading(part, port)}.port", f"{part.name}.{port}") for part, port, _ in wanted]
    return spec.with_parts(probes, nets, {kind.__name__: kind for kind in READINGS.values()})


def _reading(part: Component, port: str) -> str:
    """Name of the reading at a port of a part."""
    return f"reading_{part.name}_{port}"
