"""Simulated beside measured: runs of campaigns, losses at readings, fits, rivals, report."""
