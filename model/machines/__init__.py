"""What machines are made of: specs, the layouts of whole kinds of machines, what the parts do, pieces of a machine."""
