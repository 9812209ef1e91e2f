"""Values between processes: they arrive whole, or not at all."""

import multiprocessing
import os
import struct

import numpy as np
import pytest

from ashe_live.process.pipes import receive_value, send_value


def test_arrays_arrive_as_they_were_sent() -> None:
    receiver, sender = multiprocessing.Pipe(duplex=False)
    send_value(sender, {"picture": np.arange(12).reshape(3, 4), "name": "a"})
    received = receive_value(receiver)
    assert received["name"] == "a"
    np.testing.assert_array_equal(received["picture"], np.arange(12).reshape(3, 4))
    assert not received["picture"].flags.writeable, "it lies where it came, and was not copied"


@pytest.mark.parametrize("sent", [b"", struct.pack("!i", 100) + b"half"])
def test_a_sender_that_was_killed_is_an_end_wherever_it_was(sent: bytes) -> None:
    """By the limits of its process, for example, while it sent what it had made."""
    receiver, sender = multiprocessing.Pipe(duplex=False)
    os.write(sender.fileno(), sent)
    sender.close()
    with pytest.raises(EOFError):
        receive_value(receiver)
