"""An oil circuit with two sumps: what flows and the enthalpy it carries are conserved, whatever the directions."""

import math
from dataclasses import replace
from itertools import product

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import GearheatError, ScenarioError, StructureError
from gearheat.model.laws.oil_circuit import carried_enthalpy, laminar_pressure, orifice_flow, stream_conductance
from gearheat.model.machines.spec import PartSpec, assemble
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.show.heat_paths import heat_flows, heat_paths

RIG = """
kind = "network"
doc = "A gear over a sump of its own, sprayed from a tank by a pump through filter and cooler"

[drive]
motor = ["w"]

[operating_point]
motor.w = "1450 rpm"
loss.Q_flow = "2 kW"
water.T = "20 degC"
room.T = "20 degC"
source = "assumed: a test"

[part.tank]
type = "OilSump"
oil = "ISO VG 320 PAO"
V = "30 l"
source = "assumed: a test"
[part.upper]
type = "OilSump"
oil = "ISO VG 320 PAO"
V = "10 l"
runs_over = true
source = "assumed: a test"
[part.motor]
type = "ShaftEnd"
[part.pump]
type = "OilPump"
V_disp = "10 cm3"
eta_v = 0.92
eta_m = 0.85
source = "assumed: a test"
[part.filter]
type = "OilFilter"
dp_ref = "1 bar"
m_flow_ref = "0.2 kg/s"
nu_ref = "100 mm2/s"
p_bypass = "3 bar"
source = "assumed: a test"
[part.thermostat]
type = "Thermostat"
T_close = "50 degC"
T_open = "60 degC"
source = "assumed: a test"
[part.cooler]
type = "OilExchanger"
thermostat = true
G = "300 W/K"
c_p = "2042 J/(kg.K)"
source = "assumed: a test"
[part.jet_1]
type = "OilNozzle"
d = "2 mm"
C_d = 0.7
source = "assumed: a test"
[part.jet_2]
type = "OilNozzle"
d = "3 mm"
C_d = 0.7
source = "assumed: a test"
[part.spray]
type = "OilExchanger"
G = "80 W/K"
c_p = "2042 J/(kg.K)"
source = "assumed: a test"
[part.gear]
type = "HeatCapacity"
C = "5 kJ/K"
source = "assumed: a test"
[part.loss]
type = "PrescribedHeatFlow"
[part.water]
type = "PrescribedTemperature"
[part.wall]
type = "ThermalConductor"
G = "5 W/K"
source = "assumed: a test"
[part.room]
type = "Room"

[connect]
shaft = ["motor.flange", "pump.shaft"]
suction = ["tank.outlet", "pump.a"]
pressure = ["pump.b", "filter.a"]
filtered = ["filter.b", "cooler.a"]
line = ["cooler.b", "jet_1.a", "jet_2.a"]
sprayed = ["jet_1.b", "spray.a"]
over = ["spray.b", "upper.inlet"]
back = ["upper.outlet", "jet_2.b", "tank.inlet"]
lubricant = ["tank.lubricant", "pump.lubricant", "filter.lubricant", "jet_1.lubricant", "jet_2.lubricant"]
opening = ["thermostat.opening", "cooler.opening"]
heat_tank = ["tank.heat", "thermostat.sensed", "wall.a"]
heat_gear = ["gear.heat", "spray.wall", "loss.heat"]
heat_water = ["water.heat", "cooler.wall"]
floor = ["room.floor", "wall.b"]
"""
FLOWS = tuple(
    f"{port}.{k}"
    for port in (
        "tank.inlet",
        "tank.outlet",
        "upper.outlet",
        "upper.inlet",
        "jet_1.a",
        "jet_2.a",
        "jet_2.b",
        "cooler.b",
    )
    for k in ("m_flow", "H_flow")
)
C_P = 2042.0


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("rig") / "rig.toml"
    path.write_text(RIG)
    return load(path)


@pytest.fixture(scope="module")
def flat(scenario: Scenario) -> FlatModel:
    return flatten(assemble(scenario.spec), flows=FLOWS)


def test_steady_state_by_hand(scenario: Scenario, flat: FlatModel) -> None:
    """Balances of every part, each with the temperature of the oil upstream."""
    found = {name: float(values[0]) for name, values in steady(flat, scenario.operating_point).columns.items()}
    m, m_1, P, Q = (found[k] for k in ("pump.m_flow", "jet_1.m_flow", "pump.P", "cooler.Q_flow"))
    T_tank, T_upper, T_gear = (found[f"{k}.T"] for k in ("tank", "upper", "gear"))
    oil = scenario.spec.part("tank").values
    rho = oil["rho_15"] * (1 + oil["alpha_T"] * (T_tank - 288.15))
    assert m == pytest.approx(0.92 * 10e-6 * 1450 / 60 * rho, rel=1e-9)
    assert m_1 == pytest.approx(m * 4 / 13, rel=1e-9)
    lost = 1e5 * m / 0.2 * found["tank.nu"] / 1e-4  # the bypass of the filter begins to open
    pressure = (m_1 / (0.7 * math.pi * 1e-6)) ** 2 / (2 * rho) + lost / (1 + (lost / 3e5) ** 8) ** 0.125
    assert pytest.approx(pressure / 0.85 * 10e-6 * 1450 / 60, rel=1e-6) == P
    assert found["pump.dp"] == pytest.approx(pressure, rel=1e-6)
    share = (1 + math.tanh(4 * (T_tank - 323.15) / 10 - 2)) / 2
    T_pumped, C = T_tank + P / (m * C_P), math.hypot(share * m, 1e-4) * C_P  # as it is rounded at rest
    assert oil["c_p"] == C_P
    assert pytest.approx(C * (1 - math.exp(-300 / C)) * (T_pumped - 293.15), rel=1e-6) == Q
    T_line, C = T_pumped - Q / (m * C_P), m_1 * C_P
    assert found["cooler.T_b"] == pytest.approx(T_line, abs=1e-5)
    assert C * (1 - math.exp(-80 / C)) * (T_gear - T_line) == pytest.approx(2000, rel=1e-6)
    assert T_upper == pytest.approx(T_line + 2000 / C, rel=1e-6)
    assert pytest.approx(Q + 5 * (T_tank - 293.15), rel=1e-9) == 2000 + P
    assert found["tank.inlet.H_flow"] == pytest.approx(
        C * (T_upper - 273.15) + (m - m_1) * C_P * (T_line - 273.15), rel=1e-6
    )


#: Ports that meet, with three at a net.
NODES = (("cooler.b", "jet_1.a", "jet_2.a"), ("upper.outlet", "jet_2.b", "tank.inlet"))
TEMPERATURES, SPEEDS = (243.15, 293.15, 353.15, 423.15), (-300.0, -10.0, -1e-3, 0.0, 1e-6, 0.1, 30.0, 300.0)


def test_every_operating_point_conserves(flat: FlatModel) -> None:
    """Cold to hot, backwards, at rest and forwards, each sump and the gear at a temperature of its own."""
    for T_tank, T_upper, w in product(TEMPERATURES, TEMPERATURES, SPEEDS):
        given = {"motor.w": w, "water.T": 293.15, "room.T": 273.15, "loss.Q_flow": 2000.0}
        u = np.array([given.get(q.name, 0.0) for q in flat.inputs])
        found = evaluate_at(flat, np.array([T_tank, T_upper, 350.0]), u, flat.starts("parameter"))
        y = dict(zip([q.name for q in flat.outputs], found["y"].tolist(), strict=True))
        throughput = float(found["throughput"][0])
        assert all(map(math.isfinite, y.values()))
        assert np.abs(found["imbalance"]).max() <= 1e-9 * throughput, (T_tank, T_upper, w)
        for node, (key, size) in product(NODES, (("m_flow", 0.5), ("H_flow", 1e5))):
            assert abs(sum(y[f"{port}.{key}"] for port in node)) <= 1e-12 * size, (T_tank, T_upper, w)
        assert abs(y["tank.m_flow_gain"]) <= 1e-12
        assert y["pump.P"] >= 0.0
        assert y["pump.m_flow"] * w >= 0.0
        assert y["jet_2.m_flow"] == pytest.approx(2.25 * y["jet_1.m_flow"], rel=1e-6)


def test_a_warm_up_from_the_cold_ends_at_the_steady_state(scenario: Scenario, flat: FlatModel) -> None:
    """The bypass of the filter lets oil of -30 degC pass; nothing is lost on the way."""
    cold = {f"{k}.T": 243.15 for k in ("tank", "upper", "gear")}
    run = simulate(flat, join_phases([(40000.0, scenario.operating_point)]), start=cold)
    rest = steady(flat, scenario.operating_point)
    assert run.audit.residual < 1e-6
    for name in cold:
        assert run[name][-1] == pytest.approx(float(rest[name][0]), abs=0.05)


def test_the_circuit_is_one_place_among_the_paths_of_heat(scenario: Scenario) -> None:
    machine = assemble(scenario.spec)
    values = steady(flatten(machine, flows=heat_flows(machine)), scenario.operating_point).columns
    paths = heat_paths(machine, {name: float(column[0]) for name, column in values.items()})
    gives = {path.begins: path.Q_flow for path in paths if path.ends == "oil circuit"}
    takes = {path.ends: path.Q_flow for path in paths if path.begins == "oil circuit"}
    assert gives.keys() == {"gear", "pump"}
    assert takes.keys() == {"tank", "cooler"}
    assert sum(gives.values()) == pytest.approx(sum(takes.values()), rel=1e-9)


def test_a_mesh_of_lines_backwards() -> None:
    """Four lines in a ring between two tanks, with other flows in each: balances solved with numpy, both directions."""
    R = {"ab": 1.0, "ac": 2.0, "bd": 2.0, "cd": 0.5, "bc": 1.0}
    bath = dict(nu_40=1e-4, nu_100=1e-5, rho_15=860.0, alpha_T=-6e-4, s_p=7.4, t_p=0.13, X_L=0.7, V=1e-2, c_p=2000.0)
    parts = [PARTS["OilSump"]("tank", **bath), PARTS["OilSump"]("other", **bath, runs_over=True)]
    parts += [PARTS["ShaftEnd"]("motor", given=("w",)), PARTS["OilPump"]("pump", V_disp=1e-5, eta_v=1.0, eta_m=1.0)]
    for name, r in R.items():
        parts.append(PARTS["OilFilter"](name, dp_ref=r * 1e4, m_flow_ref=0.1, nu_ref=1e-4, p_bypass=1e9))
    ends = {node: [f"{name}.{'ab'[name.index(node)]}" for name in R if node in name] for node in "abcd"}
    nets = [
        ("motor.flange", "pump.shaft"),
        ("tank.outlet", "pump.a"),
        ("pump.b", *ends["a"]),
        (*ends["b"],),
        (*ends["c"],),
    ]
    nets += [(*ends["d"], "other.inlet"), ("other.outlet", "tank.inlet")]
    nets += [("tank.lubricant", "pump.lubricant", *(f"{name}.lubricant" for name in R))]
    flat = flatten(Assembly("ring", "", tuple(parts), tuple(nets)), flows=[f"{n}.a.H_flow" for n in R])
    for w in (-200.0, 200.0):
        u = np.array([w if q.name == "motor.w" else 0.0 for q in flat.inputs])
        found = evaluate_at(flat, np.array([320.0, 360.0]), u, flat.starts("parameter"))
        y = dict(zip([q.name for q in flat.outputs], found["y"].tolist(), strict=True))
        m = {name: y[f"{name}.m_flow"] for name in R}
        matrix, right = np.zeros((4, 4)), np.zeros(4)
        for name, flow in m.items():
            start, end = ("abcd".index(k) for k in (name if flow > 0 else name[::-1]))
            matrix[end, start] -= abs(flow)
            matrix[end, end] += abs(flow)
        first = 0 if w > 0 else 3
        M = abs(y["pump.m_flow"])
        matrix[first, first] += M
        right[first] = M * 2000.0 * (46.85 if w > 0 else 86.85) + (y["pump.P"] if w > 0 else 0.0)
        h = np.linalg.solve(matrix, right)
        for name, flow in m.items():
            upstream = h["abcd".index(name[0 if flow > 0 else 1])]
            assert y[f"{name}.a.H_flow"] == pytest.approx(flow * upstream, rel=1e-5)
        assert np.abs(found["imbalance"]).max() <= 1e-9 * float(found["throughput"][0] + M * h[0])


def test_oil_that_finds_no_way_back_is_refused(scenario: Scenario) -> None:
    """Two tanks in the air with a return of their own, but nothing that moves the oil through it."""
    spec = scenario.spec.with_values({"upper.runs_over": False})
    with pytest.raises(StructureError, match=r"(?s)nothing says what flows on either way.*runs_over = true"):
        spec.flat()
    spec = replace(spec, connections=tuple(tuple(p for p in net if p != "upper.outlet") for net in spec.connections))
    hose = PartSpec("hose", "OilNozzle", {"d": 5e-3, "C_d": 0.7})
    nets = (("upper.outlet", "hose.a"), ("hose.b", "tank.inlet"), ("hose.lubricant", "tank.lubricant"))
    with pytest.raises(GearheatError, match=r"its oil would change by .*runs_over = true"):
        simulate(spec.with_parts((hose,), nets).flat(), join_phases([(1.0, scenario.operating_point)]))


def test_a_circuit_without_a_sump_has_no_pressure() -> None:
    parts = (
        PARTS["OilFilter"]("filter", dp_ref=1e5, m_flow_ref=0.1, nu_ref=1e-4, p_bypass=3e5),
        PARTS["OilExchanger"]("cooler", G=1.0, c_p=2000.0),
        PARTS["PrescribedTemperature"]("water"),
        PARTS["Grease"]("oil", nu_40=1e-4, nu_100=1e-5, rho_15=860.0, alpha_T=-6e-4, s_p=7.4, t_p=0.13, X_L=0.7),
    )
    nets = (("filter.a", "cooler.b"), ("filter.b", "cooler.a"), ("oil.lubricant", "filter.lubricant"))
    nets += (("cooler.wall", "water.heat", "oil.heat"),)
    with pytest.raises(StructureError, match=r"pressure.*Connect an OilSump"):
        flatten(Assembly("loop", "", parts, nets))


@pytest.mark.parametrize(
    ("law", "odd"),
    [
        (lambda m: carried_enthalpy(m, 3e4, 3e4), True),
        (lambda m: stream_conductance(m, 2000.0, 80.0), False),
        (lambda m: laminar_pressure(m, 1e-4, 5e9, 3e5), True),
        (lambda m: orifice_flow(1e6 * m, 860.0, 2e-3, 0.6), True),
    ],
)
def test_smooth_at_rest_and_reversed(law, odd: bool) -> None:
    m = ca.SX.sym("m")
    slope = ca.Function("slope", [m], [ca.jacobian(law(m), m)])
    for flow in (0.0, 1e-9, 1e-5, 1e-3, 0.5, 50.0):
        assert math.isfinite(float(slope(flow)))
        assert law(-flow) == pytest.approx(-law(flow) if odd else law(flow), rel=1e-12, abs=1e-12)


def test_a_difference_of_temperatures_is_told_in_kelvin() -> None:
    with pytest.raises(ScenarioError, match=r"T_open - T_close is -10 K, expected at least 0\.01 K"):
        PARTS["Thermostat"]("valve", T_open=323.15, T_close=333.15)
