"""Parts that read what a model does not tell of itself: speeds of shafts and loads of bearings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ...model.core.component import Component, Equation, equation
from ...model.core.declare import Output, Port, declared
from ...model.machines.spec import PartSpec, Spec
from ...model.parts.ports import BearingLoad, Flange


class FlangeReading(Component):
    """Speed of a shaft."""

    port = Flange()
    w = Output("rad/s", "angular velocity", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """It takes no torque."""
        yield equation("speed read", self.w, self.port.w)
        yield equation("no torque", self.port.tau, 0.0)


class LoadReading(Component):
    """Load of a bearing."""

    port = BearingLoad()
    F_r = Output("N", "radial load", nominal=1000.0)
    F_a = Output("N", "axial load", nominal=1000.0)

    def equations(self) -> Iterator[Equation]:
        """Both loads."""
        yield equation("radial load read", self.F_r, self.port.F_r)
        yield equation("axial load read", self.F_a, self.port.F_a)


#: Port -> the part that reads it.
READINGS: Mapping[type[Port], type[Component]] = {
    Flange: FlangeReading,
    BearingLoad: LoadReading,
}


def with_readings(spec: Spec, parts: Iterable[str]) -> Spec:
    """The spec with a reading at every shaft and load of some of its parts.

    The outputs of the readings are `reading(part, port)` and ".w", ".F_r" or ".F_a".

    Args:
        spec: the machine
        parts: names of the parts
    """
    probes, nets = [], []
    for part in parts:
        for key, port in declared(spec.types[spec.part(part).type], Port).items():
            if (kind := READINGS.get(type(port))) is not None:
                probes.append(PartSpec(reading(part, key), kind.__name__))
                nets.append((f"{reading(part, key)}.port", f"{part}.{key}"))
    return spec.with_parts(probes, nets, {kind.__name__: kind for kind in READINGS.values()})


def reading(part: str, port: str) -> str:
    """Name of the reading at a port of a part."""
    return f"reading_{part}_{port}"
