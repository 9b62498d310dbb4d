"""The contacts of a rig on the command line."""

import math

KEYS = ["theta_deg", "R_m", "w_N_m", "U_m_s", "v_slide_m_s", "p_H_Pa", "h_min_m", "h_c_m"]
KEYS += ["Lambda", "asperity_share", "mu"]


def test_contacts_of_every_pin_as_json(gearheat) -> None:
    for pin in ("held", "rolling"):
        found = gearheat("losses", "rv_stage", "--contacts", "--set", f"mesh.pin={pin}", "--json", "-")
        assert found.code == 0, found.err
        assert found.json["rows"] and abs(found.json["torque_recovery"] - 1) < 1e-3
        assert list(found.json["columns"]) == KEYS
        assert len(found.json["cycle"]) == 15 and all(moment["F"] > 0 for moment in found.json["cycle"])
        assert all(list(row) == KEYS for row in found.json["contacts"])
        assert all(math.isfinite(v) for row in found.json["contacts"] for v in row.values())


def test_contacts_as_a_table(gearheat) -> None:
    shown = gearheat("losses", "rv_stage", "--contacts")
    assert shown.code == 0
    assert "contacts over a mesh cycle" in shown.out and "torque_recovery: 1" in shown.out
    assert "slides in its groove instead" in shown.out


def test_without_contacts_the_table_is_as_before(gearheat) -> None:
    assert "contacts" not in gearheat("losses", "rv_stage", "--json", "-").json


def test_a_rig_without_contacts_says_so(gearheat) -> None:
    answer = gearheat("losses", "helical_two_stage", "--contacts")
    assert answer.code == 2
    assert "no part has a table of contacts" in answer.err and "CycloidPinStage" in answer.err
