"""Reader of the recorded runs of pybullet, for machines without it; `record.py` writes them."""

from solutions.checks import BadInput

from ..check import Role
from ..reference.stored import RECORDED
from ..run.store import read_whole


def trace(name):
    """Return the record of a scene, or None.  Raises BadInput for a damaged file."""
    path = RECORDED / f"{name}.json"
    return read_whole(path, dict, f"restore it, or give: validate record --scene {name}") if path.is_file() else None


def recorded(name, case, engine):
    """Return the record of one engine run on one case, None if it was not recorded.

    Raises BadInput without the scene's file.
    """
    record = {"runs": {}} | (trace(name) or {})
    if not record["runs"] and engine.product.recorded:
        raise BadInput(f"file '{RECORDED / name}.json'", "missing or empty",
                       f"restore it, or give where pybullet is installed: validate record --scene {name}")
    label = engine.recorded_as or engine.label
    runs = record["runs"].get(case, {}).get(label)
    return runs and {"source": f"recorded, {record['stamp']}", "runs": runs,
                     "seconds": record["seconds"].get(engine.label)}


def film_of(name, colour):
    """Return the recorded film of pybullet as a list of one entry; empty where there is none."""
    frames = (trace(name) or {}).get("frames")
    return [{"label": "pybullet, recorded", "role": Role.ENGINE, "colour": colour, "frames": frames}] if frames else []
