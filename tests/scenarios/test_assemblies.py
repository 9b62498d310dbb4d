"""Assemblies: parts and nets that are written once and met by a few ports."""

from __future__ import annotations

import re
import tomllib

import pytest
from bearing_rig import BEARING, with_bearings
from gearheat.model.core.connect import nets
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.spec import assemble
from gearheat.scenarios.assemblies import expand_assemblies
from gearheat.scenarios.load import load

BEARINGS = (
    f"""[assembly.bearings.part."{{a,b}}"]
bearing = "SKF 6306"
{BEARING}
"""
    + """[assembly.bearings.connect]
"{shaft,inner,outer,lubricant}" = ["a.{shaft,inner,outer,lubricant}", "b.{shaft,inner,outer,lubricant}"]

[assembly.bearings.ports]
shaft = "a.shaft"
inner = "a.inner"
outer = "a.outer"
lubricant = "a.lubricant"
load_a = "a.load"
load_b = "b.load"

[part.input_bearing]
use = "bearings"

[part.middle_bearing]
use = "bearings"
"{a,b}" = { bearing = "SKF 6308" }
a.sources = { mu_EHL = "SKF2018, friction, mineral oil" }

[part.output_bearing]
use = "bearings"
"{a,b}" = { bearing = "SKF 6211" }

"""
)


def folded() -> str:
    """The helical rig with its six bearings as three pairs."""
    text = re.sub(r'"(\w+_bearing)_a\.(shaft|inner|outer|lubricant)", "\1_b\.\2"', r'"\1.\2"', with_bearings(BEARINGS))
    return re.sub(r'"(\w+_bearing)_([ab])\.load"', r'"\1.load_\2"', text)


def test_the_same_rig_of_assemblies(tmp_path):
    path = tmp_path / "folded.toml"
    path.write_text(folded())
    short, whole = load(path), load("helical_two_stage")
    assert {p.name: (p.type, dict(p.values)) for p in short.spec.parts} == {
        p.name: (p.type, dict(p.values)) for p in whole.spec.parts
    }
    met = [{frozenset(port.name for port in net) for net in nets(assemble(s.spec))} for s in (short, whole)]
    assert met[0] == met[1]
    assert short.value_sources["middle_bearing_a.mu_EHL"] == "SKF2018, friction, mineral oil"
    assert short.value_sources["middle_bearing_a.K_rs"] == "SKF2018, friction"


def test_assemblies_hold_assemblies():
    raw = tomllib.loads("""
        [assembly.one.part.x]
        type = "T"
        [assembly.one.ports]
        p = "x.p"
        [assembly.two.part."n_{1,2}"]
        use = "one"
        [assembly.two.connect]
        between = ["n_1.p", "n_2.q"]
        [assembly.two.ports]
        out = "n_2.p"
        [part.big]
        use = "two"
        n_2.x.k = 3
        [connect]
        end = ["big.out", "y.p"]
    """)
    found, problems = expand_assemblies("rig.toml", raw)
    assert not problems
    assert found["part"] == {"big_n_1_x": {"type": "T"}, "big_n_2_x": {"type": "T", "k": 3}}
    assert found["connect"] == {"big_between": ["big_n_1_x.p", "big_n_2.q"], "end": ["big_n_2_x.p", "y.p"]}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('use = "bearings"', 'use = "bearing"', 'there is no template "bearing"'),
        ("a.sources", "c.sources", 'the assembly has no part "c". Its parts: a, b.'),
        ('a.sources = { mu_EHL = "SKF2018, friction, mineral oil" }', 'a = "SKF 6308"', "a is no table"),
        ("[assembly.bearings.ports]", "[assembly.bearings.ports]\nx = 1", "ports"),
        (
            "[assembly.bearings.ports]",
            "[assembly.bearings.part.c]\nuse = 'bearings'\n[assembly.bearings.ports]",
            "holds itself",
        ),
    ],
)
def test_what_is_wrong_is_said(tmp_path, old, new, words):
    path = tmp_path / "folded.toml"
    path.write_text(folded().replace(old, new, 1))
    with pytest.raises(ScenarioError, match=re.escape(words)):
        load(path)
