"""Bad files made from good ones: what an editor, a mail program or a hurry does.

`every(random, kind, good)` makes one of each sort, at places and with numbers that `random` chooses. Each
comes with what its reader owes:

- SAME: nothing that is read has changed, and neither may the result;
- OTHER: the file says something else now, which is read as a gait, a sole or a sand, or refused;
- REFUSED: nobody can read that.
"""

import gzip
import json
import re
from pathlib import Path
from typing import NamedTuple

from motion_files import HUMAN, write_mot, write_table

import footopt as fo
from footopt.gait.gait import HUMAN as JSON

SAME, OTHER, REFUSED = "same", "other", "refused"
EXAMPLES = Path(fo.__file__).parents[1] / "examples"
FOOT = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
NUMBER = re.compile(rb"-?\d+\.\d+(?:[eE][-+]?\d+)?")
#: What stands where a number was, and where a value of JSON was.
ODD_NUMBERS = ("1e999", "nan", "1e308", "9" * 400, "0x10", "abc", "", "12,5", "--1", "1_0", "-1.5", "300")
ODD_VALUES = (None, [], {}, "x", -1, 0, 10**400, float("nan"), True, [1] * 12, [1.5] * 11, "9" * 5000)
KINDS = ("mot", "csv gait", "csv stride", "json", "dxf", "svg", "csv sole", "csv sand")
GAITS, SOLES = KINDS[:4], KINDS[4:7]


class Bad(NamedTuple):
    """A bad file: how it was made, its content and what is owed."""

    how: str
    content: bytes
    owed: str


class Files(dict):
    """Contents by kind; hypothesis warns of arguments that are long when they are shown."""

    def __repr__(self):
        return f"files of {len(self)} kinds"


def good_files(folder):
    """One good file of each kind, as bytes."""
    files = {
        "mot": write_mot(folder / "walk.mot", HUMAN),
        "csv gait": write_table(folder / "walk.csv", HUMAN, 4.4),
        "csv stride": write_table(folder / "stride.csv", HUMAN, 1.0),
        "json": JSON,
        "dxf": fo.write_foot(FOOT, folder / "sole.dxf"),
        "svg": fo.write_foot(FOOT, folder / "sole.svg"),
        "csv sole": fo.write_foot(FOOT, folder / "sole.csv"),
        "csv sand": EXAMPLES / "sand" / "stresses.csv",
    }
    return Files((kind, Path(path).read_bytes()) for kind, path in files.items())


def every(random, kind, good):
    """One bad file of each sort; `random` has the methods of `random.Random`."""
    content, lines = good[kind], good[kind].splitlines(keepends=True)
    a, b = sorted(random.randrange(len(content)) for _ in range(2))
    line = random.randrange(len(lines))
    flipped = bytes([content[a] ^ 1 << random.randint(0, 7)])
    own, csv = kind.split()[0], kind.startswith("csv")
    others = [k for k in good if k.split()[0] != own or (csv and k.split()[1] not in ("gait", "stride"))]
    cases = [
        Bad("empty", b"", REFUSED),
        Bad("blank", b" \n\n\t\n", REFUSED),
        Bad("compressed", gzip.compress(content, mtime=0), REFUSED),
        Bad("zeros", bytes(len(content)), REFUSED),
        Bad("UTF-16", content.decode().encode("utf-16"), REFUSED),
        Bad("Windows' line ends", b"\r\n".join(content.splitlines()) + b"\r\n", SAME),
        Bad("no last line end", content.rstrip(), SAME),
        Bad("byte order mark", b"\xef\xbb\xbf" + content, OTHER if kind == "dxf" else SAME),
        Bad(f"cut at {b}", content[:b], OTHER),
        Bad(f"a hole from {a} to {b}", content[:a] + content[b:], OTHER),
        Bad("one long line", content.replace(b"\n", b" "), OTHER),
        Bad(f"latin-1 at {a}", content[:a] + b"\xfc" + content[a:], OTHER),
        Bad(f"a bit of byte {a}", content[:a] + flipped + content[a + 1 :], OTHER),
        Bad(f"line {line + 1} missing", b"".join(lines[:line] + lines[line + 1 :]), OTHER),
        Bad(f"line {line + 1} twice", b"".join(lines[: line + 1] + lines[line:]), OTHER),
        *(Bad(f"a {k} file", good[k], OTHER if csv and k.startswith("csv") else REFUSED) for k in others),
    ]
    numbers = list(NUMBER.finditer(content))
    for new in ODD_NUMBERS:
        begin, end = random.choice(numbers).span()
        cases.append(Bad(f"{new[:9]!r} at {begin}", content[:begin] + new.encode() + content[end:], OTHER))
    if kind == "json":
        cases += [Bad("a value", json.dumps(tree(random, content)).encode(), OTHER) for _ in range(10)]
    return cases


def tree(random, content):
    """A JSON tree in which one value is odd, or missing."""
    whole = json.loads(content)
    holder, key = random.choice(list(_places(whole)))
    if random.random() < 0.1:
        del holder[key]
    else:
        holder[key] = random.choice(ODD_VALUES)
    return whole


def _places(tree):
    """Where the values of a JSON tree are: what holds them, and their key there."""
    for key, value in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
        yield tree, key
        if isinstance(value, dict | list):
            yield from _places(value)
