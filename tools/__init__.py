"""The command line and what stands behind it: compare, report, bench, check."""
