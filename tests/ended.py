"""How a command ends in this process."""

from tetherfmu.__main__ import main


def status_of(*arguments):
    """Exit status of `tetherfmu` with these arguments, also where its parser ends the program."""
    try:
        return main([*arguments])
    except SystemExit as end:
        return end.code
