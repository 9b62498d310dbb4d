"""Hide effects in campaigns of several rigs, diagnose them and print a table.

PYTHONPATH=tests python -m diagnose.hidden.run single [RIG [CASE]]   # every cause, alone
PYTHONPATH=tests python -m diagnose.hidden.run clean [RIG]           # 20 campaigns without a fault
PYTHONPATH=tests python -m diagnose.hidden.run gross                 # one wrong reading beside a cause
PYTHONPATH=tests python -m diagnose.hidden.run stable                # 30 campaigns, five seeds each
"""

import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from diagnose.hidden.benches import BENCHES
from diagnose.hidden.cases import GROSS, HIDDEN, STABLE
from diagnose.hidden.loudness import signal_to_noise
from diagnose.hidden.maker import Case, Gross, make
from diagnose.hidden.score import Score, score
from gearheat.model.errors import GearheatError

#: Seed of the campaigns with a cause, and of the first clean one.
SEED, CLEAN = 7, 1000
#: Seeds of the diagnosis.
SEEDS = range(5)


def hidden(rig: str, name: str, seed: int = SEED, gross: Gross | None = None) -> Case:
    """A campaign with a case of `HIDDEN` in it, none for ""; in a folder of its own."""
    effects = [HIDDEN[rig][name]] if name else []
    return make(BENCHES[rig], effects, seed, Path(tempfile.mkdtemp(prefix="gearheat_hidden_")), gross)


def told(label: str, case: Case, seed: int = 0) -> Score | None:
    """Print the answer to a campaign; None where the diagnosis refuses it."""
    try:
        answer = score(case, seed)
    except GearheatError as error:
        print(f"{label:48} REFUSED {error}", flush=True)
        return None
    print(f"{label:48} {answer.line}", flush=True)
    return answer


def single(rigs: Iterable[str], names: Iterable[str] = ()) -> None:
    """Every cause alone."""
    scores = []
    for rig in rigs:
        for name in names or HIDDEN[rig]:
            loud = signal_to_noise(BENCHES[rig], [HIDDEN[rig][name]])
            scores.append(told(f"{rig} {name} ({HIDDEN[rig][name].cause}, {loud:.1f})", hidden(rig, name)))
    count(scores)


def count(scores: Iterable[Score | None]) -> None:
    """How many are right."""
    known = [s for s in scores if s]
    first, held, alarms = (sum(getattr(s, key) for s in known) for key in ("found", "held", "alarm"))
    seconds = sorted(s.seconds for s in known)
    median = seconds[len(seconds) // 2] if seconds else 0.0
    print(f"{len(known)} campaigns: {first} first, {held} in the set, {alarms} alarms, median {median:.1f} s")


def clean(rigs: Iterable[str], n: int = 20) -> None:
    """Campaigns without a fault."""
    for rig in rigs:
        count([told(f"{rig} clean {seed}", hidden(rig, "", seed)) for seed in range(CLEAN, CLEAN + n)])


def gross() -> None:
    """One wrong reading beside a cause."""
    named, scores = 0, []
    for rig, name, reading in GROSS:
        answer = told(f"{rig} {name}, row {reading.row + 1} {reading.sensor}", hidden(rig, name, gross=reading))
        named += answer is not None and (reading.row + 1, reading.sensor) in answer.gross
        scores.append(answer)
    count(scores)
    print(f"{named} of {len(GROSS)} readings named")


def stable() -> None:
    """The same campaign with several seeds of the diagnosis: one first name, or a set."""
    steady = 0
    for rig, name, seed in STABLE:
        case = hidden(rig, name, seed)
        answers = [a for s in SEEDS if (a := told(f"{rig} {name or 'clean'}, seed {s}", case, s))]
        steady += len({a.first for a in answers}) == 1 or all(a.size > 1 for a in answers)
    print(f"{steady} of {len(STABLE)} with one first name or a set")


def main(arguments: list[str]) -> None:
    """Run what is asked for."""
    what, *rest = arguments or ["single"]
    rigs: Iterator[str] | list[str] = [rest[0]] if rest else list(HIDDEN)
    if what == "single":
        single(rigs, rest[1:])
    elif what == "clean":
        clean([rest[0]] if rest else ["helical"])
    elif what == "gross":
        gross()
    elif what == "stable":
        stable()
    else:
        sys.exit(f'unknown "{what}". {__doc__}')


if __name__ == "__main__":
    main(sys.argv[1:])
