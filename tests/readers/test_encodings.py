"""Files in the encoding that they declare, and one message for each rule of XML that they break."""

from __future__ import annotations

from pathlib import Path

import pytest

import kanegen as kg
from kanegen.readers.encoding import xml_text
from tests.support.paths import FROM_REPORTS
from tests.support.urdf import BASE, axis, joint, link

NAMES = "Grüße 左腿"
BODY = f'<robot name="r"><!-- {{}} -->{BASE}{link("a")}{joint("j", "base", "a", axis("0 0 1"))}</robot>'


@pytest.mark.parametrize("name", ["xml_latin1_declared", "xml_gbk"])
def test_declared_encodings_of_public_reports(name: str) -> None:
    assert kg.build(kg.load(FROM_REPORTS / f"{name}.urdf")).mass_matrix([0.4]) == [[0.1]]


@pytest.mark.parametrize(
    ("name", "line", "rule"),
    [
        (
            "xml_blank_line_first",
            2,
            r"<\?xml \.\.\.\?> may only stand at the very beginning\. Delete the blanks",
        ),
        (
            "xml_double_hyphen",
            2,
            r"a comment may hold '--' only in its end '-->'\. Delete one of the hyphens",
        ),
    ],
)
def test_rules_that_public_reports_break(name: str, line: int, rule: str) -> None:
    with pytest.raises(kg.ReadError, match=rf"{name}\.urdf:{line}: not well-formed XML: {rule}"):
        kg.load(FROM_REPORTS / f"{name}.urdf")


@pytest.mark.parametrize(
    ("declared", "codec", "comment"),
    [
        ("ISO-8859-1", "latin-1", "Grüße"),
        ("windows-1252", "cp1252", "Grüße €"),
        ("gb2312", "gb18030", "左腿 鎔"),  # the second word is in GBK, but not in GB 2312
        ("Shift_JIS", "shift_jis", "左足"),
        ("KOI8-R", "koi8-r", "нога"),
        ("us-ascii", "ascii", "leg"),
        ("UTF-8", "utf-8", NAMES),
        ("utf8", "utf-8-sig", NAMES),
        ("UTF-16", "utf-16", NAMES),
        ("UTF-16", "utf-16-le", NAMES),
        ("utf-16be", "utf-16-be", NAMES),
        ("UTF-8", "utf-16", NAMES),
        ("UTF-32", "utf-32", NAMES),
    ],
)
def test_every_encoding(tmp_path: Path, declared: str, codec: str, comment: str) -> None:
    """A byte order mark, or the bytes of the first characters, weigh more than the declaration."""
    text = f"<?xml version='1.0' encoding=\"{declared}\"?>\n{BODY.format(comment)}"
    assert xml_text(text.encode(codec), "r") == text
    path = tmp_path / "r.urdf"
    path.write_bytes(text.encode(codec))
    assert kg.load(path).freedom_names == ("j",)


def test_utf8_is_the_default(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    for text in (BODY.format(NAMES), f'<?xml version="1.0"?>{BODY.format(NAMES)}'):
        path.write_text(text, encoding="utf-8")
        assert kg.load(path).freedom_names == ("j",)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            b"<robot>\n\xe9</robot>",
            r":2: byte 0xe9 is not UTF-8\. Save it as UTF-8, or declare its encoding: <\?xml",
        ),
        (
            b'<?xml version="1.0"\nencoding="ascii"?>\n\n<robot>\xc3\xa9</robot>',
            r":4: byte 0xc3 is not ASCII\. This is the encoding that line 2 declares\.",
        ),
        (
            b'<?xml version="1.0" encoding="latin-9x"?><robot/>',
            r":1: the encoding 'latin-9x' is unknown\. Save the",
        ),
        (b'<?xml version="1.0" encoding="rot13"?><robot/>', r":1: the encoding 'rot13' is unknown\."),
        (b'<?xml version="1.0" encoding="punycode"?><robot/>', r":1: the encoding 'punycode' is unknown\."),
        (b'<?xml version="1.0" encoding="undefined"?><robot/>', r":1: the encoding 'undefined' is unknown\."),
        (
            b'<?xml version="1.0" encoding="UTF-16"?><robot/>',
            r":1: the file declares 'UTF-16' but is not in it\. De",
        ),
        (
            b'<?xml version="1.0" encoding="cp037"?><robot/>',
            r":1: the file declares 'cp037' but is not in it\.",
        ),
        (b"\xff\xfe<\0r", r":1: byte 0x72 is not UTF-16-LE\. Its first bytes declare utf-16-le\."),
        (b"\xff\xfe<\0r\0\0\xd8", r":1: byte 0x00 is not UTF-16-LE\. Its first bytes declare utf-16-le\."),
        (b"\xef\xbb\xbf<r>\xff</r>", r":1: byte 0xff is not UTF-8\. Its first bytes declare utf-8\."),
        (b"<a><!-- x --- ></a>", r":1: not well-formed XML: a comment may hold '--' only in its end"),
        (b"<a>\n<b>\n</a>", r":3: not well-formed XML: mismatched tag: <b> of line 2 is not closed\."),
        (b"<a>\n<b>\n", r":3: not well-formed XML: no element found: <b> of line 2 is not closed\."),
        (b"<a><!-- \x01 --></a>", r":1: not well-formed XML: not well-formed \(invalid token\)\."),
        (b"<a/>\0", r":1: not well-formed XML: "),
    ],
)
def test_one_message_with_its_line(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "r.urdf"
    path.write_bytes(data)
    with pytest.raises(kg.ReadError, match=rf"^{path}{message}"):
        kg.load(path)


def test_bytes_of_any_kind_end_in_an_error(tmp_path: Path) -> None:
    """Every damaged byte of a declaration gives an error, or a robot."""
    path = tmp_path / "r.urdf"
    whole = f'<?xml version="1.0" encoding="utf-8"?>\n{BODY.format("x")}'.encode()
    for place in range(45):
        for byte in (0, 32, 45, 65, 128, 255):
            path.write_bytes(whole[:place] + bytes([byte]) + whole[place + 1 :])
            try:
                assert kg.load(path).freedom_names == ("j",)
            except kg.ReadError as error:
                assert str(error).startswith(f"{path}:")
