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
    from .tools.compare.calibrate import Calibration as Calibration
    from .tools.compare.calibrate import calibrate as calibrate
    from .tools.compare.replay import Replays as Replays
    from .tools.compare.replay import replay as replay
    from .tools.compare.results import Errors as Errors
    from .tools.compare.results import compare as compare
    from .tools.compare.run import CampaignRun as CampaignRun
    from .tools.compare.run import run as run
    from .tools.describe.description import Description as Description
    from .tools.describe.description import show as show
    from .tools.describe.parts import PartTypes as PartTypes
    from .tools.describe.parts import parts as parts
    from .tools.describe.rig import Rig as Rig
    from .tools.describe.rig import assemble as assemble
    from .tools.describe.rig import load as load
    from .tools.describe.rig import rigs as rigs
    from .tools.describe.schema import schema as schema
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
    from .tools.films.film import FilmTable as FilmTable
    from .tools.films.film import film as film
    from .tools.rating.rate import MethodRating as MethodRating
    from .tools.rating.rate import rate_by_method as rate_by_method
    from .tools.solve.design import DesignAnswer as DesignAnswer
    from .tools.solve.design import design as design
    from .tools.solve.losses import LossTable as LossTable
    from .tools.solve.losses import losses as losses
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
    from .tools.verify.contact.command import ContactVerification as ContactVerification
    from .tools.verify.contact.command import verify_contact as verify_contact
    from .tools.verify.verify import Verification as Verification
    from .tools.verify.verify import verify as verify

    map = map_outputs

#: Public name -> module that has it.
PUBLIC: dict[str, str] = {
    "assemble": "tools.describe.rig",
    "calibrate": "tools.compare.calibrate",
    "Calibration": "tools.compare.calibrate",
    "CampaignRun": "tools.compare.run",
    "card": "tools.diagnose.api",
    "CardText": "tools.diagnose.api",
    "compare": "tools.compare.results",
    "Component": "model.core.component",
    "ContactVerification": "tools.verify.contact.command",
    "Description": "tools.describe.description",
    "design": "tools.solve.design",
    "DesignAnswer": "tools.solve.design",
    "diagnose": "tools.diagnose.api",
    "Diagnosis": "tools.diagnose.asking",
    "Errors": "tools.compare.results",
    "export": "tools.export.export",
    "Exported": "tools.export.fmu",
    "film": "tools.films.film",
    "FilmTable": "tools.films.film",
    "GearheatError": "model.errors",
    "load": "tools.describe.rig",
    "losses": "tools.solve.losses",
    "LossTable": "tools.solve.losses",
    "Map": "tools.solve.maps",
    "map": "tools.solve.maps",
    "MethodRating": "tools.rating.rate",
    "new": "tools.build.new",
    "NewRig": "tools.build.new",
    "Outputs": "tools.diagnose.asking",
    "parts": "tools.describe.parts",
    "PartTypes": "tools.describe.parts",
    "plan": "tools.diagnose.api",
    "PlanAnswer": "tools.diagnose.asking",
    "play": "tools.export.play",
    "rate_by_method": "tools.rating.rate",
    "Rating": "tools.solve.maps",
    "rating": "tools.solve.maps",
    "replay": "tools.compare.replay",
    "Replays": "tools.compare.replay",
    "Rig": "tools.describe.rig",
    "rigs": "tools.describe.rig",
    "run": "tools.compare.run",
    "schema": "tools.describe.schema",
    "Shipped": "tools.describe.shipped",
    "shipped": "tools.describe.shipped",
    "show": "tools.describe.description",
    "simulate": "tools.solve.simulate",
    "steady": "tools.solve.steady",
    "SteadyState": "tools.solve.steady",
    "Sweep": "tools.solve.sweep",
    "sweep": "tools.solve.sweep",
    "TimeSeries": "tools.solve.simulate",
    "Verification": "tools.verify.verify",
    "verify": "tools.verify.verify",
    "verify_contact": "tools.verify.contact.command",
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
