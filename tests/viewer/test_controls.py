"""The table of keys."""

from collections import Counter

from ashe_live.viewer.controls import BINDINGS, REQUEST_BY_KEY, SHIFT, Command, Request, help_rows, request_for
from ashe_live.viewer.window import NAME_BY_GLFW_KEY


def test_every_command_is_bound_exactly_once():
    assert Counter(binding.command for binding in BINDINGS) == Counter(Command)


def test_no_key_asks_for_two_things():
    keys = [key for binding in BINDINGS for key in binding.keys]
    assert len(keys) == len(set(keys)) == len(REQUEST_BY_KEY)


def test_glfw_knows_every_key():
    assert set(NAME_BY_GLFW_KEY.values()) == {key.removeprefix(SHIFT) for key in REQUEST_BY_KEY}


def test_shift_changes_only_what_the_table_says():
    for key, request in REQUEST_BY_KEY.items():
        assert request_for(key.removeprefix(SHIFT), key.startswith(SHIFT)) is request
    assert request_for("P", True) == request_for("P", False) == Request(Command.PAUSE)
    assert request_for("no such key", True) is request_for(None, False) is None


def test_the_number_keys_choose_by_place():
    chosen = [REQUEST_BY_KEY[key] for key in "123456789"]
    assert chosen == [Request(Command.CHOOSE_MODEL, place) for place in range(9)]


def test_the_help_lists_every_binding():
    assert help_rows() == tuple((binding.shown, binding.help) for binding in BINDINGS)
    assert all(shown and text for shown, text in help_rows())
