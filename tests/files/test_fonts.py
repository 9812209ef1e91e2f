"""Letters of every script, with the fonts that this test lays out: systems have others, or none."""

import shutil
import unicodedata
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from ashe_live.drawing.contact_sheet import contact_sheet
from ashe_live.files import fonts
from ashe_live.files.fonts import lettering
from ashe_live.render.hud import rows_plate, text_ink, text_width
from ashe_live.tracking.families.page import PrintedPage

DEJAVU = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"  # as Linux has it
PX = 24


def forget() -> None:
    for kept in (fonts.system_fonts, fonts._path_for, text_width, text_ink):
        kept.cache_clear()


@pytest.fixture(autouse=True)
def data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where fonts are looked for: nowhere else, and there are none yet."""
    monkeypatch.setattr(fonts.sys, "platform", "linux")
    monkeypatch.setenv("XDG_DATA_DIRS", str(tmp_path / "data"))
    forget()
    yield tmp_path / "data"
    forget()


@pytest.fixture
def with_font(data_folder: Path) -> None:
    folder = data_folder / "fonts" / "truetype" / "dejavu"
    folder.mkdir(parents=True)
    shutil.copy(DEJAVU, folder)


def family_of(text: str) -> str | None:
    return lettering(text, PX).font.getname()[0]  # type: ignore[union-attr]


@pytest.mark.usefixtures("with_font")
def test_what_pillows_font_has_stays_in_it() -> None:
    text = "light: azimuth 17°, elevation 43° ± 0.8°"
    assert lettering(text, PX).text == text
    assert family_of(text) == family_of("a") != "DejaVu Sans"


@pytest.mark.usefixtures("with_font")
@pytest.mark.parametrize("text", ["Küche", "Łódź", "σ² ≤ 3", "кухня", "straße"])
def test_letters_that_it_lacks_come_from_a_font_of_the_system(text: str) -> None:
    assert lettering(text, PX).text == text
    assert family_of(text) == "DejaVu Sans"


@pytest.mark.usefixtures("with_font")
def test_accents_that_are_letters_of_their_own_are_put_on_theirs() -> None:
    assert lettering(unicodedata.normalize("NFD", "Küche"), PX) == lettering("Küche", PX)


@pytest.mark.parametrize(("text", "plain"), [("Küche é", "Kuche e"), ("日本.mp4", "??.mp4"), ("Ку\u0301хня", "?????")])
def test_without_a_font_for_them_letters_lose_accents_or_are_question_marks(text: str, plain: str) -> None:
    assert lettering(text, PX).text == plain


@pytest.mark.usefixtures("with_font")
def test_of_several_scripts_as_much_is_written_as_one_font_has() -> None:
    assert lettering("日本 é", PX).text == "?? é"


@pytest.mark.usefixtures("with_font")
def test_no_font_is_taken_from_the_current_folder(data_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(data_folder)
    monkeypatch.setenv("XDG_DATA_DIRS", ".:")
    assert lettering("é", PX).text == "e"


def test_a_damaged_font_is_passed_over(data_folder: Path) -> None:
    folder = data_folder / "fonts"
    folder.mkdir(parents=True)
    (folder / fonts.NAMES[0]).write_bytes(DEJAVU.read_bytes()[:1000])
    (folder / fonts.NAMES[1]).write_bytes(b"")
    (folder / fonts.NAMES[2]).mkdir()
    assert lettering("é", PX).text == "e"


def label(text: str) -> np.ndarray:
    return contact_sheet([np.zeros((48, 200, 3), np.uint8)], [text])


def printed(text: str) -> np.ndarray:
    page = PrintedPage.blank((60, 20))
    page.text((30, 10), text)
    return np.asarray(page.image)


@pytest.mark.parametrize("drawn", [lambda text: rows_plate(((text,),), PX), label, printed])
@pytest.mark.parametrize("has_font", [True, False])
def test_pictures_of_different_names_differ(has_font: bool, drawn, request: pytest.FixtureRequest) -> None:
    """Each was a box where a letter was missing."""
    if has_font:
        request.getfixturevalue("with_font")
    one, other = drawn("Büro.mp4"), drawn("Bäro.mp4")
    assert one.shape != other.shape or (one != other).any()
