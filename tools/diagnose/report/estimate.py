"""A fitted parameter, as plain data."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .numbers import Interval, Model, Number


class Estimate(Model):
    """A fitted parameter with its 95 % interval."""

    name: str
    value: Number
    ci95: Interval
    unit: str
    doc: str = Field(default="", description="what it is, in words")
    at_bound: Literal["", "low", "high"] = Field(default="", description="the bound that the value sits on")
