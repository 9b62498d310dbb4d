"""An FMU for real time: what a communication step costs at most, and what its fixed steps are wrong by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...fmu.source import MAX_CORRECTIONS, OF_LIBRARY, headers_of_3
from ...fmu.stack import deepest_stack
from ...model.core.flat import FlatModel
from ...model.run.schedule import Schedule
from .extras import check_fmu, reference_run

#: Steps of the solver in the run that is compared: some seconds of processor time.
_STEPS = 5e5


@dataclass(frozen=True)
class RealTime:
    """What is told of an FMU for real time.

    Attributes:
        step: its longest communication step with one step of the solver [s]
        evaluations: of the implicit equations in such a step, at most
        stack: bytes below a call of DoStep, on the exporting machine's processor
        checks: what was compared, and the result
    """

    step: float
    evaluations: int
    stack: int
    checks: tuple[tuple[str, str], ...]

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """All of it as it stands in the documentation of the FMU."""
        costs = {
            f"steps of the solver in a communication step of {self.step:g} s": "1",
            "evaluations of the implicit equations in it, at most": str(self.evaluations),
            "stack below DoStep, on the exporting machine's processor, without the C library": f"{self.stack} bytes",
        }
        return (*costs.items(), *self.checks)

    def as_dict(self) -> dict[str, Any]:
        """All of it for JSON."""
        told = {"step_s": self.step, "solver_steps": 1, "evaluations": self.evaluations, "stack_bytes": self.stack}
        return told | {"checks": dict(self.checks)}


def measure(
    fmu: Path, code: str, flat: FlatModel, duty: Schedule, start: Mapping[str, float], fmi: int, step: float
) -> RealTime:
    """Measure a finished FMU over its reference duty, which is shortened where it has more steps than `_STEPS`.

    Args:
        fmu: the file
        code: its C source
        flat: the model
        duty: of the reference result
        start: start values that are not those of the model
        fmi: version of the standard
        step: its longest step [s]
    """
    short = replace(duty, time=duty.time * min(1.0, _STEPS * step / duty.stop))
    stack = deepest_stack(OF_LIBRARY + code, f"fmi{fmi}DoStep", headers_of_3() if fmi == 3 else {})
    evaluations = 2 * (MAX_CORRECTIONS + 2) if flat.residual_names else 0  # two more where there is no solution
    return RealTime(step, evaluations, stack, check_fmu(fmu, flat, short, reference_run(flat, short, start)))
