"""Warm-ups of many rows of the shipped rigs, beside the simulation of the same model."""

import numpy as np
import pytest
from for_each import thin
from gearheat.fmu.batch import Batch, Status
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.scenarios.load import list_rigs, load


@pytest.mark.parametrize("name", thin(list_rigs(), 1))
def test_a_rig_warms_up_as_it_is_simulated(name: str) -> None:
    """At several loads, through a stop of its shaft and a room that cools down."""
    spec = load(name).spec
    flat = spec.flat()
    batch = Batch(flat)
    torques = [q.name for q in flat.inputs if q.name.endswith(".tau")]
    pressures = [q.name for q in flat.parameters if q.name.endswith(".p_bypass")]
    load_name = next(iter(torques + [q.name for q in flat.parameters if q.unit == "N"] + pressures))
    room = next(q for q in flat.inputs if q.name == f"{spec.of_type('Room')[0]}.T")
    speed = next(q for q in flat.inputs if q.name.endswith(".w"))
    duty = join_phases(
        [
            (3600.0, {speed.name: speed.start, room.name: room.start}),
            (1800.0, {speed.name: 0.0, room.name: (room.start, room.start - 10.0)}),
            (3600.0, {speed.name: (0.5 * speed.start, speed.start), room.name: room.start - 10.0}),
        ]
    )
    loads, times = flat.quantity(load_name).start * np.linspace(0.2, 1.0, 11), np.linspace(0.0, duty.stop, 11)
    rows = batch.warmup(duty, *batch.vectors({load_name: loads}), times=times, tolerance=1e-7)
    assert (rows.status == Status.OK).all()
    assert rows.residual.max() < 1e-6
    for k in (0, 5, 10):
        run = simulate(flat, duty, values={load_name: loads[k]}, times=times, tolerance=1e-11)
        for q in flat.states:
            assert rows[q.name][k] == pytest.approx(run[q.name], abs=1e-6 * q.nominal), q.name
        for q in flat.outputs:
            if q.unit == "W":
                assert rows[q.name][k] == pytest.approx(run[q.name], rel=1e-5, abs=1e-5 * q.nominal), q.name
