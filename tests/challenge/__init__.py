"""The blind test bench of the diagnosis: hides effects in simulated campaigns, has them diagnosed, scores the answers.

Sheets of cases: "own" is the planetary rig as the project's model has it, with unequal parameters; "foreign" another
gearbox with laws of its own and a healthy reference campaign; "textbook" a frozen third one with rough readings; "rigs"
steady points of other shipped rigs; "practice" campaigns in a folder with their keys.

A case is clean, or hides one cause (everywhere or in a regime), two, one without a name, or one too weak to be seen.
Causes that must be named are far from all that a cause of another class could do (`signal_to_noise.Rivals`). An "alike"
case hides a cause with a rival so near that the two cannot be separated: the right answer is a set. A "severe" case,
where asked for, hides one that is larger than those of other kinds.

`cases.make_case` writes one case, `scoring` scores answers, `bench` runs a sheet, `python -m tests.challenge` all.
"""
