"""A contact outside the regime of its film law is named with the one it is in, by every command that runs a rig."""

import json

import pytest


def test_commands_name_the_regime(gearheat) -> None:
    for command in (["steady"], ["losses"], ["show"]):
        (found,) = [o for o in gearheat(*command, "harmonic_printed", "--json", "-").json["outside"] if o["regime"]]
        assert found["part"] == "mesh" and "rigid-isoviscous" in found["regime"], command
    freed = ["--free", "wave_generator.w", "--target", "mesh.h_min=0.88 um", "--set", "mesh.F_0=120 N"]
    answer = json.loads(gearheat("design", "harmonic_printed", *freed, "--json", "-").out)
    assert any("rigid-isoviscous" in o["regime"] for o in answer["outside"])
    assert answer["free"]["wave_generator.w"] == pytest.approx(523.5, abs=0.1)
