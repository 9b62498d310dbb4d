"""The public names, for type checkers, editors and `__init__.py`, which imports each when it is asked for."""

from .model.core.component import Component as Component
from .model.errors import GearheatError as GearheatError
from .scenarios.own_types import use_parts as use_parts
from .scenarios.ranges import override as override
from .tools.build.new import NewRig as NewRig, new as new
from .tools.compare.calibrate import Calibration as Calibration, calibrate as calibrate
from .tools.compare.card import CardText as CardText, card as card
from .tools.compare.published import CampaignFiles as CampaignFiles, campaign as campaign
from .tools.compare.replay import Replays as Replays, replay as replay
from .tools.compare.results import Errors as Errors, compare as compare
from .tools.compare.run import CampaignRun as CampaignRun, run as run
from .tools.describe.description import Description as Description, show as show
from .tools.describe.parts import PartTypes as PartTypes, parts as parts, schema as schema
from .tools.describe.rig import Rig as Rig, assemble as assemble, load as load, rigs as rigs
from .tools.describe.shipped import Shipped as Shipped, shipped as shipped
from .tools.diagnose.api import (
    Diagnosis as Diagnosis,
    Outputs as Outputs,
    PlanAnswer as PlanAnswer,
    diagnose as diagnose,
    plan as plan,
)
from .tools.export.export import export as export, play as play
from .tools.export.fmu import Exported as Exported
from .tools.films.film import FilmTable as FilmTable, film as film
from .tools.films.teeth import TeethFelt as TeethFelt, teeth as teeth
from .tools.page.page import Page as Page, page as page
from .tools.rating.rate import MethodRating as MethodRating, rate_by_method as rate_by_method
from .tools.solve.design import DesignAnswer as DesignAnswer, design as design
from .tools.solve.losses import LossTable as LossTable, losses as losses
from .tools.solve.maps import Map as Map, Rating as Rating, map_outputs, rating as rating
from .tools.solve.simulate import TimeSeries as TimeSeries, simulate as simulate
from .tools.solve.steady import SteadyState as SteadyState, steady as steady
from .tools.solve.sweep import Sweep as Sweep, sweep as sweep
from .tools.verify.contact.command import ContactVerification as ContactVerification, verify_contact as verify_contact
from .tools.verify.verify import Verification as Verification, verify as verify
from .tools.watch.api import watch as watch

map = map_outputs
PUBLIC: dict[str, tuple[str, str]]
