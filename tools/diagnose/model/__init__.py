"""What a rig would show: the compiled model with every knob, its exact sensitivities, and the noise."""
