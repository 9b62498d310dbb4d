"""The line load of the tooth friction is a choice that a rig states: no default, and a factor of its own for each."""

from typing import Any

import casadi as ca
import pytest
from gearheat.model.parts import PARTS
from gearheat.model.parts.teeth import ToothedPart
from gearheat.scenarios.load import list_rigs, load

#: Values of what the friction of a part depends on beside its parameters: lubricant, force and speed.
LUBRICANT = {"nu": 6e-5, "rho": 850.0, "X_L": 0.7, "alpha_p": 1.5e-8, "beta_T": 0.03, "k": 0.13}


def toothed(rig: str) -> list[Any]:
    return [part for part in load(rig).spec.parts if issubclass(PARTS[part.type], ToothedPart)]


def friction(part: Any, line_load: str, eps_alpha: float) -> list[float]:
    """Friction coefficient and film parameter of an external mesh of the part at 5 kN and 80 rad/s."""
    built = PARTS[part.type]("part", **{**part.values, "line_load": line_load})
    contact = built.contact(eps_alpha, built.z_1, built.z_2)
    expression = ca.vertcat(*built.friction(contact, 5e3, 80.0))
    symbols = ca.symvar(expression)
    values = {**built.values, **{f"lubricant.{name}": value for name, value in LUBRICANT.items()}}
    given = [values[symbol.name().removeprefix("part.")] for symbol in symbols]
    return list(ca.Function("friction", symbols, [expression])(*given).full().ravel())


@pytest.mark.parametrize("rig", list_rigs())
def test_every_rig_states_its_line_load_and_what_its_factor_belongs_to(rig: str) -> None:
    sources = load(rig).value_sources
    for part in toothed(rig):
        assert part.values["line_load"] in ("F_bt/b", "F_bn/l")
        assert "line_load" in sources[f"{part.name}.k_mu"]
        assert sources[f"{part.name}.line_load"]


@pytest.mark.parametrize("rig", ["planetary", "helical_two_stage"])
def test_published_numbers_are_those_of_the_load_per_contact_length(rig: str) -> None:
    assert {part.values["line_load"] for part in toothed(rig)} == {"F_bn/l"}


@pytest.mark.parametrize("rig", list_rigs())
@pytest.mark.parametrize("eps_alpha", [1.3, 1.666, 1.883])
def test_load_per_face_width_is_the_contact_ratio_times_that_per_contact_length(rig: str, eps_alpha: float) -> None:
    """F_bt/b = eps_alpha F_bn/l, to the power 0.2 in the friction; the film carries the load of its contact lines."""
    for part in toothed(rig):
        (mu_width, film_width), (mu_length, film_length) = (
            friction(part, line_load, eps_alpha) for line_load in ("F_bt/b", "F_bn/l")
        )
        assert mu_width / mu_length == pytest.approx(eps_alpha**0.2, rel=1e-6)
        assert film_width == film_length
