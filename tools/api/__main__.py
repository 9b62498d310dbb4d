"""`python -m gearheat`: the command line."""

from .tools.cli.__main__ import main

main()
