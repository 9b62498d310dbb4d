"""Pictures of `--plot`: heat of a steady state, courses over time, sweeps."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from gearheat.model.core.flatten import flatten
from gearheat.model.machines.spec import assemble
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.shipped import list_rigs
from gearheat.tools.show.drawing import write_picture
from gearheat.tools.show.fields import Field, courses, fields
from gearheat.tools.show.heat_paths import Path, heat_flows, heat_paths
from gearheat.tools.show.machine import machine_picture
from gearheat.tools.show.sankey import heat_picture, place_columns, sankey
from gearheat.tools.solve.steady import conditions
from pages import problems_of, words_that_collide

KINDS = {".svg": b"<svg", ".png": b"\x89PNG", ".html": b"<!doctype html>"}


@pytest.mark.parametrize("rig", ["planetary", "helical_two_stage", "fzg_four_square", "drum_motor"])
def test_heat_paths_balance_and_begin_at_the_losses(rig):
    scenario = load(rig)
    assembly = assemble(scenario.spec)
    flat = flatten(assembly, flows=heat_flows(assembly))
    values = {name: float(c[0]) for name, c in steady(flat, conditions(scenario, flat)).columns.items()}
    paths = heat_paths(assembly, values)
    places = place_columns(paths)
    least = 2e-3 * max(p.Q_flow for p in paths)  # flows too small to tell
    made = taken = 0.0
    for name in places:
        into = sum(p.Q_flow for p in paths if p.ends == name)
        out = sum(p.Q_flow for p in paths if p.begins == name)
        if into and out:
            assert into == pytest.approx(out, abs=least * len(paths) / 4), name
        made, taken = made + (0 if into else out), taken + (0 if out else into)
    gone = sum(values.get(f"{name}.Q_flow", 0.0) for name in ("room", "thermostat"))
    assert made == pytest.approx(taken, rel=0.01)
    assert taken == pytest.approx(gone, rel=0.01)
    assert all(places[p.begins].column < places[p.ends].column for p in paths)
    kinds = {part.name: part.role for part in assembly.parts}
    picture = heat_picture(rig, paths, values, kinds)
    assert not words_that_collide(picture.figure)
    assert all(0 <= x <= 1 and 0 <= y <= 1 for x, y, _ in picture.marks)
    for p in paths:  # heat goes from hot to cold
        ends = [values.get(f"{name}.T") for name in (p.begins, p.ends)]
        assert None in ends or ends[0] > ends[1]


def test_a_machine_at_rest_has_a_picture():
    picture = heat_picture("at rest", [], {}, {})
    assert "no heat flows" in [text.get_text() for text in picture.figure.axes[0].texts]


@pytest.mark.parametrize("kind", [".png", ".html"])
def test_steady_draws_where_the_heat_goes(gearheat, tmp_path, kind):
    plot = tmp_path / f"heat{kind}"
    answer = gearheat("steady", "planetary", "--plot", plot, "--json", "-")
    found = answer.json
    assert found["plot"] == str(plot)
    assert f"wrote {plot}" in answer.err
    assert plot.read_bytes().startswith(KINDS[kind])
    if kind == ".html":
        text = plot.read_text(encoding="utf-8")
        assert problems_of(text) == []
        assert f"{found['values']['foot.Q_flow']:.4g}" in text and "cooling: radiation" in text


@pytest.mark.parametrize("rig", list_rigs())
def test_every_machine_has_a_drawing(rig):
    """No word lies over another; each mesh, bearing and motor has its number."""
    scenario = load(rig)
    picture = machine_picture(scenario.spec.assembly(), scenario.entries, {}, rig, {})
    assert not words_that_collide(picture.figure)
    said = [words.partition(":")[0] for _, _, words in picture.marks]
    for name, kind in scenario.types.items():
        if kind.role in ("teeth", "bearing", "motor"):
            assert name.replace("_", " ") in said


def test_small_losses_of_one_kind_are_one_box():
    """Six bearings of 1 W beside teeth of 100 W: "6 bearings", 6 W; nothing is lost."""
    paths = [Path("teeth", "oil", "", 100.0), *(Path(f"b{k}", "oil", "", 1.0) for k in range(6))]
    paths.append(Path("oil", "room", "", 106.0))
    figure, marks = sankey(paths, {}, "heat", {"teeth": "teeth"} | {f"b{k}": "bearing" for k in range(6)})
    words = [text.get_text() for text in figure.axes[0].texts]
    assert sorted(words) == ["6 bearings\n6 W", "oil\n106 W", "room\n106 W", "teeth\n100 W"]
    assert "6 bearings → oil: 6 W" in [mark[2] for mark in marks]


def test_a_map_says_loads_and_percent():
    """Torque that leaves is a load, efficiency is in percent, the operating point and the limit are told."""
    w, tau = (v.ravel() for v in np.meshgrid([500.0, 1000.0, 1500.0], [-300.0, -200.0, -100.0]))
    over = [Field("input.w", "rpm", w, 1000.0), Field("output.tau", "N.m", tau, -200.0)]
    drawn = [Field("efficiency.eta", "1", 0.9 + w / 1e5), Field("oil.T", "degC", w / 10, limit=95.0)]
    picture = fields("rig", over, drawn)
    eta, oil = picture.figure.axes
    assert (eta.get_title(), oil.get_title()) == ("efficiency [%]", "oil temperature [°C]")
    assert (eta.get_xlabel(), eta.get_ylabel()) == ("input speed [rpm]", "output load [N.m]")
    assert eta.get_ylim()[0] > 0 and len(eta.lines) == len(oil.lines) == 1
    assert oil.lines[0].get_xydata().tolist() == [[1000.0, 200.0]]
    assert "input speed 1500 rpm\noutput load 300 N.m\nefficiency 91.5 %" in [mark[2] for mark in picture.marks]
    assert "red line" in picture.note and any(
        len(c.get_edgecolor()) and c.get_linewidth()[0] > 2 for c in oil.collections
    )


def test_courses_are_drawn_to_be_zoomed(tmp_path):
    time = np.arange(0.0, 3 * 3600.0, 2.0)
    columns = {"oil.T": 300 + time / 1000, "room.T": np.full(len(time), 293.15), "oil.Q_flow_external": 0 * time}
    plot = tmp_path / "run.html"
    write_picture(plot, courses("rig, duty", time, columns, {"oil.T": "K", "room.T": "K", "oil.Q_flow_external": "W"}))
    text = plot.read_text(encoding="utf-8")
    assert problems_of(text) == []
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["x"]["label"] == "time [min]" and np.all(np.diff(data["x"]["values"]) > 0)
    assert data["x"]["values"][-1] == pytest.approx(time[-1] / 60, abs=1e-4)
    assert [s["label"] for s in data["series"]] == ["oil.T", "room.T"]
    assert data["series"][0]["values"][-1] == pytest.approx(columns["oil.T"][-1] - 273.15, abs=1e-3)


def test_a_sweep_over_two_is_a_map(gearheat, tmp_path):
    plot = tmp_path / "a.html"
    axes = ("--vary", "room.T=10..30 degC", "--vary", "input.w=900..1450 rpm", "--sample", "6")
    answer = gearheat("sweep", "helical_two_stage", *axes, "-o", tmp_path / "a.csv", "--plot", plot)
    assert answer.code == 0, answer.err
    text = plot.read_text(encoding="utf-8")
    assert problems_of(text) == [] and "efficiency.eta" in text


@pytest.mark.parametrize(("over", "kind"), [(1, ".svg"), (1, ".html"), (2, ".svg"), (2, ".png")])
def test_lines_and_maps(tmp_path, kind, over):
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 40, 5), np.linspace(500, 1500, 4)))
    values = np.where(np.arange(20) == 7, np.nan, x + y / 100)
    axes = [Field("room.T", "degC", x), Field("motor.w", "rpm", y)]
    drawn = [
        Field("oil.T", "degC", values),
        Field("meter.eta", "1", np.ones(20)),
        Field("a", "W", x),
        Field("b", "W", y),
    ]
    path = tmp_path / f"a{kind}"
    write_picture(path, fields("rig", axes[:over], drawn))
    before = path.read_bytes()
    assert before.startswith(KINDS[kind])
    if kind == ".svg":
        write_picture(path, fields("rig", axes[:over], drawn))
        assert path.read_bytes() == before
    assert not words_that_collide(fields("rig", axes[:over], drawn).figure)


def test_a_picture_that_cannot_be_is_said_before_the_work(gearheat, tmp_path):
    answer = gearheat("steady", "planetary", "--plot", tmp_path / "a.pdf")
    assert answer.code == 2 and "must end in .html or .svg or .png" in answer.err
    three = [
        x
        for name in ("room.T=10..30 degC", "input.w=900..1450 rpm", "output.tau=-500..-100 N.m")
        for x in ("--vary", name)
    ]
    answer = gearheat(
        "sweep", "helical_two_stage", *three, "--sample", "5", "-o", tmp_path / "a.csv", "--plot", tmp_path / "a.svg"
    )
    assert answer.code == 2 and "3 are varied" in answer.err
    assert not list(tmp_path.iterdir())
