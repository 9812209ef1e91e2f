"""The table of keys."""

from collections import Counter
from itertools import combinations

import glfw
import pytest

from ashe_live.viewer.hands.controls import (
    BINDINGS,
    COMMAND_BY_GESTURE,
    HELD,
    REPEATED,
    REQUEST_BY_KEY,
    help_rows,
    request_for,
)
from ashe_live.viewer.hands.requests import Command, Gesture, Request
from ashe_live.viewer.windows.glfw_window import NAME_BY_GLFW_KEY, held


def split(key: str) -> tuple[str, str]:
    """Modifiers in the table's order, and the key's name."""
    name = key
    for modifier in HELD:
        name = name.removeprefix(modifier)
    return key.removesuffix(name), name


def test_every_command_is_bound_exactly_once():
    assert Counter(binding.command for binding in BINDINGS) == Counter(Command)


def test_no_key_asks_for_two_things():
    keys = [key for binding in BINDINGS for key in binding.keys]
    assert len(keys) == len(set(keys)) == len(REQUEST_BY_KEY)


def test_glfw_knows_every_key():
    """By its name, where that is longer than what stands on a key."""
    for key in REQUEST_BY_KEY:
        _, name = split(key)
        assert len(name) == 1 or name in NAME_BY_GLFW_KEY.values()


def test_the_number_keys_choose_by_place():
    chosen = [request_for(label, key) for key, label in zip("123456789", "&é\"'(-è_ç", strict=True)]  # French
    assert chosen == [Request(Command.CHOOSE_MODEL, place) for place in range(9)]


@pytest.mark.parametrize(
    ("label", "place", "command"),
    [
        ("a", "A", Command.AUTOMATIC),
        ("a", "Q", Command.AUTOMATIC),  # French: what stands on the key counts
        ("ф", "A", Command.AUTOMATIC),  # Russian: no Latin letter stands there
        ("", "LEFT", Command.PREVIOUS_MODEL),
        ("o", "S", Command.LOOP),  # Dvorak
        ("ö", "SEMICOLON", None),
        (",", "M", Command.STEP),  # French
        ("", None, None),
    ],
)
def test_keys_are_known_by_what_stands_on_them(label, place, command):
    request = request_for(label, place)
    assert (None if request is None else request.command) is command


# What the keys of a layout say without a modifier, and GLFW's name of their place where the table has it.
DIGITS = {digit: digit for digit in "123456789"}
GERMAN = dict.fromkeys("0+-#,.äöü^qwertzuiopasdfghjklyxcvbnm<") | {"ß": "MINUS", "´": "EQUAL"} | DIGITS
SWISS = dict.fromkeys("0-$,.äöü¨§qwertzuiopasdfghjklyxcvbnm<") | {"'": "MINUS", "^": "EQUAL"} | DIGITS
FRENCH = dict.fromkeys("à^$*ù²azertyuiopqsdfghjklmwxcvbn,!<") | dict(zip("&é\"'(-è_ç", DIGITS, strict=True))
FRENCH |= {")": "MINUS", "=": "EQUAL", ";": "COMMA", ":": "PERIOD"}
PLACES = {"COMMA", "PERIOD", "MINUS", "EQUAL"}  # of keys with a label, which differs
UNLABELLED = sorted({name for key in REQUEST_BY_KEY if len(name := split(key)[1]) > 1} - PLACES)


@pytest.mark.parametrize("layout", [GERMAN, SWISS, FRENCH], ids=["German", "Swiss", "French"])
def test_every_request_can_be_made_on_a_keyboard_without_number_pad(layout):
    keys = [*layout.items(), *(("", name) for name in UNLABELLED)]
    held_keys = ["".join(held) for count in range(3) for held in combinations(HELD, count)]
    made = {request_for(label, place, held) for label, place in keys for held in held_keys}
    assert set(REQUEST_BY_KEY.values()) <= made


def test_shift_is_heeded_only_where_that_is_bound():
    assert request_for("l", "L", "SHIFT+") == Request(Command.TOGGLE_LIGHT)
    assert request_for("s", "S", "SHIFT+") == Request(Command.CUT_OUT)
    assert request_for("s", "S", "CTRL+") is None
    assert request_for("s", "S", "ALT+SHIFT+") is None


def test_each_key_asks_for_what_the_table_says():
    for key, request in REQUEST_BY_KEY.items():
        modifiers, name = split(key)
        assert request_for(name if len(name) == 1 else "", name, modifiers) is request


def test_what_one_key_does_another_undoes_step_by_step():
    """Of the commands with two ways to go; places to choose from have none."""
    for binding in BINDINGS:
        ways = set(binding.arguments)
        if not ways or binding.command is Command.CHOOSE_MODEL:
            continue
        back = {(-way[0], -way[1]) if isinstance(way, tuple) else -way for way in ways}
        assert ways == back
        step = 5 if binding.command is Command.SEEK else 1  # seconds, or one
        assert all(max(map(abs, way)) == 1 if isinstance(way, tuple) else abs(way) == step for way in ways)


@pytest.mark.parametrize(
    ("keys", "command", "way"),
    [
        (("LEFT",), Command.MOVE_LIGHT, (-1, 0)),
        (("RIGHT",), Command.MOVE_LIGHT, (1, 0)),
        (("DOWN",), Command.MOVE_MODEL, (0, -1)),
        (("UP",), Command.MOVE_MODEL, (0, 1)),
        (("+", "=", "EQUAL"), Command.LIGHT_STRENGTH, 1),
        (("-", "MINUS"), Command.LIGHT_STRENGTH, -1),
        (("PAGE_UP",), Command.LIGHT_SOFTNESS, 1),
        (("HOME", "["), Command.LIGHT_COLOUR, 1),
        (("END", "]"), Command.LIGHT_COLOUR, -1),
        (("PAGE_UP",), Command.LIGHT_DISTANCE, 1),
        (("PAGE_UP", "["), Command.TURN_MODEL, 1),
        (("PAGE_DOWN", "]"), Command.TURN_MODEL, -1),
        (("+", "=", "EQUAL", "HOME"), Command.SCALE_MODEL, 1),
        (("-", "MINUS", "END"), Command.SCALE_MODEL, -1),
        ((",", "COMMA"), Command.STEP, -1),
        ((".", "PERIOD"), Command.STEP, 1),
        (("LEFT",), Command.SEEK, -5),
        (("Z",), Command.SPEED, -1),
    ],
)
def test_keys_go_the_way_that_the_help_says_first(keys, command, way):
    """Or the other way, for the second of two; keys of another layout for the same go the same way."""
    (binding,) = (each for each in BINDINGS if each.command is command)
    ways = dict(zip((split(key)[1] for key in binding.keys), binding.arguments, strict=True))
    assert [ways[key] for key in keys] == [way] * len(keys)


def test_what_goes_step_by_step_is_repeated_and_nothing_else():
    """But for the speed, of which there are few."""
    stepwise = {binding.command for binding in BINDINGS if binding.arguments}
    assert stepwise - {Command.CHOOSE_MODEL, Command.SPEED} == REPEATED


def test_every_gesture_asks_for_something():
    assert set(COMMAND_BY_GESTURE) == set(Gesture)


def test_modifiers_have_names():
    assert held(0) == ""
    assert held(glfw.MOD_SHIFT | glfw.MOD_CONTROL) == "CTRL+SHIFT+"
    assert held(glfw.MOD_SUPER) == "CTRL+"
    assert held(glfw.MOD_CAPS_LOCK | glfw.MOD_ALT) == "ALT+"


def test_the_help_lists_every_binding():
    assert set(help_rows()) > {(binding.shown, binding.help) for binding in BINDINGS}
    assert all(shown and text for shown, text in help_rows())
