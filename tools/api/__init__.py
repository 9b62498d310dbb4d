"""Losses and temperatures of gearboxes: simulate, design, export as FMU, compare with measurements, diagnose.

    import gearheat as gh

    rig = gh.load("planetary")
    hot = gh.steady(rig, {"room.T": "35 degC"})
    hot["oil.T"], hot.to("oil.T", "degC"), hot.losses()

Names are imported when they are asked for, so that `import gearheat` takes no time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .model.core.component import Component as Component
    from .model.errors import GearheatError as GearheatError
    from .tools.build.new import NewRig as NewRig
    from .tools.build.new import new as new
    from .tools.describe.description import Description as Description
    from .tools.describe.description import show as show
    from .tools.describe.parts import PartTypes as PartTypes
    from .tools.describe.parts import parts as parts
    from .tools.describe.parts import schema as schema
    from .tools.describe.rig import Rig as Rig
    from .tools.describe.rig import assemble as assemble
    from .tools.describe.rig import load as load
    from .tools.describe.rig import rigs as rigs
    from .tools.describe.shipped import Shipped as Shipped
    from .tools.describe.shipped import shipped as shipped
    from .tools.diagnose.api import CardText as CardText
    from .tools.diagnose.api import card as card
    from .tools.diagnose.api import diagnose as diagnose
    from .tools.diagnose.api import plan as plan
    from .tools.diagnose.asking import Diagnosis as Diagnosis
    from .tools.diagnose.asking import Outputs as Outputs
    from .tools.diagnose.asking import PlanAnswer as PlanAnswer
    from .tools.export.export import export as export
    from .tools.export.fmu import Exported as Exported
    from .tools.export.play import play as play
    from .tools.solve.design import DesignAnswer as DesignAnswer
    from .tools.solve.design import design as design
    from .tools.solve.maps import Map as Map
    from .tools.solve.maps import Rating as Rating
    from .tools.solve.maps import map_outputs
    from .tools.solve.maps import rating as rating
    from .tools.solve.simulate import TimeSeries as TimeSeries
    from .tools.solve.simulate import simulate as simulate
    from .tools.solve.steady import SteadyState as SteadyState
    from .tools.solve.steady import steady as steady
    from .tools.solve.sweep import Sweep as Sweep
    from .tools.solve.sweep import sweep as sweep

    map = map_outputs

#: Public name -> module that has it.
PUBLIC: dict[str, str] = {
    "CardText": "tools.diagnose.api",
    "Component": "model.core.component",
    "Description": "tools.describe.description",
    "Diagnosis": "tools.diagnose.asking",
    "DesignAnswer": "tools.solve.design",
    "Exported": "tools.export.fmu",
    "GearheatError": "model.errors",
    "Map": "tools.solve.maps",
    "NewRig": "tools.build.new",
    "Outputs": "tools.diagnose.asking",
    "PartTypes": "tools.describe.parts",
    "PlanAnswer": "tools.diagnose.asking",
    "Rating": "tools.solve.maps",
    "Rig": "tools.describe.rig",
    "Shipped": "tools.describe.shipped",
    "SteadyState": "tools.solve.steady",
    "Sweep": "tools.solve.sweep",
    "TimeSeries": "tools.solve.simulate",
    "assemble": "tools.describe.rig",
    "card": "tools.diagnose.api",
    "design": "tools.solve.design",
    "diagnose": "tools.diagnose.api",
    "export": "tools.export.export",
    "load": "tools.describe.rig",
    "map": "tools.solve.maps",
    "new": "tools.build.new",
    "parts": "tools.describe.parts",
    "plan": "tools.diagnose.api",
    "play": "tools.export.play",
    "rating": "tools.solve.maps",
    "rigs": "tools.describe.rig",
    "schema": "tools.describe.parts",
    "shipped": "tools.describe.shipped",
    "show": "tools.describe.description",
    "simulate": "tools.solve.simulate",
    "steady": "tools.solve.steady",
    "sweep": "tools.solve.sweep",
}
#: Public names that their module spells otherwise, since it has another use for them.
RENAMED = {"map": "map_outputs"}

__all__ = list(PUBLIC)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is asked for."""
    if name not in PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{PUBLIC[name]}", __name__), RENAMED.get(name, name))


def __dir__() -> list[str]:
    """The public names."""
    return __all__
