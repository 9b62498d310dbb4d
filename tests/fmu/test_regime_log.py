"""An FMU whose contact is outside the regime of its film law says in its log which regime it is in."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from gearheat.fmu.export import export
from gearheat.scenarios.load import load


def test_the_log_names_the_regime(tmp_path: Path, opened: Callable[..., Any]) -> None:
    fmu = export(load("harmonic_printed").spec.flat(), tmp_path / "printed.fmu")
    one = opened(fmu, logging=True).start()
    for k in range(3):
        one.fmu.doStep(k, 1)
    told = [text for _, category, text in one.messages if category == "logStatusWarning"]
    assert [text for text in told if text.startswith("mesh: rigid_isoviscous of elastohydrodynamic")] != []
    assert not [text for text in told if "rigid_piezoviscous" in text or "elastic_isoviscous" in text]
    assert one.get("mesh.h_min") == [pytest.approx(1.2651e-6, rel=1e-4)]
