"""Which JPEGs are refused before anybody decodes them: by their parts, of which a scan is one (ITU-T T.81, B.1.1)."""

import io
from pathlib import Path

import pytest

from ashe_live.errors import UserError
from ashe_live.files.jpeg import MOST_SCANS, MOST_SEGMENTS, START, refuse_endless, why_endless

END = b"\xff\xd9"
METADATA = b"\xff\xe1\x00\x04\xff\xda"  # whose content looks like the beginning of a scan
SCAN = b"\xff\xda\x00\x02"
# Bytes of a scan that are no parts: stuffing, restarts, fill.
DATA = b"\x12\xff\x00\xff\xd0\x34\xff\xd7\xff\x01"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (START + METADATA * MOST_SCANS + (SCAN + DATA) * MOST_SCANS + END, None),
        (START + (SCAN + DATA) * (MOST_SCANS + 1) + END, f"has its picture in {MOST_SCANS + 1} scans"),
        (START + METADATA * MOST_SEGMENTS + END, None),
        (START + METADATA * (MOST_SEGMENTS + 1) + END, f"is in more than {MOST_SEGMENTS:,} parts"),
        (START + SCAN + END + SCAN * (MOST_SCANS + 1), None),
        (START + b"\xff" * 9 + SCAN[1:] + END, None),
        (START + METADATA[:3], None),
        (b"x" + START + SCAN * (MOST_SCANS + 1), None),
    ],
    ids=["most scans", "too many scans", "most parts", "too many parts", "behind its end", "fill", "cut", "no JPEG"],
)
def test_what_would_take_very_long_is_refused_and_nothing_that_programs_write(content: bytes, said: str | None) -> None:
    why = why_endless(content)
    assert why is None if said is None else why is not None and why.startswith(said)
    file = io.BytesIO(content)
    file.seek(5)
    if said is None:
        refuse_endless(Path("a.jpg"), file)
    else:
        with pytest.raises(UserError, match=rf"a\.jpg {said}.*: save it again as JPEG"):
            refuse_endless(Path("a.jpg"), file)
    assert file.tell() == 0
