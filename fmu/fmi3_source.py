"""The C source of an FMU for FMI 3.0: the wrapper of FMI 2.0 in the words of 3.0, and what 3.0 has otherwise."""

from __future__ import annotations

import re
from importlib.resources import files

#: Before the source of a shared library, whose functions have the names of the standard.
OF_LIBRARY = "#define FMI3_OVERRIDE_FUNCTION_PREFIX\n"

#: The standard's headers; an importer that compiles the source brings its own.
_HEADERS = ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h")

WRAPPER = (
    "fmi3_callbacks.h",
    "instance.h",
    "fmi3_messages.c",
    "messages.c",
    "newton.c",
    "choices.c",
    "evaluate.c",
    "trial.c",
    "certain.c",
    "solver.c",
    "beginning.c",
    "fmi3_modes.c",
    "common.c",
    "states.c",
    "derivatives.c",
    "cosimulation.c",
    "exchange.c",
    "fmi3_life.c",
    "fmi3_values.c",
    "fmi3_absent.c",
)

#: Functions of FMI 2.0 that a function of 3.0 with other arguments calls, and what they are called there.
_INNER = {
    "fmi2Instantiate": "instantiate",
    "fmi2SetupExperiment": "set_up",
    "fmi2EnterInitializationMode": "enter_initialization",
    "fmi2ExitInitializationMode": "exit_initialization",
    "fmi2GetReal": "get_values",
    "fmi2SetReal": "set_values",
    "fmi2DoStep": "do_step",
    "fmi2GetDirectionalDerivative": "directional",
    "fmi2GetRealOutputDerivatives": "output_derivatives",
}
_DEFINITION = re.compile(rf"^(fmi2\w+) ({'|'.join(_INNER)})\(", re.MULTILINE)

#: Words of FMI 2.0 whose counterpart in 3.0 is more than another number.
_WORDS = {
    "fmi2CallbackFunctions": "Callbacks",
    "fmi2Type": "Interface",
    "fmi2ModelExchange": "MODEL_EXCHANGE",
    "fmi2CoSimulation": "CO_SIMULATION",
    "fmi2Component": "fmi3Instance",
    "fmi2Real": "fmi3Float64",
    "fmi2Integer": "fmi3Int32",
    "fmi2SetupExperiment": "fmi3EnterInitializationMode",
    "fmi2GetReal": "fmi3GetFloat64",
    "fmi2SetReal": "fmi3SetFloat64",
    "fmi2GetDerivatives": "fmi3GetContinuousStateDerivatives",
    "fmi2GetRealOutputDerivatives": "fmi3GetOutputDerivatives",
}
_SAID = {
    "wrong GUID": "wrong instantiation token",
    '"step complete"': '"step mode"',
    '"step failed"': '"step mode, the last step refused"',
}


def headers() -> dict[str, str]:
    """Name and text of the standard's headers, unmodified."""
    folder = files("fmpy") / "c-code"
    return {name: (folder / name).read_text(encoding="utf-8") for name in _HEADERS}


def included(name: str) -> str:
    """The beginning of the source: the standard's header, with names that no other FMU in a program has.

    Args:
        name: of the model, as an identifier
    """
    prefix = f"#ifndef FMI3_FUNCTION_PREFIX\n#define FMI3_FUNCTION_PREFIX {name}_\n#endif\n"
    return f'{prefix}#include "fmi3Functions.h"\n'


def in_words_of_3(text: str) -> str:
    """A file of the wrapper in the words of FMI 3.0.

    Args:
        text: of the file; one that is of FMI 3.0 stays as it is
    """
    text = _DEFINITION.sub(lambda found: f"static {found[1]} {_INNER[found[2]]}(", text)
    for said, instead in _SAID.items():
        text = text.replace(said, instead)
    return re.sub(r"\bfmi2\w+", _word, text)


def _word(found: re.Match[str]) -> str:
    word = found[0]
    return _WORDS.get(word) or f"fmi3{word[4:]}".replace("FMUstate", "FMUState").replace("DeSerialize", "Deserialize")
