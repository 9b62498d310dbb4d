"""A rig set, driven and solved: steady states, runs over time, designs, maps, sweeps."""
