"""The line contact against solved contacts, its limits, Hertz, and itself on finer grids and shorter steps."""

from dataclasses import replace
from itertools import pairwise
from math import pi, sin, sqrt

import numpy as np
import pytest
from gearheat.model.contact import solve
from gearheat.model.contact.case import Contact, Lubricant, hertz
from gearheat.model.contact.film import Film
from gearheat.model.contact.line import solve_line
from gearheat.model.contact.line_cycle import solve_line_cycle
from gearheat.model.errors import ScenarioError

R, E, U, ETA = 0.01, 226e9, 1e-11, 0.05


def moes(M: float, L: float, **oil: object) -> Contact:
    """The contact of two numbers of Moes, with the sum of the speeds in U."""
    u = U * E * R / ETA / 2
    return Contact(M * sqrt(U) * E * R, R, u, u, E, Lubricant(ETA, L / (E * U**0.25), **oil))


def thick(M: float, L: float, n: int) -> tuple[float, float]:
    """Minimum and central film [1] of a contact with Barus' viscosity and constant density."""
    film = solve_line(moes(M, L, piezoviscous="barus", compressible=False), n=n)
    return film.h_min / (R * sqrt(U)), film.h_c / (R * sqrt(U))


#: M, L, minimum and central film of another solver of first order with 601 nodes and with 301, solved by other hands.
TABLE = [
    (5, 10, 4.654, 4.695, 6.109, 6.176),
    (10, 10, 4.317, 4.356, 5.710, 5.781),
    (20, 2.5, 1.944, 1.973, 2.572, 2.615),
    (20, 10, 4.029, 4.084, 5.375, 5.471),
    (50, 10, 3.637, 3.700, 4.894, 5.009),
    (100, 10, 3.370, 3.388, 4.583, 4.697),
]


@pytest.mark.parametrize(("M", "L", "low_601", "low_301", "mid_601", "mid_301"), TABLE)
def test_films_of_another_solver(
    M: float, L: float, low_601: float, low_301: float, mid_601: float, mid_301: float
) -> None:
    low, mid = thick(M, L, 251)
    assert low == pytest.approx(2 * low_601 - low_301, rel=0.03)
    assert mid == pytest.approx(2 * mid_601 - mid_301, rel=0.03)


def test_central_film_converges_with_second_order_over_four_grids() -> None:
    films = [thick(20, 10, n)[1] for n in (76, 151, 301, 601)]
    steps = np.abs(np.diff(films))
    orders = np.log2(steps[:-1] / steps[1:])
    assert (orders > 1.8).all()
    assert (orders < 2.3).all()


def test_rigid_and_isoviscous_limit() -> None:
    """H M of a rigid cylinder in oil of constant viscosity is 2.448, half of 4.896 with the mean speed."""
    low, mid = thick(0.03, 0.01, 301)
    assert 0.03 * mid == pytest.approx(2.448, rel=0.02)
    assert low == pytest.approx(mid, rel=1e-3)


def test_isoviscous_elastic_limit() -> None:
    assert thick(50, 0.01, 251)[1] * 50**0.2 == pytest.approx(2.621, rel=0.04)


def test_at_rest_it_is_the_contact_of_hertz() -> None:
    contact = replace(moes(20, 10), u_1=0.0, u_2=0.0)
    film, dry = solve_line(contact, n=201), hertz(contact)
    expected = dry.p_max * np.sqrt(np.maximum(1 - (film.x / dry.a) ** 2, 0))
    assert np.abs(film.p[:, 0] - expected).max() < 0.01 * dry.p_max
    assert film.p.max() == pytest.approx(dry.p_max, rel=1e-3)
    assert film.asperity_share == pytest.approx(1.0, abs=1e-9)
    assert film.h_min == 0


@pytest.mark.parametrize(("M", "L"), [(0.5, 1.0), (20.0, 10.0), (1000.0, 3.0)])
def test_the_pressure_carries_the_load(M: float, L: float) -> None:
    film = solve_line(moes(M, L), n=151)
    assert abs(film.load_error) < 1e-8
    assert film.residual < 1e-8
    assert (film.p >= 0).all()


def test_reversed_rolling_mirrors_the_contact() -> None:
    contact = moes(20, 10)
    there, back = solve_line(contact, n=151), solve_line(replace(contact, u_1=-contact.u_1, u_2=-contact.u_2), n=151)
    assert back.h_min == pytest.approx(there.h_min, rel=1e-6)
    assert back.h[::-1] == pytest.approx(there.h, rel=1e-6)
    assert back.rolling_moment == pytest.approx(-there.rolling_moment, rel=1e-6)


def test_sliding_rubs_more_and_boundary_friction_is_what_is_left_at_rest() -> None:
    contact = moes(20, 10)
    pure, little, much = (
        solve_line(replace(contact, u_1=contact.u_m * (1 + s), u_2=contact.u_m * (1 - s)), n=101).mu
        for s in (0.0, 0.01, 0.2)
    )
    assert pure == 0 < little < much < 0.12
    assert solve_line(replace(contact, u_1=1e-12, u_2=-1e-12), n=101).mu == pytest.approx(0.12)


def test_a_wavy_surface_lowers_the_film_at_its_crests() -> None:
    contact = moes(20, 10)
    wave = 2e-8, 0.5 * hertz(contact).a
    rough = solve_line(contact, n=251, roughness=lambda x: wave[0] * np.cos(2 * pi * x / wave[1]))
    assert rough.h_min < solve_line(contact, n=251).h_min
    assert abs(rough.load_error) < 1e-8


def cycle(factor: object, steps: int) -> list[Film]:
    """Films under a load that changes with a factor over three transits of half a contact."""
    contact = moes(20, 10)
    end = 3 * hertz(contact).a / contact.u_m
    times = [end * k / steps for k in range(steps + 1)]
    return solve_line_cycle([replace(contact, F=contact.F * factor(t / end)) for t in times], times, n=101, steps=1)


def test_nothing_changes_while_nothing_changes() -> None:
    films = cycle(lambda t: 1.0, 4)
    assert [f.h_c for f in films] == pytest.approx([films[0].h_c] * 5, rel=1e-6)


def test_steps_in_time_converge_with_second_order() -> None:
    films = [cycle(lambda t: 1 + 0.4 * sin(pi * t) ** 2, k) for k in (24, 48, 96)]
    middle = [np.array([f[j * (len(f) - 1) // 4].h_c for j in (1, 2, 3, 4)]) for f in films]
    first, second = (np.abs(a - b).max() for a, b in pairwise(middle))
    assert 2.5 < first / second < 6
    assert max(abs(f.load_error) for f in films[0]) < 1e-8


def test_a_stopped_contact_squeezes_its_film_with_the_root_of_time() -> None:
    contact = moes(20, 10)
    transit = hertz(contact).a / contact.u_m
    rest = replace(contact, u_1=0.0, u_2=0.0)
    times = [0.0, 0.2 * transit, transit, 5 * transit, 25 * transit]
    films = solve_line_cycle([contact, *[rest] * 4], times, n=151, steps=6)
    assert films[4].h_min / films[3].h_min == pytest.approx(5**-0.5, rel=0.2)
    assert films[4].h_c == pytest.approx(films[0].h_c, rel=0.03)  # enclosed


@pytest.mark.parametrize("share", [0.5, 0.7])
def test_a_dent_is_carried_through_at_the_speed_of_its_surface(share: float) -> None:
    u_sum, b = 2 * moes(20, 10).u_m, hertz(moes(20, 10)).a
    contact = replace(moes(20, 10), u_1=share * u_sum, u_2=(1 - share) * u_sum)
    depth, width, start = 1e-7, 0.15 * b, -0.6 * b

    def dent(x: np.ndarray) -> np.ndarray:
        return -depth * np.exp(-(((x - start) / width) ** 2))

    times = [0.0, 0.4 * b / contact.u_1, 0.8 * b / contact.u_1]
    films = solve_line_cycle([contact] * 3, times, n=201, steps=6, surfaces=(dent, None))
    smooth = solve_line_cycle([contact] * 2, times[:2], n=201, steps=1)[1]
    for film, t in zip(films[1:], times[1:], strict=True):
        inside = np.abs(film.x) < 0.8 * b
        deeper = np.where(inside, film.h[:, 0] - smooth.h[:, 0], 0)
        assert film.x[np.argmax(deeper)] == pytest.approx(start + contact.u_1 * t, abs=0.1 * b)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda c: solve_line(c, n=20), "at least 51 nodes"),
        (lambda c: solve_line(c, domain=(-0.5, 2)), "beyond the contact"),
        (lambda c: solve_line(replace(c, R_y=0.1)), "R_y or edge_radius"),
        (lambda c: solve_line_cycle([c, c], [0.0]), "one contact for each moment"),
        (lambda c: solve_line_cycle([c, c], [0.0, 0.0]), "moments that rise"),
        (lambda c: solve_line(replace(c, F=0.0)), "F = 0 is out of range"),
    ],
)
def test_what_makes_no_problem_is_refused(call: object, says: str) -> None:
    with pytest.raises(ScenarioError, match=says):
        call(moes(20, 10))


def test_solve_takes_line_contacts_with_their_roughness() -> None:
    contact = moes(20, 10)
    wave = 2e-8, 0.5 * hertz(contact).a

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return wave[0] * np.cos(2 * pi * x / wave[1]) + 0 * y

    assert solve(contact, n=101).h_c == pytest.approx(solve_line(contact, n=101).h_c, rel=1e-6)
    rough = solve_line(contact, n=101, roughness=lambda x: wave[0] * np.cos(2 * pi * x / wave[1]))
    assert solve(contact, n=101, roughness=height).h_min == pytest.approx(rough.h_min, rel=1e-4)
