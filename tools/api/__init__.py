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
    from .tools.build.new import NewRig as NewRig, new as new
    from .tools.compare.calibrate import Calibration as Calibration, calibrate as calibrate
    from .tools.compare.replay import Replays as Replays, replay as replay
    from .tools.compare.results import Errors as Errors, compare as compare
    from .tools.compare.run import CampaignRun as CampaignRun, run as run
    from .tools.describe.description import Description as Description, show as show
    from .tools.describe.parts import PartTypes as PartTypes, parts as parts, schema as schema
    from .tools.describe.rig import Rig as Rig, assemble as assemble, load as load, rigs as rigs
    from .tools.describe.shipped import Shipped as Shipped, shipped as shipped
    from .tools.diagnose.api import (
        CardText as CardText,
        Diagnosis as Diagnosis,
        Outputs as Outputs,
        PlanAnswer as PlanAnswer,
        card as card,
        diagnose as diagnose,
        plan as plan,
    )
    from .tools.export.export import export as export, play as play
    from .tools.export.fmu import Exported as Exported
    from .tools.films.film import FilmTable as FilmTable, film as film
    from .tools.rating.rate import MethodRating as MethodRating, rate_by_method as rate_by_method
    from .tools.solve.design import DesignAnswer as DesignAnswer, design as design
    from .tools.solve.losses import LossTable as LossTable, losses as losses
    from .tools.solve.maps import Map as Map, Rating as Rating, map_outputs, rating as rating
    from .tools.solve.simulate import TimeSeries as TimeSeries, simulate as simulate
    from .tools.solve.steady import SteadyState as SteadyState, steady as steady
    from .tools.solve.sweep import Sweep as Sweep, sweep as sweep
    from .tools.verify.contact.command import (
        ContactVerification as ContactVerification,
        verify_contact as verify_contact,
    )
    from .tools.verify.verify import Verification as Verification, verify as verify

    map = map_outputs

#: Module -> the public names that it has.
MODULES: dict[str, tuple[str, ...]] = {
    "model.core.component": ("Component",),
    "model.errors": ("GearheatError",),
    "tools.build.new": ("new", "NewRig"),
    "tools.compare.calibrate": ("calibrate", "Calibration"),
    "tools.compare.replay": ("replay", "Replays"),
    "tools.compare.results": ("compare", "Errors"),
    "tools.compare.run": ("CampaignRun", "run"),
    "tools.describe.description": ("Description", "show"),
    "tools.describe.parts": ("parts", "PartTypes", "schema"),
    "tools.describe.rig": ("assemble", "load", "Rig", "rigs"),
    "tools.describe.shipped": ("Shipped", "shipped"),
    "tools.diagnose.api": ("card", "CardText", "diagnose", "Diagnosis", "Outputs", "plan", "PlanAnswer"),
    "tools.export.export": ("export", "play"),
    "tools.export.fmu": ("Exported",),
    "tools.films.film": ("film", "FilmTable"),
    "tools.rating.rate": ("MethodRating", "rate_by_method"),
    "tools.solve.design": ("design", "DesignAnswer"),
    "tools.solve.losses": ("losses", "LossTable"),
    "tools.solve.maps": ("Map", "map", "Rating", "rating"),
    "tools.solve.simulate": ("simulate", "TimeSeries"),
    "tools.solve.steady": ("steady", "SteadyState"),
    "tools.solve.sweep": ("Sweep", "sweep"),
    "tools.verify.contact.command": ("ContactVerification", "verify_contact"),
    "tools.verify.verify": ("Verification", "verify"),
}
#: Public name -> module that has it.
PUBLIC = {name: module for module, names in MODULES.items() for name in names}
PUBLIC = {name: PUBLIC[name] for name in sorted(PUBLIC, key=str.lower)}
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
