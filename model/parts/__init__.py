"""Components: declarations followed by named equations. `PARTS` holds every type a rig file can name."""

from ..core.component import Component
from .bearings import DeepGrooveBallBearing, NeedleBearing, TaperedRollerBearing
from .churning import Churning
from .extra import ExtraConductor, ExtraHeat, ExtraLoss
from .gears import HelicalGearPair, PlanetarySet
from .lubrication import Grease, OilBath
from .sealing import LipSeal
from .shaft import Efficiency, FanLoad, FixedFlange, Inertia, ShaftEnd
from .supports import ShaftSupport, TwoGearSupport
from .thermal import (
    BoxCooling,
    CylinderCooling,
    CylinderWall,
    FinnedBoxCooling,
    HeatCapacity,
    PlaneWall,
    Room,
    ThermalConductor,
)

PARTS: dict[str, type[Component]] = {
    part.__name__: part
    for part in (
        ShaftEnd,
        FixedFlange,
        FanLoad,
        Inertia,
        Efficiency,
        PlanetarySet,
        HelicalGearPair,
        ShaftSupport,
        TwoGearSupport,
        TaperedRollerBearing,
        DeepGrooveBallBearing,
        NeedleBearing,
        LipSeal,
        Churning,
        OilBath,
        Grease,
        HeatCapacity,
        ThermalConductor,
        PlaneWall,
        CylinderWall,
        BoxCooling,
        CylinderCooling,
        FinnedBoxCooling,
        Room,
        ExtraHeat,
        ExtraLoss,
        ExtraConductor,
    )
}
