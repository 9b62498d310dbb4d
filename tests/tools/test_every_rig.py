"""Every shipped rig through commands, at its own operating point: those that take long share the rigs."""

import pytest
from for_each import one_of_each
from gearheat.scenarios.load import list_rigs, load

RIGS = tuple(one_of_each(list_rigs(), lambda rig: tuple(part.type for part in load(rig).spec.parts)))


@pytest.mark.parametrize("rig", RIGS)
def test_steady_losses_and_show(gearheat, rig: str) -> None:
    found = gearheat("steady", rig, "--json", "-").json
    assert found["energy_residual"] < 1e-6
    losses = gearheat("losses", rig, "--json", "-")
    assert losses.code == 0 and losses.json["rows"], losses.err
    shown = gearheat("show", rig, "--json", "-").json
    assert shown["rig"] == rig and shown["no_steady_state"] == []
    assert gearheat("show", rig, "--errata").code == 0
