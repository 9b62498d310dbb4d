from __future__ import annotations

from gearheat.tools.check import PACKAGES, links, main, steps


def test_types_are_checked_through_links_to_every_package(tmp_path):
    for folder in PACKAGES.values():
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
        (tmp_path / folder / "__init__.py").touch()
    for _ in range(2):
        place = links(tmp_path)
    for package in PACKAGES:
        assert (place / "gearheat" / package / "__init__.py").is_file()


def test_all_kinds_of_check_are_there():
    assert list(steps()) == ["lint", "format", "types", "lock", "tests", "matrix"]


def test_a_check_that_does_not_exist(capfd):
    assert main(["lind"]) == 2
    assert 'Did you mean "lint"' in capfd.readouterr().err
