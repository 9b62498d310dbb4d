"""Text that acts on what shows it: escapes of terminals, marks of direction, C, XML, formulas of spreadsheets."""

import csv
import shutil
import zipfile
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from gearheat.fmu.source import _string
from gearheat.model.errors import GearheatError, visible
from gearheat.scenarios.shipped import RIGS

#: What acts, as it is and as it is shown.
ACTING = {
    "\x1b[31mred": r"\x1b[31mred",
    "\x9b2J": r"\x9b2J",
    "\u202eevil": r"\u202eevil",
    "\u2066a\u2069": r"\u2066a\u2069",
    "bell\x07": r"bell\x07",
    "over\rwritten": r"over\rwritten",
    "\ufeffmark": r"\ufeffmark",
    "\ud800": r"\ud800",
}


@pytest.mark.parametrize("text", ACTING)
def test_what_acts_is_shown(text):
    assert visible(text) == ACTING[text]
    assert GearheatError(text).problems == (ACTING[text],)
    assert visible("Öl 60 °C\tmü\n") == "Öl 60 °C\tmü\n"


@pytest.mark.parametrize("text", ['"; system("x"); //', "a\r\n#define x", "??/", "\\", "*/", "ü", "\u202e", "%s\x00"])
def test_texts_of_c_are_printable_ascii_of_one_line(text):
    written = _string(text)
    assert written.isascii() and written.isprintable()
    assert not {'"', "?", "\\\\"} & set(written[1:-1])


@pytest.fixture(params=["\x1b[31mred", "\u202eevil", 'a\r"; int x;\r'])
def named(request, tmp_path):
    """A copy of a rig whose folder, meaning and sources have such a text."""
    folder = tmp_path / f"rig {request.param}"
    shutil.copytree(RIGS / "planetary", folder)
    path = folder / "rig.toml"
    shown = request.param.encode("unicode_escape").decode().replace('"', '\\"').replace("\\x", "\\u00")
    text = (
        path.read_text(encoding="utf-8").replace('doc = "', f'doc = "{shown}', 1).replace("Dias2014", f"{shown}Dias", 1)
    )
    path.write_text(text, encoding="utf-8")
    return folder, request.param


def test_nothing_of_a_file_acts_on_the_screen(gearheat, named):
    folder, text = named
    answers = [gearheat("show", folder), gearheat("steady", folder), gearheat("steady", folder, "--set", f"x{text}=1")]
    for answer in answers:
        said = answer.out + answer.err
        assert said and visible(said) == said


def test_nothing_of_a_name_reaches_c_or_breaks_xml(gearheat, named, tmp_path):
    folder, text = named
    out = tmp_path / "out.fmu"
    assert gearheat("export", folder, "-o", out, "--platform", "host").code == 0
    with zipfile.ZipFile(out) as archive:
        described = archive.read("modelDescription.xml")
        source = next(archive.read(n) for n in archive.namelist() if n.endswith(".c")).decode("ascii")
    assert visible(ElementTree.fromstring(described).get("modelName")) == f"rig {visible(text)}"
    assert "\r" not in source and "int x;" not in [line.strip() for line in source.splitlines()]


@pytest.mark.parametrize("option", ["--author", "--license", "--model-version"])
@pytest.mark.parametrize("text", ["a\x01b", "a\nb", "\x1b[1m", "\u202e"])
def test_what_an_owner_says_can_be_seen(gearheat, tmp_path, option, text):
    answer = gearheat("export", "planetary", "-o", tmp_path / "a.fmu", option, text)
    assert answer.code == 2 and f"{option} has characters that cannot be seen" in answer.err
    assert not (tmp_path / "a.fmu").exists()


@pytest.mark.parametrize("title", ["=1+1", "+1", "-1", "@x", "=HYPERLINK(1,2)"])
def test_a_column_is_no_formula(title):
    import numpy as np
    from gearheat.tools.diagnose.report.tables import predictions_text
    from gearheat.tools.show.columns import rows_text, table_text

    (head, *_) = csv.reader(table_text({title: np.zeros(2), "oil.T": np.ones(2)}).splitlines())
    assert head == [f"'{title}", "oil.T"]
    (head, row) = csv.reader(rows_text([title, "n"], [[title, -1]]).splitlines())
    assert (head, row) == ([f"'{title}", "n"], [f"'{title}", "-1"])
    predictions = [SimpleNamespace(point=title, nominal={title: 1.0}, extended={title: -2.0})]
    found = predictions_text(SimpleNamespace(predictions=predictions, channels=[]))
    (head, row) = csv.reader(found.splitlines())
    assert head[1:] == [f"'{title}_nominal", f"'{title}_extended"] and row == [f"'{title}", "1.000", "-2.000"]
