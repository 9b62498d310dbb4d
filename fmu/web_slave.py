"""One instance of an FMU of FMI 3.0 in a plain module of WebAssembly, run by wasmtime, on any processor."""

from __future__ import annotations

import ctypes
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ..model.errors import FmuError
from .described import MODULE
from .slave import Slave, Slave3

#: Bytes of a value reference.
REFERENCE = 4
#: Bytes of a real number.
REAL = 8


class WebSlave(Slave):
    """An instance whose memory is the module's: what goes in and out is copied. It reaches nothing of the machine."""

    _setters = Slave3._setters

    def _open(self, arguments: dict[str, Any]) -> Any:
        if find_spec("wasmtime") is None:
            raise FmuError('wasmtime, which runs its module, is not installed. Run pip install "gearheat[wasm]".')
        import wasmtime

        self._store, self._held, self._room = wasmtime.Store(), 0, 0
        file = Path(arguments["unzipDirectory"], "binaries", MODULE, f"{arguments['modelIdentifier']}.wasm")
        module = wasmtime.Module.from_file(self._store.engine, str(file))
        self._traps = wasmtime.Trap
        self._c: Any = wasmtime.Instance(self._store, module, []).exports(self._store)
        self._c["_initialize"](self._store)
        kind = wasmtime.FuncType([wasmtime.ValType.i32()] * 4, [])
        logger = wasmtime.Func(self._store, kind, lambda _, status, __, text: self._heard(status, self._text(text)))
        heard = self._c["__indirect_function_table"].grow(self._store, 1, logger)
        texts = [f"{arguments[key]}\0".encode() for key in ("instanceName", "guid")]
        places = self._place(*texts)
        made = self._c["fmi3InstantiateCoSimulation"](self._store, *places, 0, 0, 1, 0, 0, 0, 0, 0, heard, 0)
        if not made:
            raise FmuError(self.said() or "it makes no instance")
        self._instance = made
        return self

    def freeInstance(self) -> None:
        """End the instance, under the name that FMPy's have."""
        self._c["fmi3FreeInstance"](self._store, self._instance)

    def _bind(self, description: Any) -> None:
        self.initialized, self.reset = (self._function(f"fmi3{n}") for n in ("ExitInitializationMode", "Reset"))
        enter, do_step = self._function("fmi3EnterInitializationMode"), self._function("fmi3DoStep")
        self.begin = lambda tolerance, start, stop: enter(tolerance is not None, tolerance or 0.0, start, True, stop)
        set_values, get_values = (self._function(f"fmi3{verb}Float64") for verb in ("Set", "Get"))

        def put(references: int, n: int, values: int) -> None:
            held = ctypes.string_at(references, REFERENCE * n), ctypes.string_at(values, REAL * n)
            named, given = self._place(*held)
            set_values(named, n, given, n)

        def get(references: int, n: int, values: int) -> None:
            named, read = self._place(ctypes.string_at(references, REFERENCE * n), bytes(REAL * n))
            get_values(named, n, read, n)
            ctypes.memmove(values, bytes(self._c["memory"].read(self._store, read, read + REAL * n)), REAL * n)

        def step(time: float, length: float) -> None:
            flags, reached = self._place(bytes(REAL), bytes(REAL))
            do_step(time, length, True, flags, flags + 1, flags + 2, reached)

        self.set, self.get, self.step = put, get, step

    def _hand(self, name: str, references: np.ndarray, values: np.ndarray) -> None:
        named, given = self._place(references.tobytes(), values.tobytes())
        self._function(name)(named, len(references), given, len(references))

    def _place(self, *parts: bytes) -> list[int]:
        """Addresses of parts in the memory of the module, from one call to the next."""
        sizes = [-(-len(part) // REAL) * REAL for part in parts]
        if sum(sizes) > self._room:
            self._c["free"](self._store, self._held)
            self._room = sum(sizes)
            self._held = self._c["malloc"](self._store, self._room)
        places = [self._held + sum(sizes[:k]) for k in range(len(parts))]
        for part, place in zip(parts, places, strict=True):
            self._c["memory"].write(self._store, part, place)
        return places

    def _text(self, place: int) -> bytes:
        """A text of the module."""
        memory = self._c["memory"]
        return bytes(memory.read(self._store, place, memory.data_len(self._store))).partition(b"\0")[0]

    def _function(self, name: str, *types: Any) -> Any:
        raw = self._c[name]

        def call(*arguments: Any) -> None:
            try:
                status = raw(self._store, self._instance, *arguments)
            except self._traps as error:
                raise FmuError(f"{self._name}: the module of WebAssembly has stopped in {name} ({error}).") from error
            if status > 1:
                raise FmuError(f"{self._name}: {self.said() or name + ' failed.'}")

        return call
