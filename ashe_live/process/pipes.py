"""Large values between processes: arrays go through the pipe from where they lie.

Copying megabytes, as `Connection.send` does, would hold the interpreter's lock and stall the picture.
"""

import pickle
from multiprocessing.connection import Connection
from typing import Any


def send_value(connection: Connection, value: object) -> None:
    """Sends a picklable value. Raises OSError when the other side has gone."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(value, protocol=5, buffer_callback=buffers.append)
    connection.send((len(buffers), head))
    for buffer in buffers:
        connection.send_bytes(buffer.raw())


def receive_value(connection: Connection) -> Any:
    """The value that `send_value` sent, its arrays read-only; raises EOFError when the other side has gone."""
    try:
        count, head = connection.recv()
        buffers = [connection.recv_bytes() for _ in range(count)]
    except OSError as error:  # it was ended in the middle of the value
        raise EOFError from error
    return pickle.loads(head, buffers=buffers)
