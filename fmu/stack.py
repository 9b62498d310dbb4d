"""How much stack a function of a C source needs at most, by the compiler's own frames and who calls whom."""

from __future__ import annotations

import re
from functools import cache

from .compiling import compile_told

#: What a call needs beside the frame of the function: its return address, kept aligned [bytes].
CALL = 16
#: What a function that calls none may use below its frame [bytes] (System V ABI of x86-64, section 3.2.2).
RED_ZONE = 128
_QUIET = re.compile(r'/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', re.DOTALL)
_HEAD = re.compile(r"^\w[\w *]*?(\w+)\([^;{}]*\)\n\{", re.MULTILINE)
_FRAME = re.compile(r"stack frame size \((\d+)\).* in '(\w+)'")


def deepest_stack(source: str, root: str, headers: dict[str, str] | None = None) -> int:
    """Bytes of stack below a call of a function, on this machine's processor.

    A function that the compiler has put into its caller has no frame. Not counted is what the C library needs, and the
    importer's own function for messages.

    Args:
        source: the C text; none of its functions calls itself
        root: name of the function
        headers: name -> text of files beside it

    Raises:
        FmuError: the compiler fails
    """
    frames = {name: int(size) for size, name in _FRAME.findall(compile_told(source, headers or {}))}
    text = _QUIET.sub("", source)
    heads = list(_HEAD.finditer(text))
    ends = [*(head.start() for head in heads[1:]), len(text)]
    words = {h[1]: set(re.findall(r"\b(\w+)\(", text[h.end() : end])) for h, end in zip(heads, ends, strict=True)}

    @cache
    def below(name: str) -> int:
        return (
            frames.get(name, 0) + CALL + max((below(called) for called in words[name] & words.keys()), default=RED_ZONE)
        )

    return below(root)
