"""Causes of a user's file and of packages."""

import re
from importlib.metadata import EntryPoint

import pytest
from gearheat.model.errors import DataError
from gearheat.tools.diagnose.library import registry
from gearheat.tools.docs.blocks import PAGES

PAGE = (PAGES / "contributing" / "cause.md").read_text("utf-8")
EXAMPLE = re.search(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)[1]
ONE = """
from gearheat.tools.diagnose.library import Cause, Form, Size

def causes(roles, ranges, sensors):
    yield Cause("my.cause", "doc", Size("s", "1", "how much", 1.0, -1.0, 1.0), ({form},))
"""


def found(case, tmp_path, text, rig="planetary"):
    c, file = case(rig), tmp_path / "mine.py"
    file.write_text(text)
    return {x.id: x for x in registry.library(c.roles, c.ranges, c.sensors, [file])}


@pytest.mark.parametrize("rig", ["planetary", "helical_two_stage", "rv_stage"])
def test_the_example_of_the_page(case, tmp_path, rig):
    causes = found(case, tmp_path, EXAMPLE, rig)
    assert {"losses.oil_pump", "cooling.foam", "losses.churning"} <= causes.keys()


WRONG = {
    "x = 1": "there is no function causes",
    "def causes(": "fails: SyntaxError",
    "def causes(roles, ranges, sensors):\n    return [1]": "gives int. Give gearheat.tools.diagnose.library.Cause",
    "def causes(roles, ranges, sensors):\n    return [roles.nothing]": "fails: AttributeError",
    ONE.format(
        form="Form(values=lambda t, r: {'oil.VV': 1.0})"
    ): 'parameter "oil.VV" does not exist. Did you mean "oil.V"',
    ONE.format(
        form="Form(values=lambda t, r: {'oil.V': r.base['oil.V'] * (2 + t['s'])})"
    ): "instead of 0.001 at size zero",
    ONE.format(form="Form(shown=lambda t, r, true: {'T_oil': true['T_carrier']})"): 'sensor "T_carrier" does not exist',
    ONE.format(form="Form(truth=lambda t, r: {'T_amb': r.sensors['T_amb'] + t['size']})"): "my.cause: form ''",
    ONE.format(form="Form(weight=0.5, pace=lambda t, r: 1 - t['s'])"): "add up to 0.5. Make it 1",
    ONE.format(form="Form()"): "it says nothing",
    ONE.format(form="Form(pace=lambda t, r: 1.0)").replace("my.cause", "cooling.air"): "already. Give it another id",
    ONE.format(form="Form(pace=lambda t, r: 1.0)").replace(
        "-1.0, 1.0", "0.5, 1.0"
    ): "Zero, which is none, must lie between",
}


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_told(case, tmp_path, text):
    with pytest.raises(DataError) as error:
        found(case, tmp_path, text)
    assert len(error.value.problems) == 1
    assert "mine.py" in error.value.problems[0] and WRONG[text] in error.value.problems[0]


def test_files_that_are_missing_or_no_python_are_told_at_once(case, tmp_path):
    c = case("planetary")
    with pytest.raises(DataError) as error:
        registry.library(c.roles, c.ranges, c.sensors, [tmp_path / "gone.py", tmp_path / "causes.txt"])
    assert [p.split(": ")[0] for p in error.value.problems] == ["--library gone.py", "--library causes.txt"]


def test_packages_offer_causes(case, monkeypatch):
    c = case("planetary")
    points = [EntryPoint("pumps", "no_such_package:causes", registry.GROUP)]
    monkeypatch.setattr(registry, "entry_points", lambda group: points)
    with pytest.raises(DataError, match=r"package pumps \(no_such_package:causes\): cannot be loaded"):
        registry.library(c.roles, c.ranges, c.sensors)
    monkeypatch.setattr(EntryPoint, "load", lambda self: lambda roles, ranges, sensors: [])
    assert len(registry.library(c.roles, c.ranges, c.sensors)) == len(c.causes)
