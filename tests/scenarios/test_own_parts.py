"""Part types of one's own in a rig file."""

from __future__ import annotations

import re
from importlib.metadata import EntryPoint

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.run.steady import steady
from gearheat.scenarios import own_types as loading
from gearheat.scenarios.load import RIGS, load

WHOLE = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")

MODULE = '''
from gearheat.model.core.declare import Parameter
from gearheat.model.parts.thermal import Conductor


class Strap(Conductor):
    """A conductor, twice as good as it says."""

    G = Parameter("W/K", "thermal conductance", at_least=0.0)

    def conductance(self):
        return 2 * self.G


class Room(Strap):
    """Has the name of a part type."""


NUMBER = 3
'''

#: Modules that do something when they are imported.
CODE = ("ziglang.__main__", "venv.__main__", "unittest.__main__", "antigravity", "this", "makers", "os", "numpy")


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """A rig file whose foot has another type, beside a folder with a module on the path."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "makers_parts.py").write_text(MODULE, encoding="utf-8")
    (tmp_path / "lib" / "makers_slip.py").write_text("1 / 0", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path / "lib"))
    monkeypatch.setattr(loading, "_NAMED", {"makers_parts", "makers_slip", "makers_exit", "no_such", "beside_the_rig"})
    (tmp_path / "lib" / "makers_exit.py").write_text("import sys\nsys.exit(0)", encoding="utf-8")
    (tmp_path / "beside_the_rig.py").write_text(MODULE, encoding="utf-8")

    def written(kind: str, conductance: str = "3 W/K"):
        path = tmp_path / "own.toml"
        foot = f'[part.foot]\ntype = "{kind}"\nG = "{conductance}"'
        path.write_text(WHOLE.replace('[part.foot]\ntype = "ThermalConductor"\nG = "3 W/K"', foot), encoding="utf-8")
        return path

    return written


def warm(scenario) -> float:
    """The steady oil temperature at the operating point [K]."""
    flat = scenario.spec.flat()
    return float(steady(flat, scenario.operating_point)["oil.T"][0])


def test_a_part_of_ones_own_acts(rig):
    own = load(rig("makers_parts:Strap", "1.5 W/K"))
    assert own.spec.types["Strap"].__doc__ == "A conductor, twice as good as it says."
    temperatures = [warm(s) for s in (own, load("helical_two_stage"))]
    assert temperatures[0] == pytest.approx(temperatures[1], rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("makers_parts:Strop", 'makers_parts has no part "Strop". Did you mean "Strap"'),
        ("makers_parts:NUMBER", "has no part"),
        ("makers_parts:", "has no part"),
        ("makers_parts:Room", 'there is a part type "Room" already'),
        ("makers_slip:Strap", "makers_slip fails: ZeroDivisionError"),
        ("makers_exit:Strap", "makers_exit fails: SystemExit"),
        ("no_such:Strap", "No module named 'no_such'. Install the package"),
        ("beside_the_rig:Strap", "No module named 'beside_the_rig'"),
        *((f"{module}:X", f"If you trust {module}, add --parts {module}") for module in CODE),
        (":Strap", "Give module:Class"),
        (".x:Strap", "Give module:Class"),
    ],
)
def test_what_is_wrong_is_said_once(rig, kind, words):
    with pytest.raises(ScenarioError, match=re.escape(words)) as error:
        load(rig(kind))
    assert sum(kind in problem for problem in error.value.problems) == 1


def test_parts_of_installed_packages_are_known_by_name(monkeypatch, tmp_path):
    module = tmp_path / "shop_parts.py"
    module.write_text(
        'from gearheat.model.parts import PARTS\n\n\nclass Stone(PARTS[\'HeatCapacity\']):\n    """A body."""\n',
        encoding="utf-8",
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    offered = [EntryPoint("Stone", "shop_parts:Stone", loading.GROUP)]
    monkeypatch.setattr(loading, "entry_points", lambda group: offered)
    loading.load_installed_types.cache_clear()
    try:
        assert loading.load_installed_types()["Stone"].__name__ == "Stone"
        loading.load_installed_types.cache_clear()
        offered.append(EntryPoint("Rock", "shop_parts:Rock", loading.GROUP))
        with pytest.raises(ScenarioError, match=r'package Rock: .*has no part "Rock"'):
            load("planetary")
    finally:
        loading.load_installed_types.cache_clear()
