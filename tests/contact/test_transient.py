"""Contacts over time: a steady one stays, order in time, the speed of a disturbance, a cycle of load, bad input."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from gearheat.model.contact import Contact, Film, Lubricant, Texture, hertz, solve_transient
from gearheat.model.errors import ScenarioError

R, E, ETA, ALPHA = 0.0127, 226e9, 0.04, 22e-9
DOMAIN = (-2.5, 1.5, 2.0)


def rolling(M: float = 50.0, L: float = 8.0) -> Contact:
    U = (L / (ALPHA * E)) ** 4
    u = U * E * R / ETA / 2
    return Contact(M * E * R**2 * U**0.75, R, u, u, E, Lubricant(ETA, ALPHA), R_y=R)


def test_a_steady_contact_stays_as_it_is() -> None:
    contact = rolling()
    time = hertz(contact).a / contact.u_m
    first, *_, last = solve_transient([0, time, 2 * time], [contact] * 3, n=33, domain=DOMAIN, tolerance=1e-8)
    assert last.h == pytest.approx(first.h, rel=1e-5)


@cache
def loaded(steps: int) -> Film:
    """The film after a load has swung by a tenth for half a period."""
    contact = rolling()
    times = np.linspace(0, 3 * hertz(contact).a / contact.u_m, steps + 1)
    swing = 1 + 0.1 * np.sin(np.pi * times / times[-1]) ** 2
    contacts = [replace(contact, F=contact.F * s) for s in swing]
    return solve_transient(list(times), contacts, n=33, domain=DOMAIN, tolerance=1e-7)[-1]


def test_steps_in_time_are_of_second_order() -> None:
    h = [loaded(steps).h_c for steps in (12, 24, 48)]
    assert 3.3 < (h[1] - h[0]) / (h[2] - h[1]) < 6


def test_a_disturbance_of_the_film_moves_with_the_oil() -> None:
    """A furrow moves at half the mean speed; what it lets into the contact passes through at the mean speed."""
    contact = rolling(100.0, 10.0)
    a, u_m = hertz(contact).a, contact.u_m
    contact = replace(contact, u_1=0.5 * u_m, u_2=1.5 * u_m)
    times = np.linspace(0, 4.5 * a / u_m, 28)
    films = solve_transient(
        list(times),
        [contact] * 28,
        n=65,
        domain=DOMAIN,
        roughness_1=lambda x, y: -5e-8 * np.exp(-(((x + 2.2 * a) / (0.3 * a)) ** 2)) + 0 * y,
    )
    middle = films[0].h.shape[1] // 2
    x = films[0].x / a
    inside = np.abs(x) < 0.75
    place = [x[inside][np.argmax((f.h - films[0].h)[inside, middle])] for f in (films[21], films[25])]
    passed = (times[25] - times[21]) * u_m / a
    assert place[1] - place[0] == pytest.approx(passed, abs=2 * (x[1] - x[0]))


def test_a_cycle_of_load_speed_and_radius() -> None:
    contact = rolling()
    times = np.linspace(0, 20 * hertz(contact).a / contact.u_m, 8)
    phase = np.sin(2 * np.pi * times / times[-1])
    contacts = [
        replace(
            contact,
            F=contact.F * (1 + 0.5 * s),
            R_x=R * (1 + 0.2 * s),
            u_1=contact.u_1 * (1 - 0.3 * s),
            u_2=contact.u_2 * (1 - 0.3 * s),
        )
        for s in phase
    ]
    wavy = np.outer(np.sin(2 * np.pi * np.arange(16) / 16), np.ones(4)) * 2e-8
    films = solve_transient(list(times), contacts, n=33, roughness_2=Texture(wavy, (2e-5, 2e-5)))
    assert all(abs(f.load_error) < 1e-4 for f in films)
    assert all(f.h_min > 0 for f in films)
    assert films[2].p.max() > films[5].p.max()


def test_bad_times_are_refused() -> None:
    with pytest.raises(ScenarioError, match="1 times and 2 contacts"):
        solve_transient([0.0], [rolling()] * 2)
    with pytest.raises(ScenarioError, match="times increasing"):
        solve_transient([0.0, 0.0], [rolling()] * 2)
