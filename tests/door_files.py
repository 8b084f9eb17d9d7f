"""Bad files made from good ones: a generator that gives the same ones every time.

A case is (name, content, kind of change). Kinds: SAME, nothing that a reader looks at has changed; LESS,
part of the file is missing or there twice; OTHER, the file says something else now; TOLD, what is missing is taken to be
level, and the notes say so.
"""

import gzip
import json
import random
import re
from pathlib import Path
from typing import NamedTuple

import ezdxf
import numpy as np
from motion_files import record, turned, write_mot, write_nexus, write_trc

import footopt as fo
from footopt.gait.gait import HUMAN

SAME, LESS, OTHER, TOLD = "same", "less", "other", "told"
EXAMPLES = Path(fo.__file__).parents[1] / "examples"
OPENSIM = ("pelvis_tilt", "hip_flexion_r", "knee_angle_r", "ankle_angle_r")
FOOT = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
NUMBER = re.compile(rb"-?\d+\.\d+(?:[eE][-+]?\d+)?")
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
    "12,5",
    "1e5",
    "--1",
    "1_0",
    "१",
)


class Case(NamedTuple):
    name: str
    content: bytes
    change: str


def good_files(folder):
    """One good file of each format, by ending or ending and dialect."""
    gait = fo.Gait.human()
    t, places = record(gait, strides=4.3, rate=60.0)
    places = turned(places, 180, "y")
    for name in ("L_Heel", "L_MT2"):
        del places[name]
    files = {
        "trc": write_trc(folder / "walk.trc", t, places),
        "mot": write_mot(folder / "walk.mot", gait, OPENSIM, rate=60.0),
        "c3d": write_c3d(folder / "walk.c3d", t, places),
        "csv gait": write_gait_csv(folder / "walk.csv", gait, 4.4),
        "csv markers": write_nexus(folder / "markers.csv", t, places),
        "csv stride": write_gait_csv(folder / "stride.csv", gait, 1.0),
        "json": Path(HUMAN),
        "dxf": FOOT.to_file(folder / "sole.dxf"),
        "dxf lines": EXAMPLES / "sole" / "rocker.dxf",
        "svg": FOOT.to_file(folder / "sole.svg"),
        "csv sole": FOOT.to_file(folder / "sole.csv"),
        "csv sand": EXAMPLES / "sand" / "stresses.csv",
    }
    return {kind: path.read_bytes() for kind, path in files.items()}


def write_gait_csv(path, gait, strides, rate=60.0):
    """Angles over some strides; of one alone, its end is its begin."""
    t = np.arange(round(strides * gait.period * rate) + (strides == 1.0)) / rate
    p = t / gait.period + (0.3 if strides > 1 else 0.0)
    rows = zip(t, *(np.degrees(s.at(p)[0]) for s in (gait.thigh, gait.knee, gait.foot)), strict=True)
    table = [",".join(f"{v:.5f}" for v in row) for row in rows]
    path.write_text("\n".join(["time,thigh,knee,foot", *table]) + "\n")
    return path


def write_c3d(path, t, places):
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [round(1 / (t[1] - t[0]))]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(places)
    points = np.ones((4, len(places), len(t)))
    points[:3] = 1e3 * np.stack(list(places.values())).transpose(2, 0, 1)
    file["data"]["points"] = points
    file.write(str(path))
    return path


# --- changes that suit any file ---------------------------------------------------------------------


def of_any_text(content, good, kind, rounds=1):
    """What a disk, an editor, a mail program or a hurry does to a text file."""
    rng = random.Random(f"{kind} {rounds}")
    lines = content.splitlines(keepends=True)
    yield Case("empty", b"", OTHER)
    yield Case("blank", b" \n\n\t\n", OTHER)
    yield Case("gzip", gzip.compress(content, mtime=0), OTHER)
    yield Case("utf-16", content.decode().encode("utf-16"), OTHER)
    yield Case("utf-16 without mark", content.decode().encode("utf-16-le"), OTHER)
    yield Case("byte order mark", b"\xef\xbb\xbf" + content, OTHER if "dxf" in kind else SAME)
    yield Case("windows", b"\r\n".join(content.splitlines()) + b"\r\n", SAME)
    yield Case("no last line break", content.rstrip(), SAME)
    yield Case("garbage before", bytes(rng.randrange(256) for _ in range(200)) + b"\n" + content, OTHER)
    yield Case("words before", b"Exported by LabView at noon\n\n" + content, OTHER)
    yield Case("one long line", content.replace(b"\n", b" "), OTHER)
    yield Case("a long cell", content + b"1" * 300_000 + b"\n", OTHER)
    yield Case("many columns", content + b"1," * 100_000 + b"1\n", OTHER)
    yield Case("noise", bytes(rng.randrange(256) for _ in range(3000)), OTHER)
    if kind in ("trc", "dxf", "csv sand"):
        yield Case("larger than any limit", content + b"#" * 51_000_000, OTHER)
    for other, foreign in good.items():
        if other.split()[0] != kind.split()[0] or (other.split()[-1] != kind.split()[-1] and "csv" in other):
            yield Case(f"a {other} file", foreign, OTHER)
    for i in range(4 * rounds):
        yield Case(f"cut at a byte {i}", content[: rng.randrange(1, len(content) - 3)], LESS)
        yield Case(f"cut at a line {i}", b"".join(lines[: rng.randrange(1, len(lines))]), LESS)
        n = rng.randrange(len(lines))
        yield Case(f"line {n + 1} missing {i}", b"".join(lines[:n] + lines[n + 1 :]), LESS)
        n = rng.randrange(len(lines))
        yield Case(f"line {n + 1} twice {i}", b"".join(lines[:n] + lines[n : n + 1] + lines[n:]), LESS)
        a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
        swapped = [*lines]
        swapped[a], swapped[b] = swapped[b], swapped[a]
        yield Case(f"lines {a + 1} and {b + 1} exchanged {i}", b"".join(swapped), OTHER)
        begin = rng.randrange(len(content))
        hole = content[:begin] + content[begin + rng.randrange(1, max(2, len(content) // 3)) :]
        yield Case(f"a hole at {begin} {i}", hole, OTHER)
        at = rng.randrange(len(content))
        yield Case(f"a zero byte at {at} {i}", content[:at] + b"\0" + content[at:], OTHER)
        yield Case(f"latin-1 at {at} {i}", content[:at] + b"\xfc" + content[at:], OTHER)
    for i in range(8 * rounds):
        at, bit = rng.randrange(len(content)), rng.randrange(8)
        flipped = bytearray(content)
        flipped[at] ^= 1 << bit
        yield Case(f"bit {bit} of byte {at} {i}", bytes(flipped), OTHER)
    numbers = list(NUMBER.finditer(content))
    for i, odd in enumerate(ODD_NUMBERS * rounds):
        m = rng.choice(numbers)
        yield Case(
            f"{odd[:9]!r} for {m[0].decode()} at {m.start()} {i}",
            content[: m.start()] + odd.encode() + content[m.end() :],
            OTHER,
        )
    for i in range(5 * rounds):
        m = rng.choice(numbers)
        for name, number in (
            ("without its point", m[0].replace(b".", b"")),
            ("negative", b"-" + m[0].lstrip(b"-")),
        ):
            yield Case(
                f"{m[0].decode()} at {m.start()} {name} {i}",
                content[: m.start()] + number + content[m.end() :],
                OTHER,
            )


def of_any_bytes(content, good, kind, rounds=1):
    """Changes of a binary file."""
    rng = random.Random(f"{kind} {rounds}")
    yield Case("empty", b"", OTHER)
    yield Case("gzip", gzip.compress(content, mtime=0), OTHER)
    yield Case("noise", bytes(rng.randrange(256) for _ in range(3000)), OTHER)
    yield Case("zeros", bytes(len(content)), OTHER)
    yield Case("larger than any limit", content + bytes(51_000_000), OTHER)
    for other, foreign in good.items():
        if other != kind:
            yield Case(f"a {other} file", foreign, OTHER)
    for i in range(10 * rounds):
        yield Case(f"cut at a byte {i}", content[: rng.randrange(1, len(content) - 3)], LESS)
    for i in range(2 * rounds):
        for what, end in (("the header", 24), ("the parameters", 1500), ("the data", len(content))):
            at, bit = rng.randrange(end), rng.randrange(8)
            flipped = bytearray(content)
            flipped[at] ^= 1 << bit
            yield Case(f"{what}: bit {bit} of byte {at} {i}", bytes(flipped), OTHER)
    for word in range(1, 12 if rounds > 1 else 6):
        for value in (0, 1, 0x7FFF, 0xFFFF)[:: 1 if rounds > 1 else 3]:
            changed = bytearray(content)
            changed[2 * word : 2 * word + 2] = value.to_bytes(2, "little")
            yield Case(f"word {word + 1} of the header is {value}", bytes(changed), OTHER)


# --- changes that only one format knows -------------------------------------------------------------


def columns(content, change):
    """A table with commas, its columns changed."""
    rows = [line.split(",") for line in content.decode().splitlines()]
    return ("\n".join(",".join(change(i, row)) for i, row in enumerate(rows)) + "\n").encode()


def scaled(content, which, factor):
    def change(i, row):
        return row if i == 0 else [f"{factor * float(c):.7g}" if j in which else c for j, c in enumerate(row)]

    return columns(content, change)


def own_of_csv_gait(content):
    yield Case(
        "thigh and knee exchanged",
        columns(content, lambda i, r: [r[0], *(r[2], r[1]), r[3]] if i else r),
        OTHER,
    )
    yield Case("names exchanged", content.replace(b"time,thigh,knee", b"time,knee,thigh"), OTHER)
    yield Case("radians", scaled(content, (1, 2, 3), np.pi / 180), OTHER)
    yield Case("milliseconds", scaled(content, (0,), 1000), OTHER)
    yield Case("frames for seconds", scaled(content, (0,), 60), OTHER)
    yield Case("minutes", scaled(content, (0,), 1 / 60), OTHER)
    yield Case("the knee's sign", scaled(content, (2,), -1), OTHER)
    yield Case(
        "a knee column twice", content.replace(b"time,thigh,knee,foot", b"time,thigh,knee,knee"), OTHER
    )
    yield Case("no time", content.replace(b"time,", b"clock,"), OTHER)
    yield Case(
        "backwards", b"".join([*content.splitlines(True)[:1], *content.splitlines(True)[:0:-1]]), OTHER
    )
    yield Case("semicolons", content.replace(b",", b";"), OTHER)
    yield Case("decimal commas", content.replace(b",", b";").replace(b".", b","), OTHER)
    yield Case("the time stands", columns(content, lambda i, r: ["0.5", *r[1:]] if i else r), OTHER)
    yield Case(
        "before zero", columns(content, lambda i, r: [f"{float(r[0]) - 7:.5f}", *r[1:]] if i else r), SAME
    )
    yield Case("no feet", columns(content, lambda i, r: r[:3]), SAME)
    yield Case("standing", columns(content, lambda i, r: [r[0], "20.0", "20.0", "0.0"] if i else r), OTHER)


def own_of_trc(content):
    text = content.decode()
    for old, new in (
        ("\tmm\t", "\tm\t"), ("\tmm\t", "\tcm\t"), ("\tmm\t", "\tin\t"), ("\tmm\t", "\t\t"), ("\tmm\t", "\tMM\t"),
        ("60.00\t60.00", "100.00\t60.00"), ("60.00\t60.00", "0\t60.00"), ("60.00\t60.00", "-60\t60.00"),
        ("R_KJC", "R_AJC"), ("R_KJC", "R_HJC_"), ("R_HJC", "knee?"), ("R_", "S_"), ("Time", "Zeit"),
        ("Frame#", "Bild"), ("NumFrames", "Frames"), ("NumMarkers", "n"), ("\t", " "), ("\t", ","), (".", ","),
    ):  # fmt: skip
        change = SAME if new in ("\tMM\t", "Zeit", "Frames", "n", "\tin\t") and new != "\tin\t" else OTHER
        yield Case(f"{new!r} for {old!r}", text.replace(old, new).encode(), change)
    for a, b in (("R_HJC", "R_AJC"), ("R_KJC", "R_AJC"), ("R_HJC", "R_KJC"), ("R_KJC", "R_Heel")):
        exchanged = text.replace(a, "*").replace(b, a).replace("*", b)
        yield Case(f"{a} and {b} exchanged", exchanged.encode(), OTHER)
    lines = text.splitlines()
    frames = [line.split("\t") for line in lines[6:]]

    def rebuilt(change):
        return (
            "\n".join([*lines[:6], *("\t".join(change(i, [*row])) for i, row in enumerate(frames))]).encode()
            + b"\n"
        )

    def time(f):
        return rebuilt(lambda i, row: [row[0], f"{f(float(row[1])):.5f}", *row[2:]])

    yield Case("milliseconds", time(lambda t: 1000 * t), OTHER)
    yield Case("negative times", time(lambda t: t - 9), SAME)
    yield Case("a time twice", time(lambda t: min(t, 2.0) if t < 2.05 else t), OTHER)
    yield Case("a jump of time", time(lambda t: t + 3 * (t > 2)), OTHER)
    yield Case("a column less", rebuilt(lambda i, row: row[:4] + row[5:]), OTHER)
    yield Case("a column more", rebuilt(lambda i, row: [*row, "1.5"]), OTHER)
    for column in (2, 6, 9):
        yield Case(
            f"a kilometre in column {column}",
            rebuilt(lambda i, row, c=column: [*row[:c], "1000000.0" if i == 77 else row[c], *row[c + 1 :]]),
            OTHER,
        )
        yield Case(
            f"a hand's breadth in column {column}",
            rebuilt(
                lambda i, row, c=column: [
                    *row[:c],
                    f"{float(row[c]) + 400 * (70 < i < 75):.5f}",
                    *row[c + 1 :],
                ]
            ),
            OTHER,
        )


def own_of_csv_markers(content):
    text = content.decode()
    for old, new in (
        ("mm", "m"), ("mm", "cm"), ("mm", "MM"), ("mm", ""), ("Trajectories", "Model Outputs"), ("Frame", "Bild"),
        ("Trajectories\r\n60", "Trajectories\r\n0"), ("Trajectories\r\n60", "Trajectories\r\n6000"),
        ("Trajectories\r\n60", "Trajectories"), ("Sub Frame", "Subframe"), ("Sandra:", ""), ("X,Y,Z", "Y,X,Z"),
        ("Sandra:R_", "Sandra:S_"), ("R_KJC", "R_AJC"), ("R_KJC", "R_HJC_"), ("R_HJC", "knee?"), (",", ";"),
        (",", "\t"), (".", ","),
    ):  # fmt: skip
        change = SAME if new in ("MM", "Subframe") or old == "Sandra:" else OTHER
        yield Case(f"{new!r} for {old!r}", text.replace(old, new).encode(), change)
    for a, b in (("R_HJC", "R_AJC"), ("R_KJC", "R_AJC"), ("R_HJC", "R_KJC"), ("R_KJC", "R_Heel")):
        exchanged = text.replace(a, "*").replace(b, a).replace("*", b)
        yield Case(f"{a} and {b} exchanged", exchanged.encode(), OTHER)


def own_of_mot(content):
    text = content.decode()
    for old, new in (
        ("inDegrees=yes", "inDegrees=no"), ("inDegrees=yes", "inDegrees=maybe"), ("inDegrees=yes\n", ""),
        ("nRows=", "nRows=1"), ("nColumns=5", "nColumns=6"), ("nColumns=5", "nColumns=x"), ("endheader", "header ends"),
        ("hip_flexion_r\tknee_angle_r", "knee_angle_r\thip_flexion_r"), ("hip_flexion_r", "knee_angle_r"),
        ("time", "zeit"), ("knee_angle_r", "knee_angle_l"), ("\t", ","), ("pelvis_tilt", "tilt"),
        ("pelvis_tilt\thip_flexion_r", "hip_flexion_r\tpelvis_tilt"),
    ):  # fmt: skip
        yield Case(
            f"{new!r} for {old!r}",
            text.replace(old, new).encode(),
            SAME if new == "" else TOLD if new == "tilt" else OTHER,
        )
    radians = "\n".join(
        "\t".join([row.split("\t")[0], *(f"{np.radians(float(c)):.8f}" for c in row.split("\t")[1:])])
        for row in text.splitlines()[7:]
    )
    yield Case("radians that say degrees", "\n".join([*text.splitlines()[:7], radians, ""]).encode(), OTHER)


def own_of_json(content):
    data = json.loads(content)

    def changed(**new):
        return json.dumps({**data, **new}).encode()

    knee = data["knee"]
    radians = {j: {k: np.radians(v).tolist() for k, v in data[j].items()} for j in ("thigh", "knee", "foot")}
    yield Case("radians", changed(**radians), OTHER)
    yield Case("milliseconds", changed(period_s=1200.0), OTHER)
    for value in (0, -1.2, None, "soon", [], {}, True, 1e308, float("nan"), float("inf"), 10**400):
        yield Case(f"period_s {str(value)[:12]}", changed(period_s=value), OTHER)
    for value in (
        None,
        [],
        {},
        3,
        "a",
        {"a0": 0},
        {**knee, "a": "123456"},
        {**knee, "a": [None] * 8},
        {**knee, "b": []},
    ):
        yield Case(f"knee {str(value)[:50]}", changed(knee=value), OTHER)
    for value in (1e300, float("nan"), float("inf"), -400.0, 10**400):
        yield Case(f"a0 of the knee {str(value)[:12]}", changed(knee={**knee, "a0": value}), OTHER)
        yield Case(
            f"an a of the knee {str(value)[:12]}", changed(knee={**knee, "a": [value, *knee["a"][1:]]}), OTHER
        )
    yield Case("knee and thigh exchanged", changed(knee=data["thigh"], thigh=knee), OTHER)
    yield Case("a list", b"[1, 2, 3]", OTHER)
    yield Case("deep", b"[" * 100_000, OTHER)
    yield Case("deep and closed", b'{"a":' * 100_000 + b"1" + b"}" * 100_000, OTHER)
    yield Case("residuals of another kind", changed(rms_residual_deg_by_harmonics=[1]), OTHER)
    yield Case("a source of another kind", changed(source={"a": [1]}), SAME)


SVG = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" {head}>{body}</svg>'
MM = 'width="300mm" height="100mm" viewBox="-150 -50 300 100"'
SOLE = '<path d="M -100 0 L 0 20 L 100 0"/>'


def own_of_svg(content):
    text = content.decode()
    for old, new in (
        ("mm\"", "px\""), ("mm\"", "m\""), ("mm\"", "cm\""), ("mm\"", "\""), ("mm\"", "furlong\""), ("viewBox", "view"),
        ("viewBox=\"", "viewBox=\"nan "), (" L ", " Q "), (" L ", " C "), (" L ", " A "), ("M ", "X "), ("SOLE", "OUTLINE"),
        ("</svg>", ""), ("<svg", "<html"), ("path d", "path e"), ("http://www.w3.org/2000/svg", "urn:none"),
    ):  # fmt: skip
        yield Case(f"{new!r} for {old!r}", text.replace(old, new).encode(), OTHER)
    lol = '<!ENTITY a0 "lol">' + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
    for name, body, head in (
        ("uses itself", f'<g id="b0">{SOLE}<use href="#b0"/></g>', MM),
        ("uses what is not there", '<use href="#nothing"/>', MM),
        ("deep", "<g>" * 50_000 + SOLE + "</g>" * 50_000, MM),
        ("many paths", SOLE * 20_000, MM),
        ("many points", f'<polyline points="{" ".join(f"{x / 500 - 100},{x % 7}" for x in range(100_000))}"/>', MM),
        ("a path of many pieces", '<path d="M -100 0 ' + "c 0 1 1 1 1 0 " * 100_000 + '"/>', MM),
        ("infinite", '<path d="M -100 0 L 1e999 20 L 100 0"/>', MM),
        ("not a number", '<path d="M -100 0 L nan 20 L 100 0"/>', MM),
        ("far up", '<path d="M -100 0 L 0 1e9 L 100 0"/>', MM),
        ("scaled by nothing", f'<g transform="scale(0)">{SOLE}</g>', MM),
        ("scaled by nan", f'<g transform="scale(nan)">{SOLE}</g>', MM),
        ("scaled by much", f'<g transform="scale(1e300)">{SOLE}</g>', MM),
        ("another transform", f'<g transform="explode(9)">{SOLE}</g>', MM),
        ("a huge arc", '<path d="M -100 0 A 1e12 1e12 0 0 0 100 0"/>', MM),
        ("a huge circle", '<circle r="1e15"/>', MM),
        ("a negative circle", '<circle r="-5"/>', MM),
        ("a point", '<path d="M 5 5 L 5 5"/>', MM),
        ("nothing", "", MM),
        ("no width", SOLE, 'width="0mm" height="0mm" viewBox="0 0 0 0"'),
        ("a negative width", SOLE, 'width="-300mm" viewBox="0 0 300 100"'),
        ("an infinite width", SOLE, 'width="1e999mm" viewBox="0 0 300 100"'),
        ("a broken box", SOLE, 'width="300mm" viewBox="0 0 300"'),
        ("a box of words", SOLE, 'width="300mm" viewBox="a b c d"'),
        ("no box", SOLE, 'width="300mm" viewBox=""'),
        ("text instead of a width", SOLE, 'width="e" viewBox="0 0 1 1"'),
        ("a script", f"<script>alert(1)</script>{SOLE}{SOLE}", MM),
        ("a picture from elsewhere", '<image xlink:href="file:///etc/passwd" width="9" height="9"/>', MM),
    ):  # fmt: skip
        yield Case(name, SVG.format(head=head, body=body).encode(), OTHER)
    plain = SVG.format(head=MM, body="<text>&a11;</text>" + SOLE)
    yield Case("billion laughs", f"<!DOCTYPE svg [{lol}]>{plain}".encode(), OTHER)
    for name, entity in (
        ("file", "file:///etc/passwd"),
        ("http", "http://localhost:1/x"),
        ("pipe", "/dev/stdin"),
    ):
        outside = f'<!DOCTYPE svg [<!ENTITY a11 SYSTEM "{entity}">]>{plain}'
        yield Case(f"an entity from a {name}", outside.encode(), OTHER)
    yield Case("another encoding", b'<?xml version="1.0" encoding="ebcdic-cp-us"?>' + content, OTHER)
    yield Case("an encoding that is none", b'<?xml version="1.0" encoding="klingon"?>' + content, OTHER)


def drawing(draw, units=4):
    """The text of a DXF file of what `draw` draws in its document."""
    import io

    document = ezdxf.new("R2010")
    document.units = units
    draw(document)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def own_of_dxf(content):
    line = [(-100, 0), (0, -20), (100, 0)]

    def nested(document):
        document.blocks.new("B0").add_lwpolyline(line)
        for i in range(1, 12):
            block = document.blocks.new(f"B{i}")
            for _ in range(10):
                block.add_blockref(f"B{i - 1}", (0, 0))
        document.modelspace().add_blockref("B11", (0, 0))

    def in_itself(document):
        block = document.blocks.new("B")
        block.add_lwpolyline(line)
        block.add_blockref("B", (1, 1))
        document.modelspace().add_blockref("B", (0, 0))

    def grid(document):
        document.blocks.new("B").add_lwpolyline(line)
        many = {"row_count": 32767, "column_count": 32767, "row_spacing": 1, "column_spacing": 1}
        document.modelspace().add_blockref("B", (0, 0), dxfattribs=many)

    def in_space(method, *arguments, **options):
        return lambda document: getattr(document.modelspace(), method)(*arguments, **options)

    for name, draw in (
        ("nested blocks", nested), ("a block in itself", in_itself),
        ("a block that is not there", in_space("add_blockref", "none", (0, 0))), ("a grid of blocks", grid),
        ("a huge circle", in_space("add_circle", (0, 0), 1e300)),
        ("a large circle", in_space("add_circle", (0, 0), 1e12)),
        ("a circle of nothing", in_space("add_circle", (0, 0), 0)),
        ("a huge ellipse", in_space("add_ellipse", (0, 0), (1e12, 0), 0.5)),
        ("a huge spline", in_space("add_spline", [(-1e12, 0), (0, -1e12), (1e12, 0)])),
        ("a huge bulge", in_space("add_lwpolyline", [(-100, 0, 1e9), (100, 0, 0)], "xyb")),
        ("an endless bulge", in_space("add_lwpolyline", [(-100, 0, float("inf")), (100, 0, 0)], "xyb")),
        ("a flat bulge", in_space("add_lwpolyline", [(-100, 0, 1e-300), (100, 0, 0)], "xyb")),
        ("a point that is no number", in_space("add_lwpolyline", [(-100, 0), (0, float("nan")), (100, 0)])),
        ("a point at infinity", in_space("add_lwpolyline", [(-100, 0), (0, float("-inf")), (100, 0)])),
        ("a point a kilometre down", in_space("add_lwpolyline", [(-100, 0), (0, -1e6), (100, 0)])),
        ("a kilometre up", in_space("add_lwpolyline", [(-100, 1e6), (0, 1e6), (100, 1e6)])),
        ("one point", in_space("add_lwpolyline", [(0, 0)])),
        ("one point three times", in_space("add_lwpolyline", [(0, 0)] * 3)),
        ("a dimension only", in_space("add_text", "sole")), ("nothing", lambda document: None),
        ("many lines", lambda d: [d.modelspace().add_line((i, 0), (i + 1, 0)) for i in range(5_100)]),
        ("many points", in_space("add_lwpolyline", [(x / 100 - 100, (x % 7) / 9) for x in range(20_000)])),
        ("there and back", in_space("add_lwpolyline", [*line, *line[1::-1]])),
        ("a spline of one point", in_space("add_spline", [(0, 0)])), ("a spline of none", in_space("add_spline")),
    ):  # fmt: skip
        yield Case(name, drawing(draw), OTHER)
    for units in (0, 1, 2, 3, 6, 13, 20):
        yield Case(f"$INSUNITS {units}", drawing(in_space("add_lwpolyline", line), units), OTHER)
    yield Case("binary", b"AutoCAD Binary DXF\r\n\x1a\x00" + content, OTHER)
    yield Case("no entities", content.replace(b"ENTITIES", b"ENTRAILS"), OTHER)
    yield Case("another version", content.replace(b"AC1024", b"AC9999"), OTHER)


def own_of_csv_sole(content):
    rows = content.decode().splitlines()[1:]
    for head in (
        "x_m,z_m",
        "x_cm,z_cm",
        "x_in,z_in",
        "x,z",
        "x_mm,z_cm",
        "z_mm,x_mm",
        "a,b",
        "",
        "x_mm",
        "x_px,z_px",
    ):
        yield Case(f"headed {head!r}", "\n".join([head, *rows, ""]).encode(), OTHER)
    yield Case("exchanged", columns(content, lambda i, r: r[::-1] if i else r), OTHER)
    yield Case("from toe to heel", "\n".join(["x_mm,z_mm", *rows[::-1], ""]).encode(), SAME)
    yield Case("upside down", scaled(content, (1,), -1), OTHER)
    yield Case("far away", columns(content, lambda i, r: [f"{float(r[0]) + 500}", r[1]] if i else r), OTHER)
    yield Case("a metre up", columns(content, lambda i, r: [r[0], f"{float(r[1]) + 1e6}"] if i else r), OTHER)
    yield Case(
        "many rows", b"x_mm,z_mm\n" + b"".join(b"%f,0\n" % (x / 1000 - 100) for x in range(200_000)), OTHER
    )
    yield Case(
        "a row in the middle a kilometre down", content.replace(b"\n0.000000,", b"\n0.000000,-1e6,"), OTHER
    )
    yield Case("two rows", "\n".join(["x_mm,z_mm", rows[0], rows[0], ""]).encode(), OTHER)
    yield Case("decimal commas", content.replace(b",", b";").replace(b".", b","), SAME)
    yield Case("decimal commas between commas", content.replace(b".", b","), OTHER)
    yield Case(
        "shuffled", "\n".join(["x_mm,z_mm", *random.Random(1).sample(rows, len(rows)), ""]).encode(), OTHER
    )


def own_of_csv_sand(content):
    head = content.splitlines()[0]
    for names in (
        "gamma,beta,alpha_x,alpha_z",
        "beta,gamma,alpha_z,alpha_x",
        "beta,gamma,alpha_x,alpha_x",
        "a,b,c,d",
    ):
        yield Case(f"headed {names}", content.replace(head, names.encode()), OTHER)
    yield Case("radians", scaled(content, (0, 1), np.pi / 180), OTHER)
    yield Case("N/m^3", scaled(content, (2, 3), 1e6), OTHER)
    yield Case("kN/m^3", scaled(content, (2, 3), 1e3), OTHER)
    yield Case("all zero", scaled(content, (2, 3), 0), OTHER)
    yield Case("alpha_z upside down", scaled(content, (3,), -1), OTHER)
    yield Case("alpha_x upside down", scaled(content, (2,), -1), OTHER)
    yield Case("gamma upside down", scaled(content, (1,), -1), OTHER)
    yield Case("beta upside down", scaled(content, (0,), -1), OTHER)
    yield Case("all upside down", scaled(content, (2, 3), -1), OTHER)
    yield Case("one beta", columns(content, lambda i, r: ["30", *r[1:]] if i else r), OTHER)
    yield Case("half the angles", b"".join(content.splitlines(True)[:7]), OTHER)


OWN = {
    "csv gait": own_of_csv_gait, "csv stride": own_of_csv_gait, "csv markers": own_of_csv_markers,
    "trc": own_of_trc, "mot": own_of_mot,
    "json": own_of_json, "svg": own_of_svg, "dxf": own_of_dxf, "csv sole": own_of_csv_sole,
    "csv sand": own_of_csv_sand,
}  # fmt: skip


def cases(kind, good, rounds=1):
    """All bad files of a kind; more `rounds` give more of those made by chance."""
    content = good[kind]
    any_ = of_any_bytes if kind == "c3d" else of_any_text
    yield from any_(content, good, kind, rounds)
    if kind in OWN:
        yield from OWN[kind](content)
