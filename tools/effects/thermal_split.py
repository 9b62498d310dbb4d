"""Heat that appears in another body than assumed."""

from .cause import Cause, Size

CAUSE = Cause(
    id="thermal.split",
    doc="Losses heat carrier and wall in another proportion than assumed.",
    size=Size("shift", "1", "share of bearing and seal heat moved to the carrier's side", 0.3, -0.5, 0.5),
    exposes="a probe on the shaft; a logged warm-up",
    values=lambda base, theta, rows: {
        f"{part}.inner_share": 0.5 + theta["shift"]
        for part in ("carrier_bearing", "sun_bearing", "carrier_seal", "sun_seal")
    },
)
