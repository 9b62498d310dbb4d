"""Point contacts: dry limit, conservation, complementarity, symmetry, order, published films, bad input."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from gearheat.model.contact import Contact, Film, Lubricant, gaussian_texture, hertz, solve
from gearheat.model.errors import ScenarioError

R, E, ETA, ALPHA = 0.0127, 226e9, 0.04, 22e-9


def moes(M: float, L: float, R_y: float = R, **oil: object) -> tuple[Contact, float]:
    """The contact of two numbers of Moes, with the sum of the speeds, and its unit of film [m]."""
    U = (L / (ALPHA * E)) ** 4
    u = U * E * R / ETA
    return Contact(M * E * R**2 * U**0.75, R, 0.55 * u, 0.45 * u, E, Lubricant(ETA, ALPHA, **oil), R_y=R_y), U**0.5 * R


@cache
def film(n: int, M: float = 20.0, L: float = 10.0, R_y: float = R) -> tuple[Film, float]:
    contact, unit = moes(M, L, R_y, compressible=False)
    return solve(contact, n=n), unit


@pytest.mark.parametrize("ratio", [1.0, 4.0, 0.5])
def test_at_rest_it_is_the_contact_of_hertz(ratio: float) -> None:
    contact, _ = moes(20, 10, R * ratio)
    dry, found = hertz(contact), solve(replace(contact, u_1=0.0, u_2=0.0), n=65)
    middle = found.p[:, 32] > 0
    assert found.p.max() == pytest.approx(dry.p_max, rel=0.01)
    assert found.approach == pytest.approx(dry.approach, rel=0.01)
    step = found.x[1] - found.x[0]
    assert middle.sum() * step / 2 == pytest.approx(dry.a, abs=step)
    assert found.asperity_share == pytest.approx(1.0, abs=1e-6)
    assert found.h_min == pytest.approx(1e-9)


def test_the_pressure_carries_the_load() -> None:
    found, _ = film(65)
    assert abs(found.load_error) < 1e-5
    assert found.residual < 1e-6


def test_pressure_is_never_negative_and_the_oil_leaves_where_it_is_zero() -> None:
    found, _ = film(65)
    cavity = (found.p == 0) & (found.x > 0)[:, None]
    assert found.p.min() == 0
    assert cavity.any()
    widens = np.diff(found.h, axis=0)[cavity[1:] & cavity[:-1]]
    assert widens.min() > 0


def test_both_sides_of_the_contact_are_alike() -> None:
    found, _ = film(65)
    assert np.abs(found.p - found.p[:, ::-1]).max() < 1e-6 * found.p.max()


def test_the_film_is_of_second_order() -> None:
    h = [film(n)[0].h_c for n in (33, 65, 129)]
    assert 3 < (h[1] - h[0]) / (h[2] - h[1]) < 5.5


def test_the_film_of_nijenbanning_venner_and_moes() -> None:
    """Central film of an incompressible oil at M = 20, L = 10; the grid's error is taken out by its order."""
    (coarse, unit), (fine, _) = film(65), film(129)
    assert (4 * fine.h_c - coarse.h_c) / 3 / unit == pytest.approx(4.708, rel=0.08)


def test_no_oil_is_lost_on_its_way_through_the_contact() -> None:
    """What flows into a box around the contact's front half flows out of it."""
    found, _ = film(65)
    contact = found.contact
    p, h, x, y = found.p, found.h, found.x, found.y
    mobility = h**3 / (12 * contact.lubricant.viscosity(p))
    dx, dy = x[1] - x[0], y[1] - y[0]
    along = contact.u_m * h[1:-1] - mobility[1:-1] * (p[2:] - p[:-2]) / (2 * dx)
    across = -mobility[:, 1:-1] * (p[:, 2:] - p[:, :-2]) / (2 * dy)
    i, k, j, m = *np.searchsorted(x, [-2.0 * hertz(contact).a, 0.5 * hertz(contact).a]), 20, 44
    net = _trapezoid(along[k - 1, j : m + 1], dy) - _trapezoid(along[i - 1, j : m + 1], dy)
    net += _trapezoid(across[i : k + 1, m - 1], dx) - _trapezoid(across[i : k + 1, j - 1], dx)
    assert abs(net) < 0.02 * _trapezoid(along[i - 1, j : m + 1], dy)


def _trapezoid(f: np.ndarray, step: float) -> float:
    return float((f.sum() - (f[0] + f[-1]) / 2) * step)


def test_a_roller_with_rounded_ends_is_a_line_contact_in_its_middle() -> None:
    oil = Lubricant(ETA, ALPHA, compressible=False)
    roller = Contact(40.0, R, 0.5, 0.5, E, oil, length=2e-3, edge_radius=0.02)
    found = solve(roller, n=65)
    line = solve(replace(roller, edge_radius=0.0), n=257)
    assert found.h_c == pytest.approx(line.h_c, rel=0.08)
    assert found.p.max() > line.p.max()
    assert found.h_min < line.h_min


def test_asperities_touch_where_the_film_is_below_them() -> None:
    contact, _ = moes(20, 10)
    a = hertz(contact).a
    rough = gaussian_texture(40e-9, 0.4 * a, 0.4 * a, n=32, spacing=0.1 * a, seed=1)
    fast = solve(contact, n=65, roughness=rough)
    slow = solve(replace(contact, u_1=contact.u_1 / 100, u_2=contact.u_2 / 100), n=65, roughness=rough)
    rest = solve(replace(contact, u_1=0.0, u_2=0.0), n=65, roughness=rough)
    assert fast.asperity_share == 0
    assert 0.01 < slow.asperity_share < 1
    assert rest.asperity_share == pytest.approx(1)
    assert slow.h_min == pytest.approx(1e-9, rel=1e-3)
    assert slow.mu > fast.mu


def test_bad_contacts_are_refused() -> None:
    contact, _ = moes(20, 10)
    with pytest.raises(ScenarioError, match="2\\^k \\+ 1"):
        solve(contact, n=100)
    with pytest.raises(ScenarioError, match="F = 0"):
        replace(contact, F=0.0)
    with pytest.raises(ScenarioError, match="points out of the inlet"):
        solve(replace(contact, u_1=-1.0, u_2=0.0), n=33)
