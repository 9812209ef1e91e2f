"""A program that breaks the promise its first argument names: what the oracle must notice."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

sin, port = sys.argv[1], int(sys.argv[2])
match sin:
    case "traceback":
        raise ValueError("unforeseen")
    case "status":
        sys.exit(7)
    case "silence":
        sys.exit(2)
    case "two lines":
        sys.stderr.write("ashe-live: one\nashe-live: two\n")
        sys.exit(2)
    case "log":
        sys.stderr.write("[mov,mp4 @ 0x55] moov atom not found\n")
    case "endless line":
        sys.stderr.write(f"ashe-live: {'a' * 5000}\n")
    case "sequence":
        print("\x1b[3;41mPWN")
    case "sequence on the terminal":
        os.write(1, b"\x1b[3;41mPWN")
    case "changed":
        Path("../outside/thesis.txt").write_text("")
    case "touched":
        os.utime("clip.mp4")
    case "replaced":
        Path("copy").write_bytes(Path("clip.mp4").read_bytes())
        Path("copy").replace("clip.mp4")
    case "removed":
        Path("clip.mp4").unlink()
    case "left over":
        Path(".walk.partial.mp4").write_bytes(b"")
    case "half":
        Path("walk.json").write_text('{"schema": 1, "frames": [')
    case "not written":
        print("saved walk.json")
    case "survivor":
        subprocess.Popen(["sleep", "100"], start_new_session=True)
    case "call":
        socket.create_connection(("127.0.0.1", port))
    case "foreign code":
        sys.path.insert(0, "")
        del sys.modules["pickle"]
        __import__("pickle")
    case "hang":
        time.sleep(100)
