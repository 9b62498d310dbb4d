"""A flat model as a module of WebAssembly: steady states and warm-ups of rows by the C code that `batch` compiles.

It exports `batch_steady`, `batch_warmup` and, where the model has relations, `batch_relations`, with `malloc` and
`free`. It imports nothing. Numbers of rows and strides are 64-bit integers, addresses 32-bit ones.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from ..model.core.flat import FlatModel, Quantity
from .batch_library import relations_source, steady_source, warmup_source
from .compiling import WEB, binary

#: Steps of a warm-up between two points of its schedule or output: a page must answer.
MOST_STEPS = 20_000


def with_checks(flat: FlatModel) -> FlatModel:
    """The model with the arguments of its laws that have a range as outputs behind its own, as `checks` has them."""
    arguments = (Quantity(f"check.{i}", "1", check.argument) for i, check in enumerate(flat.checks))
    return replace(flat, outputs=(*flat.outputs, *arguments), y=ca.vertcat(flat.y, flat.checked))


def module(flat: FlatModel) -> bytes:
    """The module of a model.

    Args:
        flat: the model

    Raises:
        FmuError: an operation has no C text, the compiler is missing or fails
    """
    more = {"warmup.c": warmup_source(flat, MOST_STEPS), "relations.c": relations_source(flat)}
    return binary(steady_source(flat), WEB, headers={name: text for name, text in more.items() if text})
