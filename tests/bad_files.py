"""Bad files made from good ones: what a disk, an editor, a mail program or a hurry does.

`every(random, kind, good)` makes one of each sort, at places and with numbers that `random` chooses. Each
comes with what its reader owes:

- SAME: nothing that is read has changed, and neither may the result;
- LESS: part of the file is missing or there twice; what is read must be a part of what was there;
- OTHER: the file says something else now, which is read right, or refused;
- REFUSED: nobody can read that.
"""

import gzip
import json
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from motion_files import OPENSIM, record, turned, write_c3d, write_mot, write_nexus, write_table, write_trc

import footopt as fo
from footopt.gait.gait import HUMAN

SAME, LESS, OTHER, REFUSED = "same", "less", "other", "refused"
EXAMPLES = Path(fo.__file__).parents[1] / "examples"
FOOT = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
NUMBER = re.compile(rb"-?\d+\.\d+(?:[eE][-+]?\d+)?")
NUMERIC = re.compile(r"[-+.\deE\s,]+")
#: What stands where a number was.
ODD_NUMBERS = (
    "1e999",
    "-inf",
    "nan",
    "1e308",
    "9" * 400,
    "0x10",
    "abc",
    "-",
    "",
    "12,5",
    "1e5",
    "--1",
    "1_0",
)
#: What stands where a value of JSON was.
ODD_VALUES = (None, [], {}, "x", -1, 0, 10**400, float("nan"), float("inf"), True, [1] * 12, [0] * 11,
              [1.5] * 11, "9" * 5000)  # fmt: skip


class Bad(NamedTuple):
    """A bad file: how it was made, its content and what is owed."""

    how: str
    content: bytes
    owed: str

    def __repr__(self):
        return f"{self.how} ({self.owed})"


class Kind(NamedTuple):
    """A format, and the mistakes that only it knows.

    `words` are texts and what stands in their place; `exchanged` are names that change places; `factors` are
    mistakes of units by column; `owed` says what is owed to a new word, where it is not OTHER.
    """

    words: Mapping[str, tuple[str, ...]]
    exchanged: tuple[tuple[str, str], ...] = ()
    factors: Mapping[int, tuple[float, ...]] = MappingProxyType({})
    owed: Mapping[str, str] = MappingProxyType({})


class Files(dict):
    """Contents by kind; hypothesis warns of arguments that are long when they are shown."""

    def __repr__(self):
        return f"files of {len(self)} kinds"


RADIANS = np.pi / 180
JOINTS = (("R_HJC", "R_AJC"), ("R_KJC", "R_AJC"), ("R_HJC", "R_KJC"), ("R_KJC", "R_Heel"))
TIME = (1000.0, 60.0, 1 / 60, -1.0, 0.0)
NAMES = {"R_KJC": ("R_AJC", "R_HJC_"), "R_HJC": ("knee?",), "R_": ("S_",)}
SEPARATORS = {".": (",",), ",": (";",), "\t": (" ", ",")}
STRESS = (1e6, 1e3, -1.0, 0.0)
KINDS = {
    "trc": Kind(
        {"\tmm\t": ("\tm\t", "\tcm\t", "\tin\t", "\t\t", "\tMM\t"), "60.00\t60": ("100.00\t60", "0\t60"),
         "Time": ("Zeit",), "Frame#": ("Bild",), "NumFrames": ("Frames",)} | NAMES | SEPARATORS,
        JOINTS, {1: TIME}, {"\tMM\t": SAME, "Zeit": SAME, "Frames": SAME, "\tm\t": REFUSED, "Bild": REFUSED},
    ),
    "c3d": Kind({}),
    "mot": Kind(
        {"inDegrees=yes": ("inDegrees=no", "inDegrees=maybe"), "inDegrees=yes\n": ("",),
         "nRows=": ("nRows=1",), "nColumns=5": ("nColumns=x",), "endheader": ("header ends",),
         "time": ("zeit",),
         "knee_angle_r": ("knee_angle_l",), "hip_flexion_r": ("knee_angle_r",), "pelvis_tilt": ("tilt",)}
        | SEPARATORS,
        (("hip_flexion_r", "knee_angle_r"), ("pelvis_tilt", "hip_flexion_r")), {0: TIME},
        {"": SAME, "inDegrees=no": REFUSED, "inDegrees=maybe": REFUSED},
    ),
    "csv gait": Kind(
        {"thigh,knee,foot": ("thigh,knee,knee",), "time": ("clock",)} | SEPARATORS,
        (("thigh", "knee"), ("time", "knee")), {0: TIME, 1: (RADIANS,), 2: (-1.0,)},
    ),
    "csv stride": Kind({"time": ("clock",)} | SEPARATORS, (("thigh", "knee"),), {0: TIME, 2: (-1.0,)}),
    "csv markers": Kind(
        {"mm": ("m", "cm", "MM", ""), "Trajectories": ("Model Outputs",), "Frame": ("Bild",),
         "Trajectories\r\n60": ("Trajectories\r\n0", "Trajectories"), "Sandra:": ("",), "X,Y,Z": ("Y,X,Z",),
         "Sub Frame": ("Subframe",)} | NAMES | SEPARATORS,
        JOINTS, {}, {"MM": SAME, "Subframe": SAME, "m": REFUSED},
    ),
    "json": Kind({"0.": (".0",), "period_s": ("period",)}, (("knee", "thigh"),)),
    "dxf": Kind({"ENTITIES": ("ENTRAILS",), "AC1024": ("AC9999",)}),
    "dxf lines": Kind({"ENTITIES": ("ENTRAILS",)}),
    "svg": Kind({'mm"': ('m"', 'furlong"'), "viewBox": ("view",), " L ": (" Q ",), "M ": ("X ",),
                 "<svg": ("<html",), "</svg>": ("",)}),
    "csv sole": Kind({"x_mm,z_mm": ("x_px,z_px", "a,b")} | SEPARATORS, (), {1: (-1.0,)}),
    "csv sand": Kind(
        {"beta,gamma": ("a,b",)} | SEPARATORS,
        (("beta", "gamma"), ("alpha_x", "alpha_z"), ("alpha_x", "beta")),
        {0: (-1.0, RADIANS), 1: (-1.0, RADIANS), 2: STRESS, 3: STRESS},
    ),
}  # fmt: skip
GAITS = ("trc", "mot", "c3d", "csv gait", "csv stride", "csv markers", "json")
SOLES = ("dxf", "dxf lines", "svg", "csv sole")


def good_files(folder):
    """One good file of each kind, as bytes."""
    gait = fo.Gait.human()
    t, places = record(gait, strides=4.3, rate=60.0)
    places = turned({name: p for name, p in places.items() if name not in ("L_Heel", "L_MT2")}, 180, "y")
    files = {
        "trc": write_trc(folder / "walk.trc", t, places),
        "mot": write_mot(folder / "walk.mot", gait, OPENSIM, rate=60.0),
        "c3d": write_c3d(folder / "walk.c3d", t, places),
        "csv gait": write_table(folder / "walk.csv", gait, 4.4),
        "csv markers": write_nexus(folder / "markers.csv", t, places),
        "csv stride": write_table(folder / "stride.csv", gait, 1.0),
        "json": HUMAN,
        "dxf": FOOT.to_file(folder / "sole.dxf"),
        "dxf lines": EXAMPLES / "sole" / "rocker.dxf",
        "svg": FOOT.to_file(folder / "sole.svg"),
        "csv sole": FOOT.to_file(folder / "sole.csv"),
        "csv sand": EXAMPLES / "sand" / "stresses.csv",
    }
    return Files((kind, Path(path).read_bytes()) for kind, path in files.items())


def every(random, kind, good):
    """One bad file of each sort; `random` has the methods of `random.Random`."""
    cases = cut_or_foreign(random, kind, good)
    if kind != "c3d":
        for changed in (other_text, other_number, other_word, other_lines):
            cases += changed(random, kind, good)
    if KINDS[kind].factors:
        cases += other_column(random, kind, good)
    if kind == "json":
        cases += [Bad("a value", json.dumps(tree(random, good[kind])).encode(), OTHER) for _ in range(10)]
    return cases


def cut_or_foreign(random, kind, good):
    """What becomes of any file: it breaks off, has a hole, or another format."""
    content, name = good[kind], kind.split()
    end = len(content) - 3
    begin, stop = sorted((random.randint(0, end), random.randint(0, end)))
    before = bytes(random.randint(0, 255) for _ in range(random.randint(1, 300)))
    csv_gaits = ("csv gait", "csv stride", "csv markers")
    others = [k for k in good if k.split()[0] != name[0] or ("csv" in k and k.split()[1] != name[1])]
    return [
        Bad("empty", b"", REFUSED),
        Bad("blank", b" \n\n\t\n", REFUSED),
        Bad("compressed", gzip.compress(content, mtime=0), REFUSED),
        Bad("zeros", bytes(len(content)), REFUSED),
        Bad(f"cut at {stop}", content[:stop], LESS),
        Bad("its last bytes cut off", content[:-40], LESS),
        Bad("its begin alone", content[:813], LESS),
        Bad(f"a hole from {begin} to {stop}", content[:begin] + content[stop:], OTHER),
        Bad(f"{before!r} before", before + b"\n" + content, OTHER),
        *(Bad(f"a {k} file", good[k], OTHER if {kind, k} <= {*csv_gaits} else REFUSED) for k in others),
    ]


def other_text(random, kind, good):
    """Another encoding or other line ends; a byte or bit that is wrong."""
    content = good[kind]
    text, at, bit = content.decode(), random.randint(0, len(content) - 1), random.randint(0, 7)
    flipped = bytes([content[at] ^ 1 << bit])
    return [
        Bad("Windows' line ends", b"\r\n".join(content.splitlines()) + b"\r\n", SAME),
        Bad("no last line end", content.rstrip(), SAME),
        Bad("byte order mark", b"\xef\xbb\xbf" + content, OTHER if "dxf" in kind else SAME),
        Bad("UTF-16", text.encode("utf-16"), REFUSED),
        Bad("UTF-16 without a mark", text.encode("utf-16-le"), REFUSED),
        Bad("one long line", content.replace(b"\n", b" "), OTHER),
        Bad("a long cell", content + b"1" * 300_000 + b"\n", OTHER),
        Bad("many columns", content + b"1," * 100_000 + b"1\n", OTHER),
        Bad(f"a zero byte at {at}", content[:at] + b"\0" + content[at:], OTHER),
        Bad(f"latin-1 at {at}", content[:at] + b"\xfc" + content[at:], OTHER),
        Bad(f"bit {bit} of byte {at}", content[:at] + flipped + content[at + 1 :], OTHER),
    ]


def other_lines(random, kind, good):
    """A line that is missing, there twice or in another's place."""
    lines = good[kind].splitlines(keepends=True)
    a, b = random.randint(0, len(lines) - 1), random.randint(0, len(lines) - 1)
    middle = len(lines) // 2
    swapped = [*lines]
    swapped[a], swapped[b] = lines[b], lines[a]
    return [
        Bad(f"cut at line {a + 1}", b"".join(lines[:a]), LESS),
        Bad(f"line {a + 1} missing", b"".join(lines[:a] + lines[a + 1 :]), LESS),
        Bad(f"lines {a + 1} to {b} missing", b"".join(lines[:a] + lines[max(a, b) :]), LESS),
        Bad("ten lines of the middle missing", b"".join(lines[:middle] + lines[middle + 10 :]), LESS),
        Bad(f"line {a + 1} twice", b"".join(lines[: a + 1] + lines[a:]), LESS),
        Bad(f"lines {a + 1} and {b + 1} exchanged", b"".join(swapped), OTHER),
    ]


def other_number(random, kind, good):
    """One number that is odd, three times as large, without its point, or negative."""
    content, cases = good[kind], []
    numbers = list(NUMBER.finditer(content))
    for new in (*ODD_NUMBERS, *2 * ("three times", "without its point", "negative")):
        number = random.choice(numbers)
        old = number[0].decode()
        near = {"three times": f"{3 * float(old):.5f}", "without its point": old.replace(".", ""),
                "negative": "-" + old.lstrip("-")}  # fmt: skip
        new = near.get(new, new)
        changed = content[: number.start()] + new.encode() + content[number.end() :]
        cases.append(Bad(f"{new[:9]!r} for {old} at {number.start()}", changed, OTHER))
    return cases


def other_word(random, kind, good):
    """Other names and units, and other separators."""
    text, known = good[kind].decode(), KINDS[kind]
    cases = [Bad(f"{new!r} for {old!r}", text.replace(old, new).encode(), known.owed.get(new, OTHER))
             for old, news in known.words.items() if old in text for new in news]  # fmt: skip
    for a, b in known.exchanged:
        swapped = text.replace(a, "\0").replace(b, a).replace("\0", b)
        cases.append(Bad(f"{a} and {b} exchanged", swapped.encode(), OTHER))
    return cases


def other_column(random, kind, good):
    """A column in another unit, without values, missing or there twice."""
    lines = good[kind].decode().splitlines()
    tab = "\t" if "\t" in lines[-1] else ","
    wide = len(lines[-1].split(tab))
    rows = [cells for line in lines if len(cells := line.split(tab)) == wide and NUMERIC.fullmatch(line)]
    at = random.randint(0, wide - 1)
    changes = {
        f"'nan' in column {at}": lambda r: [*r[:at], "nan", *r[at + 1 :]],
        f"nothing in column {at}": lambda r: [*r[:at], "", *r[at + 1 :]],
        f"no cells in column {at}": lambda r: r[:at] + r[at + 1 :],
        f"cells of column {at} twice": lambda r: r[: at + 1] + r[at:],
    }
    for column, factors in KINDS[kind].factors.items():
        for factor in factors:
            changes[f"column {column} times {factor:.3g}"] = lambda r, column=column, factor=factor: [
                f"{factor * float(c):.7g}" if i == column else c for i, c in enumerate(r)
            ]
    head = lines[: len(lines) - len(rows)]
    return [
        Bad(how, ("\n".join([*head, *(tab.join(change(row)) for row in rows)]) + "\n").encode(), OTHER)
        for how, change in changes.items()
    ]


def tree(random, content):
    """A JSON tree in which one value is odd, or missing."""
    whole = json.loads(content)
    path = random.choice(list(_paths(whole)))
    return _put(whole, path, *random.choice([*([value] for value in ODD_VALUES), []]))


def _paths(tree, path=()):
    """Where the values of a JSON tree are."""
    yield path
    if isinstance(tree, dict | list):
        for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            yield from _paths(value, (*path, key))


def _put(tree, path, *value):
    """A JSON tree with another value at a path, or none."""
    if not path:
        return value[0] if value else None
    copy = dict(tree) if isinstance(tree, dict) else list(tree)
    if len(path) == 1 and not value:
        del copy[path[0]]
    else:
        copy[path[0]] = _put(tree[path[0]], path[1:], *value)
    return copy
