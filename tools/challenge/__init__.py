"""The blind test bench of `gearheat diagnose`: hides effects in simulated campaigns, asks, and scores the answers.

Two sheets of cases: "own", where the rig behaves as the project's model does, with unequal parameters and hidden
effects of free forms around its equations; and "foreign", where another gearbox is simulated with laws of its own and
a healthy reference campaign is given. `case.make_case` writes one case, `scoring` scores answers, `bench` runs a sheet.
"""
