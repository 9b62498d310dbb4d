"""Causes that nuisances far off take up where no cause is fitted, and so do not show there."""

from challenge import model_rig
from challenge.cases import make_case
from gearheat import diagnose


def test_readings_far_too_early_are_in_the_set_though_other_capacities_hide_them(tmp_path) -> None:
    # heat paths that may follow the room otherwise than their laws explain most of it, too: it leads no more
    make_case(model_rig.draw, 0, 10001, 27, tmp_path, kind=None)
    case = tmp_path / "case"
    found = diagnose(case / "DATA.csv", "planetary", card=case / "CARD.json", quick=True)
    assert (("procedure.not_stationary",),) in [answer.causes for answer in found.answers]
