"""study=export: the foot of an earlier run as files for a workshop."""

from pathlib import Path

import numpy as np
from shapely import Polygon

from footopt.errors import check
from footopt.files.feet import MM, body_outline, write_all
from footopt.report import figures, terminal
from footopt.report.output import foot_entry
from footopt.studies.load import foot_of
from footopt.studies.runs import Study

#: What each file contains, by its ending.
HOLDS = {
    ".csv": "the sole, heel to toe",
    ".dxf": "outline and sole",
    ".svg": "outline and sole, full size",
    ".stl": "body of triangles",
    ".step": "body of plane faces",
}


def run(study: Study) -> None:
    """Write the foot of the run `study.run` in every format."""
    config, folder = study.config, study.options.run
    check(folder is not None, "run", None, "the folder of a run", "Try run=outputs/optimize/...")
    foot, block = foot_of(Path(folder), config.foot.k, study.options.foot), config.foot.block
    written, notes = write_all(foot, study.folder, block)
    outline, width = MM * body_outline(foot, block), MM * foot.width
    area, size = float(Polygon(outline).area), [*np.ptp(outline, axis=0).tolist(), width]
    sides = " x ".join(f"{value:.4g}" for value in size)
    study.save("contour", lambda: figures.contour(foot), "The sole of every file, with its ankle (+), in mm.")
    rows = [(path.name, HOLDS[path.suffix], f"{1e-3 * path.stat().st_size:.1f}") for path in written]
    study.conclude(
        "A foot to make",
        [terminal.table(("file", "holds", "kB"), ("file", "holds"), rows=rows)],
        {
            "run": folder,
            "design": foot_entry(foot),
            "area_mm2": area,
            "volume_mm3": area * width,
            "size_mm": size,
            "files": {path.name: {"bytes": path.stat().st_size} for path in written},
            "notes": notes,
        },
        summary=[f"{terminal.describe_foot(foot)}: {sides} mm, {area * width:.0f} mm^3"],
    )
