"""The two-stage helical rig without its six bearings, or without churning: for tests that have their own."""

import re
from dataclasses import replace

from gearheat.model.machines.spec import Spec
from gearheat.scenarios.load import RIGS, load

WHOLE = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")

#: What all six have in common.
BEARING = """type = "DeepGrooveBallBearing"
count = 1
F_r_0 = "0 N"
F_a_0 = "0 N"
K_rs = 3e-8
mu_bl = 0.12
mu_EHL = 0.05
oil_bath = false
inner_share = 0.5
source = "assumed: above the oil level"
sources = { K_rs = "SKF2018, friction", mu_bl = "SKF2018, friction" }
"""


def with_bearings(written: str) -> str:
    """The rig with other tables for its bearings, before those of the oil."""
    text = re.sub(r"\[part\.\w+_bearing_[ab]\].*?(?=\n\[|\n# -)", "", WHOLE, flags=re.S)
    return text.replace("[part.oil]", written + "[part.oil]")


def without_level() -> Spec:
    """The rig with no wheel that dips, and no level of its oil."""
    spec = load("helical_two_stage").spec
    parts = [replace(p, values={k: v for k, v in p.values.items() if k != "level"}) for p in spec.parts]
    nets = [tuple(port for port in net if not port.startswith("churning_")) for net in spec.connections]
    kept = tuple(p for p in parts if not p.name.startswith("churning_"))
    return replace(spec, parts=kept, connections=tuple(net for net in nets if net != ("oil.sump",)))
