"""What the model gets wrong in measured data, and which experiment would tell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import gearheat as gh
import typer

from ..show import console
from .options import Everything, Json

Card = Annotated[Path | None, typer.Option(help="Accuracies, priors and protocol: TOML or JSON, see `gearheat card`.")]
Libraries = Annotated[
    list[Path] | None,
    typer.Option("--library", metavar="FILE", help="Python file with causes of your own. Repeatable."),
]


def _logs(text: str) -> Any:
    return typer.Option(metavar="FILE", help=f"{text} CSV, CSV.gz or Parquet. Repeatable.")


def diagnose(
    rig: Annotated[str, typer.Option(help="Name of a shipped rig, or path of a rig file.")],
    data: Annotated[Path | None, typer.Argument(help="Measured readings: CSV, one row per reading.")] = None,
    card: Card = None,
    logs: Annotated[list[Path] | None, _logs("Logged samples of the machine.")] = None,
    reference: Annotated[Path | None, typer.Option(help="Readings of the same rig when healthy: CSV as DATA.")] = None,
    series: Annotated[
        Path | None, typer.Option(help="Logged courses of the tests of DATA: CSV, one row a sample.")
    ] = None,
    reference_series: Annotated[Path | None, typer.Option(help="Logged courses of the reference's tests.")] = None,
    reference_logs: Annotated[list[Path] | None, _logs("Logs of the same machine when healthy.")] = None,
    sibling_logs: Annotated[list[Path] | None, _logs("Logs of other machines of its type.")] = None,
    library: Libraries = None,
    predict: Annotated[Path | None, typer.Option(help="Points whose readings are predicted: CSV.")] = None,
    predictions: Annotated[Path | None, typer.Option(help="CSV to write with the predictions.")] = None,
    causes: Annotated[int, typer.Option(help="Largest number of simultaneous causes.")] = 8,
    alpha: Annotated[float, typer.Option(help="Accepted rate of false alarms.")] = 0.05,
    seed: Annotated[int, typer.Option(help="The same seed gives the same result.")] = 0,
    quick: Annotated[
        bool, typer.Option("--quick", help="Without gain on readings left out, and without next experiments.")
    ] = False,
    everything: Everything = False,
    json: Json = None,
    report: Annotated[Path | None, typer.Option(help="HTML page to write.")] = None,
    extended: Annotated[Path | None, typer.Option(help="Rig file to write: the rig with what was found.")] = None,
) -> None:
    """What the model gets wrong in measured data: causes by name, size and certainty, and what to measure next."""
    console.use_one_thread()
    outputs = gh.Outputs(predictions, json, report, extended)
    findings = gh.diagnose(
        data,
        rig,
        card=card,
        logs=logs,
        reference=reference,
        reference_logs=reference_logs,
        sibling_logs=sibling_logs,
        library=library,
        predict=predict,
        causes=causes,
        quick=quick,
        alpha=alpha,
        seed=seed,
        series=series,
        reference_series=reference_series,
        outputs=outputs,
    )
    findings.write(outputs)
    if json == "-":
        print(console.as_json(findings.as_dict()), end="")
    else:
        print(findings.text(everything=everything, width=console.screen_width()), end="")


def plan(
    rig: Annotated[str, typer.Argument(help="Name of a shipped rig, or path of a rig file.")],
    separate: Annotated[
        str, typer.Option(metavar="CAUSE,CAUSE...", help="Causes to tell apart; a table of all causes if left out.")
    ] = "",
    card: Card = None,
    points: Annotated[
        Path | None, typer.Option(help="Points of the campaign there is or will be: CSV. The rig's own if left out.")
    ] = None,
    reference: Annotated[
        bool, typer.Option("--reference", help="There is a healthy campaign of the same points as well.")
    ] = False,
    library: Libraries = None,
    everything: Everything = False,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Picture to write, .png or .svg.")] = None,
    json: Json = None,
) -> None:
    """Which causes a campaign can tell apart on a rig, and which experiments would, before anything is measured."""
    console.use_one_thread()
    causes = [name for name in map(str.strip, separate.split(",")) if name]
    found = gh.plan(
        rig, separate=causes, card=card, points=points, library=library, reference=reference, json=json, out=out
    )
    if out is not None:
        found.save_picture(out)
    if (path := console.file_of(json)) is not None:
        found.save(path)
    if json == "-":
        print(console.as_json(found.as_dict()), end="")
    else:
        print(found.text(everything=everything, width=console.screen_width()), end="")


def card(
    rig: Annotated[str, typer.Argument(help="Name of a shipped rig, or path of a rig file.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Card to write, .toml or .json; stdout without.")
    ] = None,
    json: Json = None,
) -> None:
    """A card for the campaigns of a rig: every key with its default and what it means."""
    found = gh.card(rig)
    if out is not None:
        found.save(out)
        console.note(f"wrote {out}")
    if json is not None or out is None:
        console.answer(found.as_dict(), json, lambda: print(found.as_toml(), end=""))
