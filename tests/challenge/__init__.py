"""The blind test bench of `gearheat diagnose`: hides effects in simulated campaigns, asks, and scores the answers.

Two sheets of cases: "own", where the rig behaves as the project's model does, with unequal parameters and hidden
effects of free forms around its equations; and "foreign", where another gearbox is simulated with laws of its own and
a healthy reference campaign is given.

Cases are clean, hide one cause (everywhere or in a regime) or two, something without a name, or something too weak to
see. Causes to be told by their name lie far from whatever a cause of another class could do (`rivals`); a few cases
are "alike": they hide one cause with a rival so near that nobody could tell which it is, and the right answer is a set.

`case.make_case` writes one case, `scoring` scores answers, `bench` runs a sheet.
"""
