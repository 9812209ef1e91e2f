"""Names that break programs, and numbers that do."""

from hypothesis import strategies as st

LONGEST_NAME_BYTES = 255
# To be found again in what a program writes: no program has it from elsewhere.
SEQUENCE = "\x1b[3;41mPWN"

ADDRESSES = (
    "http:/127.0.0.1:{port}/z.mp4",
    "http:127.0.0.1:{port}?a.mp4",
    "http://127.0.0.1:{port}/z.mp4",
    "https://127.0.0.1:{port}/z.mp4",
    "tcp:127.0.0.1:{port}",
    "tcp://127.0.0.1:{port}?x.mp4",
    "rtmp://127.0.0.1:{port}/a",
    "rtsp://127.0.0.1:{port}/a",
    "ftp://127.0.0.1:{port}/a.mp4",
    "async:http:127.0.0.1:{port}?a.mp4",
    "cache:tcp:127.0.0.1:{port}",
    "hls+http://127.0.0.1:{port}/a.m3u8",
)
PROTOCOLS = (
    "concat:clip.mp4|clip.mp4",
    "subfile,,start,0,end,900,,:clip.mp4",
    "file:clip.mp4",
    "file:/etc/passwd",
    "walk:1.mp4",
    "pipe:0",
    "pipe:",
    "data:video/mp4;base64,AAAA",
    "crypto:clip.mp4",
    "fd:0",
    "unix:socket",
    "md5:clip.mp4",
    "tee:a|b",
)
RAW = (
    f"a{SEQUENCE}.mp4",
    "\x1b]0;title\x07.mp4",
    "new\nline.mp4",
    "re\rturn.png",
    "tab\t.mp4",
    "\x08\x7f.mp4",
    "\x9b31m.mp4",
    "\udcff\udcfe.mp4",
    "\udcff.png",
    "\udc80",
    "\u202egpj.mp4",
    "\u2066a\u2069.png",
    "line\u2028para\u2029.mp4",
    "\ufeffbom.mp4",
    "é.mp4",
    "e\u0301.mp4",
    "\U0001f600.mp4",
)
SHELL = (
    "-rf.mp4",
    "--help",
    "-",
    "--",
    "-h",
    "--out",
    "%s%n%d%08x.mp4",
    "%03d.png",
    "$(reboot).mp4",
    "`id`.mp4",
    "${HOME}.mp4",
    "~nouser",
    "~",
    "~/clip.mp4",
    "*",
    "*.mp4",
    "**",
    "**/*",
    "?",
    "[!]",
    "[a-z].mp4",
    "{0}.mp4",
    "{a,b}.mp4",
    "@argfile",
    "a b.mp4",
    " ",
    "",
)
MARKUP = ("[bold red]x[/].mp4", "[/]", "[link=http://x]y.mp4", ":smile:.mp4", "<script>alert(1)</script>.png", "\\")
SHAPES = (
    ".",
    "..",
    "...",
    "/",
    "//",
    "./clip.mp4",
    "../outside/thesis.txt",
    ".hidden.mp4",
    "trailing.",
    "trailing ",
    "CON",
    "clip.MP4",
    "clip.mp4/",
    "clip.mp4/x.mp4",
    "missing/x.mp4",
    "a" * LONGEST_NAME_BYTES,
    "a" * (LONGEST_NAME_BYTES - 4) + ".mp4",
    "a" * (LONGEST_NAME_BYTES - 4) + ".png",
    "a" * (LONGEST_NAME_BYTES - 5) + ".json",
    "a" * (LONGEST_NAME_BYTES - 15) + ".mp4",
    "ä" * 120 + ".mp4",
    "a" * (LONGEST_NAME_BYTES + 1),
    "a/" * 2100 + "b.mp4",
    "/dev/full",
    "/dev/zero",
    "/dev/stdin",
    "/dev/tty",
    "/proc/self/mem",
    "/proc/self/fd/0",
)
SUFFIXES = ("", ".mp4", ".MP4", ".mkv", ".png", ".jpg", ".json", ".html", ".pdf", ".toml", ".glb", ".gltf", ".obj", ".patt")
LETTERS = st.one_of(
    st.characters(codec="utf-8", exclude_characters="\0/"),
    st.sampled_from([chr(0xDC00 + byte) for byte in (0x80, 0xC3, 0xE2, 0xFF)]),  # bytes that are no UTF-8
    st.sampled_from("\x1b\x07\r\n\t\x9b\x85\u202e\u2028[]{}%:|,;@~*?!-\\'\" "),
)

free_names = st.builds(lambda stem, suffix: stem + suffix, st.text(LETTERS, max_size=12), st.sampled_from(SUFFIXES)).filter(
    lambda name: name not in ("", ".", "..") and len(name.encode("utf-8", "surrogateescape")) <= LONGEST_NAME_BYTES
)
hostile_names = st.one_of(*map(st.sampled_from, (ADDRESSES, PROTOCOLS, RAW, SHELL, MARKUP, SHAPES)), free_names)

INTEGERS = ("0", "1", "2", "-1", "00", "+1", "1_0", " 5", "5 ", "1.5", "1e3", "", "nan", "²", "１２", "9" * 30, "9" * 5000)
LARGE = ("2147483647", "2147483648", "4294967296", "9223372036854775808", "1" + "0" * 400)
FLOATS = (
    "0",
    "-0.0",
    "55",
    "0.08",
    "1e-320",
    "1e-300",
    "1e300",
    "1e400",
    "1e20",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "179.999999999",
    "1.0000001",
    "1,5",
    "",
)
SIZES = ("64x48", "64x48", "1x1", "2x2", "3x1", "1x4096", "16384x1", "0x5", "-1x5", "x", "1x", "²x²", "1e3x5", "99999x9", "")
MARKERS = (
    "aruco:4x4_50:0",
    "aruco:4x4_50:1",
    "aruco:4x4_50:-1",
    "aruco:4x4_50:99999999999999999999",
    "aruco:6x6_1000:999",
    "aruco:nonsense:0",
    "aruco::",
    ":",
    "",
    "apriltag:36h11:5",
    "apriltag:36h11:x",
    "pattern:",
    "pattern:fifo",
    "pattern:clip.mp4",
    "image:photo.png",
    "image:dot.png",
    "image:fifo",
    "image:",
    "image:zero",
    "grid:4x4_50:2x2",
    "grid:4x4_50:0x0",
    "grid:4x4_50:99999x99999",
    "grid:4x4_1000:1x1000000000",
    "grid:4x4_50:-1x-1",
    "grid:4x4_50:²x2",
    f"aruco:{SEQUENCE}:0",
    "\udcff",
)
