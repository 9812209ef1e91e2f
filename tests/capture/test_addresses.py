"""A clip is a file: no name and no content of one makes the program ask a network or open another file."""

import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.opening import open_source
from ashe_live.errors import UserError


class Listener:
    """Counts who calls."""

    def __init__(self) -> None:
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._socket.getsockname()[1]
        self.calls = 0
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            self.calls += 1
            connection.close()

    def close(self) -> None:
        self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        self._thread.join(10)


@pytest.fixture
def listener() -> Iterator[Listener]:
    heard = Listener()
    yield heard
    heard.close()


@pytest.fixture
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


NAMES = ["http:/127.0.0.1:{port}/z.mp4", "http:127.0.0.1:{port}?a.mp4", "tcp:127.0.0.1:{port}", "walk:1.mp4"]
NAMES += ["concat:a.mp4|b.mp4", "subfile:,start,0,end,9,,:a.mp4", "file:a.mp4", "data:a.mp4", "-i.mp4", "%03d.mp4"]


@pytest.mark.usefixtures("in_folder")
@pytest.mark.parametrize("name", NAMES)
def test_a_file_of_any_name_is_the_clip_that_it_is(name: str, clip: Path, listener: Listener) -> None:
    path = Path(name.format(port=listener.port))
    path.parent.mkdir(parents=True, exist_ok=True)
    clip.rename(path)
    with open_source(path) as source:
        assert len(list(source)) == 60
    assert listener.calls == 0


@pytest.mark.usefixtures("in_folder")
@pytest.mark.parametrize("name", NAMES)
def test_without_such_a_file_there_is_none(name: str, listener: Listener) -> None:
    with pytest.raises(UserError, match=r"there is no file|is an address"):
        open_source(name.format(port=listener.port))
    assert listener.calls == 0


CONTENTS = {
    "HLS": "#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\n{target}\n#EXT-X-ENDLIST\n",
    "concat": "ffconcat version 1.0\nfile '{target}'\n",
    "DASH": '<?xml version="1.0"?><MPD xmlns="urn:mpeg:dash:schema:mpd:2011" type="static"><Period><AdaptationSet>'
    '<Representation id="1" mimeType="video/mp4"><BaseURL>{target}</BaseURL></Representation></AdaptationSet></Period>'
    "</MPD>",
    "SDP": "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video {port} RTP/AVP 96\n",
    "SMIL": "[playlist]\nFile1={target}\nNumberOfEntries=1\n",
}


@pytest.mark.usefixtures("in_folder")
@pytest.mark.parametrize("kind", CONTENTS)
@pytest.mark.parametrize("target", ["http://127.0.0.1:{port}/a.ts", "secret.mp4"])
def test_a_list_of_addresses_is_no_clip(kind: str, target: str, clip: Path, listener: Listener) -> None:
    clip.rename("secret.mp4")
    where = target.format(port=listener.port)
    Path("list.mp4").write_text(CONTENTS[kind].format(target=where, port=listener.port))
    with pytest.raises(UserError, match="is not a clip"):
        ClipSource("list.mp4")
    assert listener.calls == 0
