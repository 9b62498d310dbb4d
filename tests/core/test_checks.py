"""Laws note where they are used and whether their arguments stay in range."""

import pytest
from gearheat.model.run.rows import evaluate_at
from gearheat.model.sources import law, recording
from small_parts import brake, radiated


def test_a_model_knows_its_laws_and_their_ranges() -> None:
    flat = brake()
    assert [info.name for info in flat.laws] == ["radiated"]
    (check,) = flat.checks
    assert (check.component, check.law.name, check.argument) == ("surface", "radiated", "T")
    assert (check.low, check.high) == (250.0, 400.0)


def test_checked_arguments_are_those_of_the_net() -> None:
    """The law's T is the wall's temperature after the nets are joined."""
    flat = brake()
    x = flat.starts("state")
    x[flat.locate("wall.T")[1]] = 345.0
    checked = evaluate_at(flat, x, flat.starts("input"), flat.starts("parameter"))["checked"]
    assert checked == pytest.approx([345.0])


def test_laws_are_plain_functions_outside_a_model() -> None:
    assert radiated(300.0, 300.0, 1.0) == 0.0
    with recording() as uses:
        radiated(310.0, 300.0, 1.0)
    assert [use.law.name for use in uses] == ["radiated"]
    assert dict(uses[0].arguments) == {"T": 310.0}


def test_a_law_cannot_have_ranges_of_arguments_it_has_not() -> None:
    with pytest.raises(TypeError, match="unknown arguments"):

        @law(source="Example", where="eq. 2", ranges={"x": (0.0, 1.0)})
        def nothing(y: float) -> float:
            return y
