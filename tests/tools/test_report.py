from __future__ import annotations

import re

import numpy as np
import pytest
from gearheat.tools.compare.errors import channels_of, compare, rivals
from gearheat.tools.compare.report import breakdown, parity, residuals, warm_up
from gearheat.tools.compare.results import error_lines

TEMPERATURES = ("T_oil_C", "T_wall_C", "T_amb_C")

DRIVES = ("n_carrier_rpm", "T_carrier_Nm")


@pytest.fixture
def curves():
    time = np.linspace(0.0, 335 * 60.0, 20)
    return {test: {"time": time, **{name: 20.0 + time / 1000 for name in TEMPERATURES}} for test in (1, 2, 3)}


def test_every_figure_is_one_svg_with_the_same_bytes_each_time(rows, curves):
    makers = {
        "parity": lambda: parity(rows, channels_of(rows)[:1]),
        "residuals": lambda: residuals(rows, channels_of(rows)[:1], {"T_oil_K": 0.3}),
        "warm_up": lambda: warm_up(curves, rows),
        "breakdown": lambda: breakdown(rows, ("P_mesh_W", "P_seal_W")),
    }
    for name, make in makers.items():
        first = make()
        assert first.count("<svg") == first.count("</svg>") == 1, name
        assert first == make(), name
        assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]*"|<rdf:RDF.*?</rdf:RDF>', "", first, flags=re.DOTALL), name


def test_noise_band_is_drawn_only_where_there_is_a_noise_floor(rows):
    assert residuals(rows, channels_of(rows)[:1], {"T_oil_K": 0.3}) != residuals(rows, channels_of(rows)[:1], {})


def test_rivals_and_noise_floor_stand_in_the_summary(rows):
    head, body = error_lines(compare(rows), rivals(rows, DRIVES))
    names = [line[0] for line in body]
    for words in ("simulation, all readings", "simulation, A-grid", "noise floor", "linear, left-out tests"):
        assert words in names
    assert all(len(line) == len(head) == 5 for line in body)
