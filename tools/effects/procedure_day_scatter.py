"""Days that differ more than stated."""

from .cause import Cause, Size

CAUSE = Cause(
    id="procedure.day_scatter",
    doc="Cooling that differs from day to day more than the card states, without a pattern.",
    size=Size(
        "sd", "1", "relative standard deviation of the days' cooling beside what the card states", 0.05, 0.0, 0.6
    ),
    exposes="the same point on several days; draught and neighbours logged",
    like="day to day: humidity and other scatter of the days are one answer unless humidity is measured",
    scatter=True,
)
