"""Random nets of conductors against a linear solve, and the same net whatever the order of its parts."""

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.run.rows import evaluate_at
from hypothesis import given, settings, strategies as st
from small_parts import Ambient, Conductor, Heater, Thermometer


@dataclass(frozen=True)
class Net:
    """Conductors between nodes; node 0 has a given temperature, all others a given heat."""

    nodes: int
    edges: tuple[tuple[int, int, float], ...]
    heat: tuple[float, ...]
    T_room: float

    def assembly(self) -> Assembly:
        ports: list[list[str]] = [[] for _ in range(self.nodes)]
        parts = [Ambient("room", T=self.T_room)]
        ports[0].append("room.heat")
        for k, (a, b, G) in enumerate(self.edges):
            parts.append(Conductor(f"g{k}", G=G))
            ports[a].append(f"g{k}.a")
            ports[b].append(f"g{k}.b")
        for k, Q in enumerate(self.heat, start=1):
            parts += [Heater(f"q{k}", Q=Q), Thermometer(f"t{k}")]
            ports[k] += [f"q{k}.heat", f"t{k}.heat"]
        return Assembly("net", "", tuple(parts), tuple(tuple(p) for p in ports if len(p) > 1))

    def temperatures(self) -> np.ndarray:
        laplacian = np.zeros((self.nodes, self.nodes))
        for a, b, G in self.edges:
            laplacian[[a, b, a, b], [a, b, b, a]] += [G, G, -G, -G]
        right = np.array(self.heat) - laplacian[1:, 0] * self.T_room
        return np.linalg.solve(laplacian[1:, 1:], right)


@st.composite
def networks(draw: st.DrawFn) -> Net:
    nodes = draw(st.integers(2, 7))
    G = st.floats(0.1, 100.0)
    tree = [(draw(st.integers(0, k - 1)), k, draw(G)) for k in range(1, nodes)]
    pairs = st.tuples(st.integers(0, nodes - 1), st.integers(0, nodes - 1), G).filter(lambda e: e[0] != e[1])
    extra = draw(st.lists(pairs, max_size=5))
    heat = draw(st.lists(st.floats(-500.0, 500.0), min_size=nodes - 1, max_size=nodes - 1))
    return Net(nodes, (*tree, *extra), tuple(heat), draw(st.floats(250.0, 350.0)))


def outputs(flat: FlatModel) -> dict[str, float]:
    y = evaluate_at(flat, [], flat.starts("input"), flat.starts("parameter"))["y"]
    return dict(zip([q.name for q in flat.outputs], y, strict=True))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(networks())
def test_conductors_against_linear_solve(net: Net) -> None:
    found = outputs(flatten(net.assembly()))
    T = net.temperatures()
    for k, expected in enumerate(T, start=1):
        assert found[f"t{k}.T"] == pytest.approx(expected, rel=1e-9)
    every = np.append(net.T_room, T)
    for k, (a, b, G) in enumerate(net.edges):
        assert found[f"g{k}.Q_flow"] == pytest.approx(G * (every[a] - every[b]), abs=1e-7)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(networks(), st.randoms(use_true_random=False))
def test_shuffling_changes_nothing(net: Net, random) -> None:
    one = net.assembly()
    parts, connections = list(one.parts), [random.sample(c, len(c)) for c in one.connections]
    random.shuffle(parts)
    random.shuffle(connections)
    other = Assembly(one.name, one.doc, tuple(parts), tuple(tuple(c) for c in connections))
    first, second = outputs(flatten(one)), outputs(flatten(other))
    assert first.keys() == second.keys()
    for name, value in first.items():
        assert second[name] == pytest.approx(value, rel=1e-9, abs=1e-7)


def test_flattening_twice_gives_the_same_expressions() -> None:
    net = Net(3, ((0, 1, 2.0), (1, 2, 3.0), (0, 2, 4.0)), (10.0, -5.0), 300.0)
    first, second = flatten(net.assembly()), flatten(net.assembly())
    assert str(first.y) == str(second.y)
    assert first.parameters == second.parameters


def test_replacing_symbols_costs_as_much_as_the_model_is_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """A call looks at all symbols it replaces: those of all ports once for every equation would be quadratic."""
    looked_at: list[int] = []
    real = ca.substitute

    def counting(expressions: object, old: object, new: object) -> object:
        looked_at.append(ca.vertcat(*old).numel() if isinstance(old, list) else old.numel())
        return real(expressions, old, new)

    monkeypatch.setattr(ca, "substitute", counting)
    totals = []
    for nodes in (10, 100):
        looked_at.clear()
        edges = tuple((k, k + 1, 5.0) for k in range(nodes - 1))
        flatten(Net(nodes, edges, (1.0,) * (nodes - 1), 300.0).assembly())
        totals.append(sum(looked_at))
    assert 0 < totals[1] < 12 * totals[0]
