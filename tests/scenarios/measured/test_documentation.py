"""The page that documents tables and cards: its example is read, its tables name every key and column."""

from __future__ import annotations

import re
import tomllib

import pytest
from gearheat.scenarios.measured.card import Card, Oil, Protocol, read_card
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.measured.sensors import CONTEXT, LOGGED
from gearheat.scenarios.tables import SensorTable
from gearheat.tools.docs.blocks import PAGES

PAGE = (PAGES / "reference" / "card.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+) ?([\w.]*)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)


def test_the_example_is_read(rig, tmp_path):
    for _, name, text in BLOCKS:
        if name:
            (tmp_path / name).write_text(text, encoding="utf-8")
    found = read_campaign(tmp_path / "bench.csv", rig("helical_two_stage"), read_card(tmp_path / "card.toml"))
    assert {s.name for s in found.sensors} == {"n_input", "T_output", "T_oil", "T_wall", "T_amb"}
    output, oil = found.sensor("T_output"), found.sensor("T_oil")
    assert list(found.values["T_output"] * output.sign(found.direction))[:2] == [-295, -590]
    assert found.values["T_oil"][0] == pytest.approx(273.15 + 24.95)
    assert (oil.repeat_sd, oil.offset_sd, output.offset_sd) == (0.2, 0.3, 2.0)
    assert found.steady and not found.warnings
    work = [text for kind, name, text in BLOCKS if name == "card.toml" or kind == "sh"]
    assert sum(len(text.splitlines()) for text in work) <= 20


def test_sensors_in_full_are_what_the_rig_file_takes():
    texts = [text for kind, name, text in BLOCKS if kind == "toml" and not name]
    assert tomllib.loads(texts[0])["sensors"] == {"T_oil_C": "oil.T"}
    table = tomllib.loads(texts[1])["sensors"]["T_sun"]
    SensorTable.model_validate(table)
    assert set(table) == set(SensorTable.model_fields) - {"magnitude"} and "magnitude" in PAGE


def test_every_key_and_column_is_on_the_page():
    keys = [field.alias or name for name, field in Card.model_fields.items() if not field.exclude]
    assert not [
        key for key in (*keys, *CONTEXT, *LOGGED, *Oil.model_fields) if f"`{key}`" not in PAGE and key != "name"
    ]
    told = set(Protocol.model_fields) - {"prose", "ambient", "reading"}
    assert not [key for key in told if f"`{key}`" not in PAGE]
