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
from gearheat.tools.show.drawing import write_picture
from gearheat.tools.show.fields import Field, courses, fields
from gearheat.tools.show.heat_paths import heat_flows, heat_paths
from gearheat.tools.show.sankey import heat_picture, place_columns
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
    assert not words_that_collide(heat_picture(rig, paths, values).figure)
    for p in paths:  # heat goes from hot to cold
        ends = [values.get(f"{name}.T") for name in (p.begins, p.ends)]
        assert None in ends or ends[0] > ends[1]


def test_a_machine_at_rest_has_a_picture():
    picture = heat_picture("at rest", [], {})
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
