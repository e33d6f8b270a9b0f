"""What `tetherfmu --help` lists: the commands that a user types, each with an example that can be typed."""

import shlex
from pathlib import Path

import pytest

from running import status_of
from tetherfmu.__main__ import main, usage
from tetherfmu.console.options import Parser
from tetherfmu.console.subcommands import SUBCOMMANDS

ROOT = Path(__file__).resolve().parents[2]
EACH_COMMAND = pytest.mark.parametrize("name", SUBCOMMANDS)


class Understood(Exception):
    """Stands for what a command does when it has read its options."""


def test_the_list_has_what_a_user_types():
    assert " ".join(SUBCOMMANDS) == "build fly check replay advise tradeoff sweep import tutorial web"


def test_the_list_fits_a_terminal():
    assert max(map(len, usage().splitlines())) <= 100


@EACH_COMMAND
def test_the_example_is_understood(name, monkeypatch, tmp_path, fmu_folder):
    """In a checkout with built FMUs. It is understood if its parser takes all of it; nothing is flown."""

    def parse(parser, arguments=None, namespace=None):
        parsed.append(super(Parser, parser).parse_args(arguments, namespace))
        raise Understood

    parsed = []
    (tmp_path / "dist").symlink_to(fmu_folder, target_is_directory=True)
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Parser, "parse_args", parse)
    program, command, *options = shlex.split(SUBCOMMANDS[name].example)
    assert (program, command) == ("tetherfmu", name)
    with pytest.raises(Understood):
        main([command, *options])
    files = [word for word in options if "/" in word]
    assert all(Path(file).is_file() for file in files)
    assert len(parsed) == 1


@EACH_COMMAND
def test_the_help_of_a_command_begins_as_it_is_typed_and_ends_with_its_example(name, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "40")
    assert status_of(name, "--help") == 0
    shown = capsys.readouterr().out
    assert shown.startswith(f"usage: tetherfmu {name} ")
    assert shown.endswith(f"\n\nexample: {SUBCOMMANDS[name].example}\n")
    assert f"\n  {name}" in usage()
