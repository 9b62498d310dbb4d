"""The C source of an FMU as one text: FMI headers, the model's tables and functions, the fixed wrapper."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib.resources import files
from typing import Any, NamedTuple

from ..model.core.flat import FlatModel
from ..model.run import newton
from ..model.run.algebra import GUESSES
from . import emit
from .description import TOLERANCE, identifier
from .equations import Equations
from .fixed import tables, wrapper
from .leading import Directions, Sensitivities, locate_deviations
from .rosenbrock import RODAS3
from .units import fmi_unit
from .variables import ROOM, START, STEADY, Table

_HEADERS = ("fmi2TypesPlatform.h", "fmi2FunctionTypes.h", "fmi2Functions.h")
_NOTICE = "Copyright (c) 2026, the gearheat developers. SPDX-License-Identifier: BSD-3-Clause"

#: FMPy's copy of the header lacks what the standard's has: names that begin with FMI2_FUNCTION_PREFIX, so that several
#: FMUs can be linked into one program.
_NAME = "\n#define fmi2FullName(name) name\n"
#: Types of variables, one bit each as instance.h has them.
_TYPES = {"Real": 1, "Integer": 2, "Enumeration": 4}

#: Corrections of Newton's method that a solver for real time tries at most at each end of a communication step.
MAX_CORRECTIONS = 20
#: Where the identification goes; it is the hash of everything else.
GUID_MARK = "@GUID@"


#: What stands in the place of another file where there are standard deviations.
_UNCERTAIN = {"certain.c": "uncertain.c"}
#: Before the source of a shared library, whose functions have the names of the standard.
OF_LIBRARY = "#define FMI3_OVERRIDE_FUNCTION_PREFIX\n"

#: The standard's headers; an importer that compiles the source brings its own.
_HEADERS_3 = ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h")

_TABLES = tables("wrapper")
_DEFINITION = re.compile(rf"^(fmi2\w+) ({'|'.join(_TABLES['inner'])})\(", re.MULTILINE)


def source(
    flat: FlatModel,
    model: Equations,
    table: Table,
    fmi: int = 2,
    directions: Directions | None = None,
    real_time: float | None = None,
) -> str:
    """The whole C text, with GUID_MARK in place of the identification.

    Args:
        flat: the model, for its name and values
        model: its equations
        table: its variables
        fmi: version of the standard, 2 or 3; with 3 the compiler needs the standard's headers beside the text
        directions: of the standard deviations, where it has some
        real_time: longest step of a solver that takes no more steps than this asks for [s]
    """
    name = re.sub(r"[^ -~]|[*/\\?]", "_", flat.name)
    head = f"/* {name}: FMI {fmi}.0 for model exchange and co-simulation in one file.\n   {_NOTICE} */\n"
    functions = model.functions if fmi == 2 else (*model.functions, *model.adjoint_functions)
    if directions is not None:
        functions += Sensitivities(model, directions.count, directions.moving, locate_deviations(table)).functions
    bounds = {"REAL_TIME": emit.number(real_time or 0.0), "MAX_CORRECTIONS": MAX_CORRECTIONS if real_time else -1}
    values = [_sizes(flat, model, table, directions, bounds), _tables(flat, table), _directions(directions, table)]
    generated = "\n".join([*values, *map(emit.function, functions)])
    instead = {} if directions is None else _UNCERTAIN
    texts = [wrapper(instead.get(name, name)) for name in tables("wrapper")["files"][f"fmi{fmi}"]]
    if fmi == 2:
        return "\n".join([head, _fmi_headers(), generated, *texts])
    prefix = f"#ifndef FMI3_FUNCTION_PREFIX\n#define FMI3_FUNCTION_PREFIX {identifier(flat.name)}_\n#endif\n"
    included = f'{prefix}#include "fmi3Functions.h"\n'  # names that no other FMU in a program has
    return "\n".join([head, included, generated, *map(in_words_of_3, texts)])


def _fmi_headers() -> str:
    """The standard's headers, without their includes of each other."""
    folder = files("fmpy") / "c-code"
    texts = [(folder / name).read_text(encoding="utf-8") for name in _HEADERS]
    whole = "\n".join(re.sub(r'#include "fmi2\w+\.h"\n', "", text.replace("\r\n", "\n")) for text in texts)
    return whole.replace(_NAME, wrapper("fmi2_names.h"))


def _sizes(
    flat: FlatModel, model: Equations, table: Table, directions: Directions | None, bounds: Mapping[str, Any]
) -> str:
    sizes = {
        "NX": len(table.of("state")),
        "NZ": len(flat.algebraic),
        "NU": len(table.of("input")),
        "NY": len(table.of("output")),
        "NP": len(table.of("parameter")),
        "NC": model.constants.numel_out(0),
        "NK": len(flat.checks),
        "NR": len(flat.relations),
        "NS": len(flat.states),
        "ND": 0 if directions is None else directions.count,
        "N_SIDES": 0 if directions is None else len(directions.sides),
        "NSD": len(table.of("deviation")),
        "N_CHOICES": len(table.of("choice")),
        "N_PRESETS": len(_presets(table)),
        "AUDIT": int(table.audit),
        **_beginnings(table),
        "ORDER": RODAS3.order,
        "TOLERANCE": TOLERANCE,
        "MODEL_NAME": _string(flat.name),
        "MODEL_GUID": _string(GUID_MARK),
        **bounds,
    }
    return "#include <math.h>\n\n" + wrapper("c90.h") + define_macros(sizes | newton_constants())


def define_macros(values: Mapping[str, Any]) -> str:
    """Definitions for the preprocessor."""
    return "".join(f"#define {name} {value}\n" for name, value in values.items())


def newton_constants() -> dict[str, str]:
    """The numbers of `gearheat.model.run.newton` and `algebra`, for the same methods in C."""
    numbers = {name: value for name, value in vars(newton).items() if name.isupper() and isinstance(value, int | float)}
    guesses = ", ".join(emit.number(factor) for factor in GUESSES)
    written = {name: str(v) if isinstance(v, int) else emit.number(v) for name, v in numbers.items()}
    return written | {"GUESSES": f"{{{guesses}}}", "N_GUESSES": str(len(GUESSES))}


def _tables(flat: FlatModel, table: Table) -> str:
    checks, relations = flat.checks, flat.relations
    strings = {
        "model_names": [v.name for v in table],
        "model_units": ["" if v.quantity.unit == "1" else f" {fmi_unit(v.quantity.unit)}" for v in table],
        "model_ranges": [v.range_text for v in table],
        "model_blocks": flat.residual_names,
        "model_checks": [
            f"{c.component}: {c.argument} of {c.law.name} ({c.law.source}, {c.law.where})" for c in checks
        ],
        "model_relations": [f'{r.component}: "{r.name}" does not hold: {r.value} is' for r in relations],
        "model_remedies": [f"expected {r.bounds}. {r.remedy}" for r in relations],
    }
    presets = _presets(table)
    whole = {
        "model_type": [_TYPES[v.type] for v in table],
        "model_preset_choice": [p.choice for p in presets],
        "model_preset_item": [p.item for p in presets],
        "model_preset_parameter": [p.parameter for p in presets],
        "model_follows_room": [int(v.name in flat.bodies) for v in table.of("state")],
    }
    numbers = {
        "model_preset_value": [p.value for p in presets],
        "model_start": [v.start or 0.0 for v in table],
        "model_low": [v.bounds[0] for v in table],
        "model_high": [v.bounds[1] for v in table],
        "model_nominal": [v.quantity.nominal for v in table],
        "model_z_start": [q.start for q in flat.algebraic],
        "model_z_nominal": [q.nominal for q in flat.algebraic],
        "model_check_low": [c.low for c in checks],
        "model_check_high": [c.high for c in checks],
        "model_relation_low": [r.low for r in relations],
        "model_relation_high": [r.high for r in relations],
    }
    texts = [_array("const char *const", name, map(_string, values)) for name, values in strings.items()]
    texts += [_array("const int", name, map(str, values)) for name, values in whole.items()]
    texts += [_array("const double", name, map(emit.number, values)) for name, values in numbers.items()]
    return "\n".join(texts)


def _directions(directions: Directions | None, table: Table) -> str:
    """How states, and of an uncertain model parameters, move along the directions, one direction after the other; where
    the nodes of a mixture lie beside the model.
    """
    sides = () if directions is None else directions.sides
    told = {"model_sides": [side.node for side in sides]}
    if directions is not None:
        told |= {
            "model_directions": directions.parameters.T.ravel().tolist(),
            "model_side_factors": [value for side in sides for value in side.factors.tolist()],
            "model_side_shifts": [value for side in sides for value in side.shifts.tolist()],
            "model_side_states": [value for side in sides for value in side.states.tolist()],
        }
    told["model_state_directions"] = [] if directions is None else directions.states.T.ravel().tolist()
    texts = [_array("const double", name, map(emit.number, values)) for name, values in told.items()]
    if directions is not None:
        texts.append(_array("const int", "model_deviating", [str(v.of) for v in table.of("deviation")]))
    return "\n".join(texts)


class _Preset(NamedTuple):
    """A value that an item of a choice gives a parameter: their positions, items count from 1."""

    choice: int
    item: int
    parameter: int
    value: float


def _presets(table: Table) -> list[_Preset]:
    place = {v.name: k for k, v in enumerate(table.of("parameter"))}
    return [
        _Preset(k, number, place[name], value)
        for k, v in enumerate(table.of("choice"))
        for number, item in enumerate(v.choice.items if v.choice else (), 1)
        for name, value in item.values.items()
    ]


def _beginnings(table: Table) -> dict[str, int]:
    """Where the choice how a run begins stands, and which of its items do what; -1 for what there is not."""
    found = [(k, v.choice) for k, v in enumerate(table.of("choice")) if v.choice and v.name == START]
    place, choice = found[0] if found else (-1, None)
    items = [item.name for item in choice.items] if choice else []
    numbers = {f"START_{name.upper()}": items.index(name) + 1 if name in items else -1 for name in (ROOM, STEADY)}
    room = next((v.reference for v in table if choice and v.name == choice.room), -1)
    return {"START": place, "ROOM_T": room, **numbers}


#: What stands as it is in no text of C.
_UNSAFE = re.compile(r'[^ -~]|["\\?]')


def _array(kind: str, name: str, values: Iterable[str]) -> str:
    rows = list(values) or ["0"]
    return f"static {kind} {name}[] = {{\n" + "".join(f"    {row},\n" for row in rows) + "};\n"


def _string(text: str) -> str:
    """A text as C has it: printable ASCII; the rest, quotes, backslashes and question marks (trigraphs) in octal."""
    octets = text.replace("\n", " ").encode(errors="backslashreplace").decode("latin-1")
    return '"' + _UNSAFE.sub(lambda found: f"\\{ord(found[0]):03o}", octets) + '"'


def headers_of_3() -> dict[str, str]:
    """Name and text of the standard's headers, unmodified."""
    folder = files("fmpy") / "c-code"
    return {name: (folder / name).read_text(encoding="utf-8") for name in _HEADERS_3}


def in_words_of_3(text: str) -> str:
    """The text of a file of the wrapper in the words of FMI 3.0; one that is of FMI 3.0 stays as it is."""
    text = _DEFINITION.sub(lambda found: f"static {found[1]} {_TABLES['inner'][found[2]]}(", text)
    for said, instead in _TABLES["said"].items():
        text = text.replace(said, instead)
    return re.sub(r"\bfmi2\w+", _word, text)


def _word(found: re.Match[str]) -> str:
    word = found[0]
    other = f"fmi3{word[4:]}".replace("FMUstate", "FMUState").replace("DeSerialize", "Deserialize")
    return str(_TABLES["words"].get(word, other))
