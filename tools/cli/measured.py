"""Measured readings and logs beside the model."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import gearheat as gh

from ...model.errors import ScenarioError
from ..show import console, event_lines
from ..show.notes import print_outside, print_unchecked

#: Rows of the table of contacts for people; programs get all.
CONTACTS = 19


def run(
    rig: str,
    out: Path = Path("out"),
    tests: str | None = None,
    step: str = "60 s",
    set_: list[str] | None = None,
    jobs: int = 0,
    extended: Path | None = None,
    data: Path | None = None,
    card: Path | None = None,
    live: Path | None = None,
    json: str | None = None,
) -> None:
    """The main job: export the FMU, play all measured tests, compare, report."""
    console.writable(live)
    done = gh.run(rig, out, tests=tests, step=step, set=set_ or [], jobs=jobs, extended=extended, data=data, card=card)
    if live is not None:
        gh.page(rig, set=set_ or [], extended=[extended] if extended else ()).save(live, report=out / "report.html")
    console.answer(done.as_dict(), json, lambda: print_run(done))


def losses(
    rig: str,
    data: Path | None = None,
    card: Path | None = None,
    temperature: Literal["measured", "model"] = "measured",
    power_flow: Literal["ideal", "successive"] | None = None,
    contacts: bool = False,
    method: Literal["iso14179-1", "iso14179-2"] | None = None,
    limit: str | None = None,
    k: str | None = None,
    dip: list[str] | None = None,
    set_: list[str] | None = None,
    json: str | None = None,
) -> None:
    """Loss of every part at each measured reading, or beside those of a reference method."""
    if method is not None:
        _refuse({"--data": data, "--card": card, "--power-flow": power_flow, "--contacts": contacts}, method)
        rated = gh.rate_by_method(rig, method, limit=limit or "95 degC", k=k, dip=dip or [], set=set_ or [])
        console.answer(rated.as_dict(), json, lambda: _print_method(rated))
        return
    _refuse({"--limit": limit, "--k": k, "--dip": dip}, None)
    table = gh.losses(
        rig,
        data=data,
        card=card,
        temperature=temperature,
        power_flow=power_flow,
        contacts=contacts,
        set=set_ or [],
    )
    console.answer(table.as_dict(), json, lambda: _print_losses(table))


def compare(
    result: Path,
    data: Path,
    rig: str,
    card: Path | None = None,
    json: str | None = None,
) -> None:
    """Errors of simulated readings by group, with the noise floor and statistical rivals."""
    errors = gh.compare(result, data, rig, card=card)
    console.answer(errors.as_dict(), json, lambda: print_errors(errors))


def calibrate(
    rig: str,
    free: list[str],
    grid: str | None = None,
    data: Path | None = None,
    card: Path | None = None,
    bounds: list[str] | None = None,
    set_: list[str] | None = None,
    json: str | None = None,
) -> None:
    """Fit parameters to the measured oil temperatures of a table, or of one of its grids."""
    fit = gh.calibrate(rig, free, grid=grid, bounds=bounds or [], set=set_ or [], data=data, card=card)
    console.answer(fit.as_dict(), json, lambda: print_calibration(fit))


def replay(
    rig: str,
    fit: Path,
    until: int | None = None,
    logs: list[Path] | None = None,
    card: Path | None = None,
    out: Path | None = None,
    json: str | None = None,
) -> None:
    """How well a rig predicts logs without correction, beside a one-node model, a regression and the last reading."""
    console.plottable(out, "--out")
    found = gh.replay(rig, fit, until=until, logs=logs or [], card=card)
    if out is not None:
        found.save_picture(out)
    console.answer(found.as_dict(), json, lambda: print_replays(found))


def watch(
    rig: str,
    source: str,
    card: Path | None = None,
    reference_logs: list[Path] | None = None,
    sibling_logs: list[Path] | None = None,
    state: Path | None = None,
    every: int = 250,
    once: bool = False,
    alpha: float = 0.01,
    page: Path | None = None,
    publish: str = "",
    scheduler: str | None = None,
    json: str | None = None,
) -> None:
    """Follow logs while they grow: predicted temperatures, whether something has changed, what, and since when."""
    with event_lines.opened(json) as out:
        events = gh.watch(
            rig,
            source,
            card=card,
            reference_logs=reference_logs or (),
            sibling_logs=sibling_logs or (),
            state=state,
            every=every,
            once=once,
            alpha=alpha,
            page=page,
            publish=publish,
            after=out.last,
            scheduler=scheduler,
        )
        for event in events:
            out.write(event)


def _refuse(options: Mapping[str, object], method: str | None) -> None:
    """Refuse options that belong to the other kind of losses."""
    wrong = [name for name, value in options.items() if value]
    if wrong and method is None:
        raise ScenarioError(f"{', '.join(wrong)} belongs to --method. Add --method iso14179-1, or leave it out.")
    if wrong:
        raise ScenarioError(f"{', '.join(wrong)} does not go with --method. Leave out one of them.")


def print_errors(errors: gh.Errors) -> None:
    """Print the tables of errors of a run or of a comparison."""
    console.table("Errors", *errors.table())
    console.table("Errors by group, simulated minus measured", *errors.groups())


def print_run(done: gh.CampaignRun) -> None:
    """Print errors, or the one point there is."""
    if done.comparison is None:
        console.table(done.title, *done.table())
    else:
        print_errors(done)
    print_unchecked(done.found["unchecked"])
    closed = f"energy balance closed within {done.found['energy_residual_max']:.1e} of the throughput"
    console.say(f"{len(done.rows)} reading{'s' * (len(done.rows) > 1)}; {closed}")


def _print_losses(table: gh.LossTable) -> None:
    console.table(table.title, *table.table())
    if (contacts := table.contacts) is not None:
        columns = list(contacts.columns)
        every = max(1, (len(contacts.rows) - 1) // (CONTACTS - 1))
        rows = [[row[c] for c in columns] for row in contacts.rows[::every]]
        console.table(f"{table.found['rig']}: contacts over a mesh cycle", columns, rows)
        for column, meaning in contacts.columns.items():
            console.say(f"{column}: {meaning}")
        for key, value in contacts.totals.items():
            console.say(f"{key}: {value:.6g}")
    print_outside(table.found.get("outside", ()))


def _print_method(rated: gh.MethodRating) -> None:
    found = rated.found
    console.table(rated.title, *rated.table())
    if found["T_sump_C"] is None:
        print("sump: the losses never equal the heat that leaves")
    else:
        print(f"sump by {rated.method}: {found['T_sump_C']:.1f} degC with {found['conductance_W_K']:.1f} W/K")
    rating = found["rating"]
    power = "none" if rating["power_W"] is None else f"{rating['power_W'] / 1000:.3g} kW at the input"
    why = f" ({rating['why']})" if rating["why"] else f", {rating['load_share']:.3g} times the load"
    print(f"thermal rating at {rating['limit_C']:.1f} degC: {power}{why}")
    for u in found["not_treated"]:
        print(f"not treated: {u['part']} ({u['type']}): {u['why']}; in the model {u['power']:.4g} W")
    print_outside(found["outside"])
    for assumption in found["assumptions"]:
        print(f"assumed: {assumption}")


def print_calibration(fit: gh.Calibration) -> None:
    """Print fitted values."""
    found = fit.found
    console.table(fit.title, *fit.table())
    body = [[n, *line.values()] for n, line in found["correlation"].items()]
    console.table("Correlation", ("", *found["free"]), body)
    for name in (n for n, f in found["free"].items() if f["at_bound"]):
        console.say(f"{name} ended at its bound: the readings ask for more than it allows.")
    console.say(f"root mean square: {found['rmse_before_K']:.3f} K before, {found['rmse_after_K']:.3f} K after")


def print_replays(found: gh.Replays) -> None:
    """Print errors of free runs and by hours ahead, log by log."""
    units, first = found.logs[0].units, next(iter(found.logs[0].units))
    hours = found.as_dict()["hours"]
    for r in found.logs:
        rows = [[m, *(f"{e[s]:.2f}" for s in units)] for m, e in r.free.items()]
        title = f"{r.name}, free run from the first sample of each stretch: RMSE"
        console.table(title, ["method", *(f"{s} [{unit}]" for s, unit in units.items())], rows)
        rows = [[m, *(f"{v:.2f}" for v in e[first])] for m, e in r.ahead.items()]
        title = f"{r.name}, {first}: RMSE [{units[first]}] by hours ahead"
        if known := hours[: len(rows[0]) - 1]:  # no stretch is long enough for the others
            console.table(title, ["method", *(f"{h:g} h" for h in known)], rows)
