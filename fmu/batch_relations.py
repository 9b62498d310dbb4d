"""Relations between the parameters of many rows: the C source, and the call."""

from __future__ import annotations

import numpy as np

from ..model.core.flat import FlatModel
from . import emit
from .batch_library import address, driver
from .fixed import wrapper


def relations_source(flat: FlatModel) -> str:
    """The C text that judges rows of parameters; nothing where the model has no relations.

    Raises:
        FmuError: an operation has no C text
    """
    if not flat.relations:
        return ""
    limits = {"low": [r.low for r in flat.relations], "high": [r.high for r in flat.relations]}
    return "\n".join(
        [
            f"#define N_RELATIONS {len(flat.relations)}",
            wrapper("batch.h"),
            *(
                f"static const double model_relation_{end}[] = {{{', '.join(map(emit.number, numbers))}}};"
                for end, numbers in limits.items()
            ),
            emit.function(flat.relation_function),
            wrapper("batch_relations.c"),
        ]
    )


def broken_relations(source: str, p: np.ndarray) -> np.ndarray:
    """Place of the first relation that does not hold in each row, -1 where all do.

    Args:
        source: of `relations_source`
        p: parameters (n, parameters), or a vector
    """
    rows = np.ascontiguousarray(np.atleast_2d(p), dtype=float)
    broken = np.full(len(rows), -1, dtype=np.int32)
    if source:
        driver("batch_relations", source)(len(rows), address(rows), rows.shape[1], address(broken))
    return broken
