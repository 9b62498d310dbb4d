"""Diagnosis: measured data against the model, causes by name, the extended model and its measured gain."""
