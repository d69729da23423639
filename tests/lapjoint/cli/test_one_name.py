"""One name for one thing: options that mean the same are called the same in every command."""

from __future__ import annotations

import inspect

import click
import pytest

import lapjoint
from lapjoint.campaigns.running import run_job
from lapjoint.cli.main import main

CONTEXT = click.Context(main)
COMMANDS = {name: main.get_command(CONTEXT, name) for name in main.list_commands(CONTEXT)}


def options(name: str) -> dict[str, click.Option]:
    """Options of a command by each of their names."""
    command = COMMANDS[name]
    assert command is not None
    return {text: option for option in command.params if isinstance(option, click.Option) for text in option.opts}


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_where_an_answer_goes_is_said_by_o_or_out(name: str) -> None:
    found = options(name)
    assert ("-o" in found) == ("--out" in found)
    assert not {"--output", "--count", "--modes"} & set(found)


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_option_has_a_help_text(name: str) -> None:
    assert [text for text, option in options(name).items() if not option.help] == []


@pytest.mark.parametrize("name", ["branch", "sweep", "basins", "statistics"])
def test_options_have_the_defaults_of_the_function_of_their_name(name: str) -> None:
    functions = run_job, getattr(lapjoint, name)  # the arguments that all campaigns share, and the campaign's own
    given = [it for function in functions for it in inspect.signature(function).parameters.values()]
    numbers = {it.name: it.default for it in given if isinstance(it.default, int | float)}
    stated = {
        str(option.name): option.default
        for option in options(name).values()
        if isinstance(option.default, int | float)  # what has none leaves it to the function
    }
    assert numbers.keys() & stated.keys()
    for option in numbers.keys() & stated.keys():
        assert stated[option] == numbers[option], option
