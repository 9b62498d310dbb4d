"""`gearheat campaign`: a campaign that others published, from downloaded files to its diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...model.errors import ScenarioError
from ...scenarios.measured.adapter import Adapter, adapter, write_csv
from ..diagnose.api import Diagnosis, diagnose
from ..show.console import folder as make_folder, write
from ..show.display import Display


@dataclass(frozen=True, eq=False, repr=False)
class CampaignFiles(Display):
    """The cases of a published campaign as files that `gearheat diagnose` takes.

    Attributes:
        adapter: the table of the campaign
        card: its card
        cases: name of a case -> its files: the one asked, the reference (None without one), siblings
    """

    adapter: Adapter
    card: Path
    cases: dict[str, tuple[Path | None, ...]] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """What it is."""
        return f"{self.adapter.name}: {self.adapter.table['title']}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Files by case."""
        return ("case", "asked", "reference", "siblings"), [
            (name, asked, healthy, ", ".join(siblings))
            for name, paths in self.cases.items()
            for asked, healthy, *siblings in [[path.name if path else "none" for path in paths]]
        ]

    def as_dict(self) -> dict[str, Any]:
        """What is known of it, and its files."""
        known = {key: self.adapter.table[key] for key in ("title", "source", "licence", "known", "rig")}
        return {**known, "cases": {name: [str(p) for p in paths if p] for name, paths in self.cases.items()}}

    def diagnose(self, case: str, *, quick: bool = False, seed: int = 0) -> Diagnosis:
        """Diagnose a case.

        Args:
            case: its name
            quick: without gain on readings left out and without next experiments
            seed: of everything that is drawn
        """
        asked, healthy, *siblings = self.cases[case]
        rig = self.adapter.rig
        given: dict[str, Any] = {"card": self.card, "quick": quick, "seed": seed}
        if self.adapter.logs:
            return diagnose(
                None, rig, logs=asked, reference_logs=healthy, sibling_logs=[p for p in siblings if p], **given
            )
        return diagnose(asked, rig, reference=healthy, **given)


def campaign(name: str, folder: str | Path, out: str | Path, *, case: str = "") -> CampaignFiles:
    """Card and tables of a campaign that others published, from the files that a user downloaded.

    Args:
        name: of the campaign: dynamometer, edp, hydraulic, kelmarsh, pronostia or wind_turbine
        folder: with the downloaded files
        out: folder for card and tables
        case: only this one

    Raises:
        GearheatError: files or columns are missing, or there is no such campaign or case

    Example:
        >>> import gearheat as gh
        >>> made = gh.campaign("kelmarsh", "downloads", "kelmarsh")  # doctest: +SKIP
        >>> made.diagnose("turbine 1").verdict  # doctest: +SKIP
    """
    known = adapter(name)
    if not Path(folder).is_dir():
        raise ScenarioError(f"campaign {name}: {folder} is no folder. Give the one with the downloaded files.")
    found, place = known.cases(Path(folder), case), make_folder(Path(out))
    write(place / "card.toml", known.table["card"])
    files: dict[str, tuple[Path | None, ...]] = {}
    for one in found:
        stem = "".join(c if c.isalnum() else "_" for c in one.name).strip("_")
        parts = {"": one.asked, "_reference": one.reference}
        parts |= {f"_sibling_{k}": rows for k, rows in enumerate(one.siblings, 1)}
        files[one.name] = tuple(place / f"{stem}{ending}.csv" if rows else None for ending, rows in parts.items())
        for path, rows in zip(files[one.name], parts.values(), strict=True):
            if path:
                write_csv(path, rows)
    return CampaignFiles(known, place / "card.toml", files)
