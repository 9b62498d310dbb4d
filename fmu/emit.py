"""A scalar CasADi function as straight-line C over plain arrays: one function, or some pieces of a long one."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import casadi as ca

from ..model.errors import FmuError
from .fixed import tables, wrapper

#: Statements up to which a function stays whole. The work of a compiler on one function grows faster than its length,
#: above all the search for operations that vector instructions can do at once.
WHOLE = 15_000
#: Statements of each piece of a longer function.
PIECE = 250
_FUNCTION_CALL = re.compile(r"^(?=[a-z])")


def _by_code(operations: Mapping[str, str]) -> dict[int, str]:
    return {getattr(ca, f"OP_{name}"): text for name, text in operations.items() if hasattr(ca, f"OP_{name}")}


@cache
def _texts(kind: str) -> tuple[str, dict[int, str]]:
    """For a type of numbers the text of a constant, and of each operation by code."""
    own: dict[str, str] = tables("operations")["double"]
    if kind == "double":
        return "{0}", _by_code(own)
    calls = {name: _FUNCTION_CALL.sub("lanes_", text) for name, text in own.items()}
    return "lanes_all({0})", _by_code(calls | tables("operations")["lanes"])


def number(value: float) -> str:
    """A double as a C literal that reads back as the same double."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    text = repr(float(value))
    return f"({text})" if text.startswith("-") else text


class _Instruction(NamedTuple):
    """One operation of a function: its code, the work variables it reads and those it sets.

    Of an argument the former, of a result the latter are the number of its array and the place in it.
    """

    code: int
    inputs: list[int]
    outputs: list[int]


class _Line(NamedTuple):
    """One statement: its text, the local variable it sets, and what it reads (variables and arguments)."""

    text: str
    sets: str
    reads: tuple[str, ...]


def function(f: Any, prefix: str = "model_", kind: str = "double", whole: int = WHOLE, piece: int = PIECE) -> str:
    """The C text of an SX function: static void prefix+name(const kind *in..., kind *out...).

    A long one calls its pieces one after the other, which compute the same numbers in the same order.

    Args:
        f: the function
        prefix: what its name in C begins with
        kind: type of its numbers: double, or lanes for some rows side by side by wrapper/lanes.h
        whole: statements up to which it stays one function
        piece: statements of a piece of a longer one

    Raises:
        FmuError: an operation has no C text
    """
    takes = [f"const {kind} *{f.name_in(i)}" for i in range(f.n_in())]
    gives = [f"{kind} *{f.name_out(i)}" for i in range(f.n_out())]
    arguments = [f.name_in(i) for i in range(f.n_in())] + [f.name_out(i) for i in range(f.n_out())]
    program = _read(f)
    shared, powers = _share_divisors(program), _neighbouring_powers(f, program)
    lines = list(_write(f, program, shared, powers, kind))
    name, signature = f"{prefix}{f.name()}", ", ".join(takes + gives)
    if len(lines) > whole:
        return _in_pieces(name, signature, arguments, lines, kind, piece)
    names = [f"a{i}" for i in range(f.sz_w())] + [name for name, first in (*shared.values(), *powers.values()) if first]
    used = {word for line in lines for word in line.reads}
    return _define_function(f"{name}({signature})", kind, names, [a for a in arguments if a not in used], lines)


def _define_function(head: str, kind: str, names: Sequence[str], unused: Sequence[str], lines: Sequence[_Line]) -> str:
    """A C function with its local variables; what it does not use of its arguments is said."""
    declared = [f"  {kind} " + ", ".join(names[k : k + 20]) + ";" for k in range(0, len(names), 20)]
    said = [f"  (void){name};" for name in unused]
    return "\n".join([f"static void {head}", "{", *declared, *said, *(line.text for line in lines), "}", ""])


def _in_pieces(
    name: str, signature: str, arguments: Sequence[str], lines: Sequence[_Line], kind: str, piece: int
) -> str:
    """A function that calls its pieces; an array holds the values that one piece hands to a later one."""
    pieces = [lines[k : k + piece] for k in range(0, len(lines), piece)]
    taken, handed = _crossing(pieces, set(arguments))
    place = {variable: k for k, variable in enumerate(sorted(set().union(*taken)))}
    texts, calls = [wrapper("apart.h")], []
    for k, inner in enumerate(pieces):
        body = _with_transfers(inner, taken[k], handed[k], place)
        used = {word for line in body for word in line.reads}
        unused = [argument for argument in (*arguments, "w") if argument not in used]
        names = list(dict.fromkeys(line.sets for line in body if line.sets))
        texts.append("APART " + _define_function(f"{name}_{k}({signature}, {kind} *w)", kind, names, unused, body))
        calls.append(_Line(f"  {name}_{k}({', '.join([*arguments, 'w'])});", "", ()))
    return "\n".join([*texts, _define_function(f"{name}({signature})", kind, [f"w[{max(len(place), 1)}]"], [], calls)])


def _with_transfers(lines: Sequence[_Line], taken: set[str], handed: set[str], place: Mapping[str, int]) -> list[_Line]:
    """A piece that takes each value where it is first needed and hands it on where it is last set.

    At its beginning and end instead, a register or a second place in memory would hold each value all the time.
    """
    last = {line.sets: k for k, line in enumerate(lines)}
    left, body = set(taken), []
    for k, line in enumerate(lines):
        for v in dict.fromkeys(line.reads):
            if v in left:
                left.discard(v)
                body.append(_Line(f"  {v}=w[{place[v]}];", v, ("w",)))
        body.append(line)
        if line.sets in handed and last[line.sets] == k:
            body.append(_Line(f"  w[{place[line.sets]}]={line.sets};", "", (line.sets, "w")))
    return body


def _crossing(pieces: Sequence[Sequence[_Line]], arguments: set[str]) -> tuple[list[set[str]], list[set[str]]]:
    """Of each piece the variables it needs from pieces before it, and those it has to hand to later ones."""
    taken, sets = [], []
    for lines in pieces:
        needed: set[str] = set()
        known: set[str] = set()
        for line in lines:
            needed |= {word for word in line.reads if word not in known and word not in arguments}
            known |= {line.sets} - {""}
        taken.append(needed)
        sets.append(known)
    handed: list[set[str]] = []
    wanted: set[str] = set()  # by the pieces behind
    for needed, known in zip(reversed(taken), reversed(sets), strict=True):
        handed.append(known & wanted)
        wanted = (wanted - known) | needed
    return taken, handed[::-1]


def _read(f: Any) -> list[_Instruction]:
    """The instructions of a function; each is asked for once, as asking takes most of the time of emitting."""
    numbers = range(f.n_instructions())
    return [_Instruction(f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)) for k in numbers]


def _share_divisors(program: Sequence[_Instruction]) -> dict[int, tuple[str, bool]]:
    """Division -> name of the reciprocal it multiplies by, and whether it is the first to use it.

    Only where several divide by the same value: derivatives repeat their function's divisors, and a division costs as
    much as several products.
    """
    users: dict[int, list[int]] = {}
    for k, (_, divisor) in _operands(program, ca.OP_DIV):
        users.setdefault(divisor, []).append(k)
    groups = [group for group in users.values() if len(group) > 1]
    return {k: (f"r{i}", k == group[0]) for i, group in enumerate(groups) for k in group}


def _neighbouring_powers(f: Any, program: Sequence[_Instruction]) -> dict[int, tuple[str, bool]]:
    """Power -> name of one of the same value with an exponent larger by 1, and whether it is that one.

    The derivative of a power of less than 1 is a quotient of it, which costs a tenth of another power.
    """
    known: dict[int, list[tuple[float, int]]] = {}
    found: dict[int, tuple[str, bool]] = {}
    for k, (base, at) in _operands(program, ca.OP_CONSTPOW):
        exponent, own = f.instruction_constant(at), known.setdefault(base, [])
        above = next((j for e, j in own if exponent < 0 and abs(e - exponent - 1) < 1e-12 and j not in found), None)
        if above is not None:
            found |= {above: (f"q{above}", True), k: (f"q{above}", False)}
        own.append((exponent, k))
    return found


def _operands(program: Sequence[_Instruction], kind: int) -> Iterator[tuple[int, list[int]]]:
    """Instructions of a kind, each with those that made its operands: a work variable holds one value after another."""
    made: dict[int, int] = {}
    for k, (code, inputs, outputs) in enumerate(program):
        if code == kind:
            yield k, [made[v] for v in inputs]
        if code != ca.OP_OUTPUT:
            made[outputs[0]] = k


def _write(
    f: Any,
    program: Sequence[_Instruction],
    shared: Mapping[int, tuple[str, bool]],
    powers: Mapping[int, tuple[str, bool]],
    kind: str,
) -> Iterator[_Line]:
    """The statements of all instructions."""
    constant, texts = _texts(kind)
    takes, gives = f.name_in(), f.name_out()
    for k, (code, inputs, outputs) in enumerate(program):
        if code == ca.OP_OUTPUT:
            array, value = gives[outputs[0]], f"a{inputs[0]}"
            yield _Line(f"  {array}[{outputs[1]}]={value};", "", (array, value))
            continue
        target = f"a{outputs[0]}"
        if code == ca.OP_CONST:
            yield _Line(f"  {target}={constant.format(number(f.instruction_constant(k)))};", target, ())
            continue
        if code == ca.OP_INPUT:
            array = takes[inputs[0]]
            yield _Line(f"  {target}={array}[{inputs[1]}];", target, (array,))
            continue
        if code not in texts:
            raise FmuError(f"{f.name()}: CasADi operation {code} has no counterpart in C.")
        read = tuple([f"a{i}" for i in inputs])
        if k in shared:
            name, first = shared[k]
            if first:
                yield _Line(f"  {name}=1/{read[1]};", name, read[1:])
            yield _Line(f"  {target}={read[0]}*{name};", target, (read[0], name))
            continue
        text = texts[code].format(*read)
        if k in powers:
            name, first = powers[k]
            if first:
                yield _Line(f"  {name}={text};", name, read)
                yield _Line(f"  {target}={name};", target, (name,))
                continue
            text, read = f"{name}/{read[0]}", (name, read[0])
        yield _Line(f"  {target}={text};", target, read)
