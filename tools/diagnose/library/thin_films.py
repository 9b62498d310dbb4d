"""Tooth friction in thin films, uncertain in the model."""

from __future__ import annotations

from ....model.machines.spec import PartSpec
from ....scenarios.nuisances import Nuisance
from .extras import Extras
from .forms import Context

#: Typical size of the uncertain friction in thin films, as a share of the typical loss [1].
THIN_FILMS = 0.057
#: Exponents of speed (a), viscosity (b) and load (c), typical of starved teeth, and the share of the heat in the oil.
EXPONENTS = {"a": -0.35, "b": -1.2, "c": 1.2, "oil_share": 0.8}


def thin_film_friction(at: Context) -> Nuisance | None:
    """Uncertain growth of tooth friction in thin films; None for a machine without lubricated teeth.

    A cause that warms the oil takes the machine to films thinner than on any healthy day. The model's tooth friction is
    uncertain there, and without this nuisance its error would be taken for a second cause.

    Args:
        at: machine and data
    """
    places = [place for place in at.roles.places["teeth"] if place.lubricant]
    if not places:
        return None
    extras = Extras("habit", at)
    made = [extras.loss(place, k, len(places)) for k, place in enumerate(places)]
    power = {"P_ref": THIN_FILMS * at.ranges.loss / len(places), "k": 1.0}
    parts = tuple(PartSpec(part.name, "ExtraHabit", {**part.values, **EXPONENTS, **power}) for part, _ in made)
    connections = tuple(net for _, nets in made for net in nets)
    paths = {f"{part.name}.k": 1.0 for part in parts}
    return Nuisance("thin films", paths, 0.0, 1.0, parts=parts, connections=connections)
