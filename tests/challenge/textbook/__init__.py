"""The "textbook" sheet: a fourth simulator of planetary rigs, FROZEN before the inference was written.

It serves as the one bench that nobody tuned anything on. Its node structure, loss laws, coolings, faults and noise
come from textbooks of machine elements and heat transfer (tooth friction of Benedict and Kelley with Ohlendorf's tooth
loss factor, bearings after Harris and Palmgren, seals after Linke, convection after Churchill with Chu and Bernstein),
written without looking at the library of causes or at the other sheets. Its readings are rough as measured ones are:
heavy tails, missing rows, single gross readings, tolerances and a scatter of the days 1.5 times what the card states.

Frozen means: the modules of this folder change only where a defect makes a case unphysical or a file
unreadable, never because the diagnosis fails on them; and the library of causes is never changed because of them.
"""
