"""Campaigns in folders with their keys: a folder a case, or a folder of such folders.

A case is `data.csv`, `card.json`, `key.json` and optionally `reference.csv` and `points.csv`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearheat.model.errors import DataError

from .classes import classes_of

#: Files of a campaign by what they are: of one in a folder, and of one that the bench made.
FILES: Mapping[str, tuple[str, str]] = {
    "data": ("data.csv", "DATA.csv"),
    "card": ("card.json", "CARD.json"),
    "reference": ("reference.csv", "REF.csv"),
    "points": ("points.csv", "POINTS.csv"),
    "log": ("log.csv", "LOG.csv"),
    "reference_log": ("reference_log.csv", "REFLOG.csv"),
}

#: Kinds of the keys, as the bench names them.
KINDS = {"none": "clean", "unknown": "outside"}


def folders(path: Path) -> list[Path]:
    """The cases of a folder, by name.

    Raises:
        DataError: there are none
    """
    cases = [path] if (path / "key.json").exists() else sorted(p.parent for p in path.glob("*/key.json"))
    if not cases:
        raise DataError(f"{path}: no campaigns. Expected folders with data.csv, card.json and key.json.")
    return cases


def files(folder: Path, made: bool = False) -> dict[str, Path]:
    """Files of a case that exist, by what they are; `made` by the bench."""
    paths = {what: folder / names[made] for what, names in FILES.items()}
    return {what: path for what, path in paths.items() if path.exists()}


def truth(folder: Path) -> dict[str, Any]:
    """The key of a case as the bench writes truths.

    Raises:
        DataError: the key or the card cannot be read
    """
    try:
        key, card = (json.loads((folder / name).read_text(encoding="utf-8")) for name in ("key.json", "card.json"))
        sd = {c: float(entry["repeat_sd"]) for c, entry in card["channels"].items()}
        near = min(key["rivals"].items(), key=lambda item: item[1], default=None)
        gross = key.get("roughened", {}).get("data")
        return {
            "case": folder.name,
            "kind": KINDS.get(key["kind"], key["kind"]),
            "answer": sorted(classes_of(key["truth"])),
            "fair": sorted(classes_of(key.get("fair", ()))),
            "effects": [{"snr": key["snr"]}] if key["truth"] else [],
            "rival": {"cause": near[0], "distance": near[1]} if near else None,
            "impact": key["impact"],
            "repeat_sd": {
                "T_oil_K": sd["T_oil_C"],
                "T_wall_K": sd["T_wall_C"],
                "loss_Nm": (sd["T_carrier_Nm"] ** 2 + 16 * sd["T_sun_Nm"] ** 2) ** 0.5,
            },
            "points": key["holdout"],
            "gross": {"DATA": {"row": _row(folder, gross["point"]), **gross}} if gross else {},
        }
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(f"{folder}: its key cannot be read ({type(error).__name__}: {error})") from None


def _row(folder: Path, point: int) -> int:
    """Row of a point in the data, from 1."""
    lines = (folder / "data.csv").read_text(encoding="utf-8").splitlines()[1:]
    return [int(line.split(",")[0]) for line in lines].index(point) + 1
