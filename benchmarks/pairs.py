"""What effects change together beyond what each changes alone, in seven scenes: a table of docs/effects.md.

``python benchmarks/pairs.py OUT.csv`` walks with 40 random feet through each scene: with the effects whose
parameters the literature has and the scene's own, alone, in pairs and all together. It continues an OUT.csv
that is there, begins no scene after the seconds that a second argument says, and prints the table in %.
"""

import csv
import math
import sys
import time
from pathlib import Path

from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from footopt.cli.compose import CONF
from footopt.effects import name_of
from footopt.report.numbers import percent
from footopt.studies.build import make_scene, make_space
from footopt.studies.effects import to_audit
from footopt.walk.audit import interactions
from footopt.walk.calls import LITERATURE

SCENES = ("walk", "incline", "brisk", "deep", "crust", "patchy", "stand")
FEET, SEED = 40, 1


def rows(name):
    """A scene's pairs, and all: how far beyond the product of each, in which objective, and walks lost."""
    # who stands has no objectives
    words = ["scene=walk", "effects=rest"] if name == "stand" else [f"scene={name}"]
    with initialize_config_dir(str(CONF), version_base="1.3"):
        config = OmegaConf.to_object(compose("config", words))
    scene, space = make_scene(config), make_space(config.foot)
    audited = {type(e): e for e in reversed(to_audit(scene))}
    effects = [e for e in audited.values() if isinstance(e, LITERATURE) or e in scene.effects]
    own = {name_of(effect) for effect in scene.effects if not isinstance(effect, LITERATURE)}
    for joint in interactions(effects, scene, space.random(FEET, seed=SEED, inside=True), space=space):
        names = ["own" if effect in own else effect.replace("_", " ") for effect in joint.names]
        pair = "all" if len(names) > 2 else " + ".join(sorted(names, key=lambda name: (name != "own", name)))
        yield name, pair, max(joint.extra.tolist()), joint.worst, joint.lost


def table(made):
    """Lines of Markdown: a row a pair, a column a scene."""
    every = {(name, pair): float(extra) for name, pair, extra, *_ in made}
    names, pairs = (list(dict.fromkeys(part)) for part in zip(*every, strict=True))
    yield "| together | " + " | ".join(f"`{name}`" for name in names) + " |"
    yield "| --- " * (len(names) + 1) + "|"
    for pair in sorted(pairs, key=lambda pair: (pair == "all", pair.startswith("own"), pair)):
        cells = [
            percent(every[name, pair]).removesuffix(" %") if (name, pair) in every else "" for name in names
        ]
        yield f"| {pair} | " + " | ".join(cells) + " |"


def run(path, seconds=math.inf):
    """Walk through the scenes that a table lacks, and print it."""
    begun, path = time.monotonic(), Path(path)
    made = list(csv.reader(path.read_text().splitlines())) if path.exists() else []
    for name in SCENES:
        if name in {row[0] for row in made} or time.monotonic() - begun > seconds:
            continue
        own = list(rows(name))
        made += own
        with open(path, "a", newline="") as file:
            csv.writer(file).writerows(own)
    print("\n".join(table(made)))


if __name__ == "__main__":
    run(sys.argv[1], *map(float, sys.argv[2:]))
