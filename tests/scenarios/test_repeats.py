"""Templates and names in braces: the same rig with fewer lines."""

from __future__ import annotations

import re
import tomllib

import pytest
from bearing_rig import BEARING, WHOLE, with_bearings
from gearheat.model.errors import ScenarioError
from gearheat.scenarios.load import load
from gearheat.scenarios.repeats import expand, spell_out

BEARINGS = (
    f"[template.ball]\n{BEARING}"
    + """
[part."input_bearing_{a,b}"]
use = "ball"
bearing = "SKF 6306"

[part."middle_bearing_{a,b}"]
use = "ball"
bearing = "SKF 6308"
sources = { mu_EHL = "SKF2018, friction, mineral oil" }

[part."output_bearing_{a,b}"]
use = "ball"
bearing = "SKF 6211"

"""
)


def shorter() -> str:
    """The helical rig with one template for its six bearings, and braces in its nets."""
    text = re.sub(r"load_\w+_[ab] = .*\n", "", with_bearings(BEARINGS))
    loads = '"load_{input,middle,output}_{a,b}" = '
    loads += '["{input,middle,output}_support.load_{a,b}", "{input,middle,output}_bearing_{a,b}.load"]\n'
    for net, port in (("shafts_wall.a", "inner"), ("shafts_wall.b", "outer")):
        for shaft in ("input", "middle", "output"):
            pair = [f'"{shaft}_bearing_{end}.{port}"' for end in "ab"]
            text = re.sub(rf"{pair[0]}, {pair[1]},?", "", text)
        text = text.replace(f'"{net}",', f'"{net}", "{{input,middle,output}}_bearing_{{a,b}}.{port}",')
    return text.replace("[connect]\n", "[connect]\n" + loads)


def test_the_same_rig_with_fewer_lines(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(shorter())
    short, whole = load(path).spec, load("helical_two_stage").spec
    assert len(shorter().splitlines()) < len(WHOLE.splitlines()) - 50
    assert {p.name: (p.type, dict(p.values)) for p in short.parts} == {
        p.name: (p.type, dict(p.values)) for p in whole.parts
    }
    assert {frozenset(net) for net in short.connections} == {frozenset(net) for net in whole.connections}


def test_sources_of_a_part_add_to_those_of_its_template(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(shorter())
    sources = load(path).value_sources
    assert sources["middle_bearing_b.mu_EHL"] == "SKF2018, friction, mineral oil"
    assert sources["middle_bearing_b.K_rs"] == "SKF2018, friction"
    assert sources["input_bearing_a.mu_EHL"] == "assumed: above the oil level"


def test_the_source_of_a_part_is_that_of_its_own_values_alone(tmp_path):
    path = tmp_path / "short.toml"
    own = 'bearing = "SKF 6308"\nmu_EHL = 0.04\nmu_bl = 0.15\nsource = "drawing"'
    text = shorter().replace('bearing = "SKF 6308"', own)
    path.write_text(text.replace('sources = { mu_EHL = "SKF2018, friction, mineral oil" }\n', ""))
    sources = load(path).value_sources
    found = {key: sources[f"middle_bearing_a.{key}"] for key in ("mu_EHL", "mu_bl", "K_rs", "F_r_0")}
    assumed = "assumed: above the oil level"
    assert found == {"mu_EHL": "drawing", "mu_bl": "drawing", "K_rs": "SKF2018, friction", "F_r_0": assumed}


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("a", ["a"]),
        ("a_{x,y}", ["a_x", "a_y"]),
        ("{1..3}.b", ["1.b", "2.b", "3.b"]),
        ("{a,b}_{1..2}", ["a_1", "a_2", "b_1", "b_2"]),
        ("a{", ["a{"]),
    ],
)
def test_what_braces_stand_for(text, names):
    assert spell_out(text) == names


def test_nets_go_with_their_ports_or_join_them():
    raw = tomllib.loads(
        '[connect]\n"n_{1,2}" = ["a_{1,2}.x", "b.{p,q,r}"]\nall = ["a_{1,2}.y"]\n[losses]\nP = ["a_{1,2}.P"]'
    )
    found, problems = expand("rig.toml", raw)
    assert not problems
    assert found["connect"] == {
        "n_1": ["a_1.x", "b.p", "b.q", "b.r"],
        "n_2": ["a_2.x", "b.p", "b.q", "b.r"],
        "all": ["a_1.y", "a_2.y"],
    }
    assert found["losses"] == {"P": ["a_1.P", "a_2.P"]}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('use = "ball"', 'use = "bal"', 'there is no template "bal". Did you mean "ball"'),
        ("[template.ball]", '[template.ball]\nuse = "x"', "it uses no other"),
        ('"output_bearing_{a,b}"', '"input_bearing_{a,c}"', 'there is a part "input_bearing_a" already'),
        ("[template.ball]", "[template]\nx = 1\n[template.ball]", "is no table of tables"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, old, new, words):
    path = tmp_path / "short.toml"
    path.write_text(shorter().replace(old, new, 1))
    with pytest.raises(ScenarioError, match=re.escape(words)):
        load(path)
