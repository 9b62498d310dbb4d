"""Components: declarations followed by named equations. `PARTS` holds every type of the physics."""

from ..core.component import Component
from .bearings import (
    AngularContactBallBearing,
    CylindricalRollerBearing,
    CylindricalRollerThrustBearing,
    DeepGrooveBallBearing,
    NeedleBearing,
    SphericalRollerBearing,
    TaperedRollerBearing,
    ThrustBallBearing,
)
from .bevel import BevelGearPair
from .churning import Churning, GearChurning, GearWindage, MeshSqueezing
from .clutch import Brake, CompliantShaft, FrictionClutch, OneWayClutch
from .cycloid import CycloidalReducer, MalhotraReducer
from .drum import BeltContact, BeltPull, DrumChurning, DrumCooling, DrumOil, WettedWall
from .fan import ShaftFan
from .gears import HelicalGearPair, InternalGearPair
from .grey import Cooler, FlowConductor, GreyBearing, GreyTeeth, OilJet, Thermostat
from .harmonic import HarmonicContact, HarmonicMesh
from .housing import (
    FlatWallCooling,
    LinearFlatWallCooling,
    LinearShellCooling,
    OilToHousing,
    RoundHousing,
    ShellCooling,
)
from .journal import PlainBearing
from .lubrication import Grease, OilBath
from .motor import Motor
from .oil_circuit import OilExchanger, OilFilter, OilNozzle, OilPump, OilSump
from .planetary import PlanetarySet
from .preload import PreloadedPair
from .rv import CycloidPinStage
from .sealing import LabyrinthSeal, LipSeal, OilLipSeal
from .shaft import Efficiency, FanLoad, FixedFlange, Inertia, LoadingClutch, ShaftEnd, TorqueSplit, TurningFrame
from .splash import GearOilConductor, SplashConductor
from .supports import ShaftSupport, TwoGearSupport
from .thermal import (
    BoxCooling,
    ClosedRoom,
    CylinderCooling,
    CylinderWall,
    FinnedBoxCooling,
    HeatCapacity,
    PlaneWall,
    PrescribedHeatFlow,
    PrescribedTemperature,
    Room,
    Sun,
    ThermalConductor,
)
from .worm import WormPair

PARTS: dict[str, type[Component]] = {
    part.__name__: part
    for part in (
        ShaftEnd,
        FixedFlange,
        FanLoad,
        ShaftFan,
        Inertia,
        LoadingClutch,
        FrictionClutch,
        OneWayClutch,
        Brake,
        CompliantShaft,
        TorqueSplit,
        TurningFrame,
        Efficiency,
        Motor,
        PlanetarySet,
        HelicalGearPair,
        InternalGearPair,
        BevelGearPair,
        WormPair,
        CycloidalReducer,
        MalhotraReducer,
        CycloidPinStage,
        HarmonicMesh,
        HarmonicContact,
        BeltPull,
        ShaftSupport,
        TwoGearSupport,
        PreloadedPair,
        TaperedRollerBearing,
        DeepGrooveBallBearing,
        CylindricalRollerBearing,
        AngularContactBallBearing,
        SphericalRollerBearing,
        ThrustBallBearing,
        CylindricalRollerThrustBearing,
        NeedleBearing,
        PlainBearing,
        LipSeal,
        OilLipSeal,
        LabyrinthSeal,
        Churning,
        GearChurning,
        GearWindage,
        MeshSqueezing,
        DrumChurning,
        OilBath,
        DrumOil,
        Grease,
        OilSump,
        OilPump,
        OilFilter,
        OilNozzle,
        OilExchanger,
        HeatCapacity,
        ThermalConductor,
        PlaneWall,
        CylinderWall,
        WettedWall,
        BeltContact,
        BoxCooling,
        CylinderCooling,
        DrumCooling,
        FinnedBoxCooling,
        RoundHousing,
        OilToHousing,
        SplashConductor,
        GearOilConductor,
        FlatWallCooling,
        ShellCooling,
        LinearFlatWallCooling,
        LinearShellCooling,
        Room,
        ClosedRoom,
        PrescribedTemperature,
        PrescribedHeatFlow,
        Sun,
        GreyTeeth,
        GreyBearing,
        FlowConductor,
        OilJet,
        Thermostat,
        Cooler,
    )
}
