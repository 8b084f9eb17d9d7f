"""`python -m footopt`: the same as the command `footopt`."""

from footopt.cli.main import main

main()
