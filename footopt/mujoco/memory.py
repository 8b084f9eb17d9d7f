"""The sand's memory as the state of a MuJoCo plugin, which does nothing else: `mj_getState` holds it."""

import ctypes
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.errors import check, needed
from footopt.mujoco.native import library

NAME, INSTANCE, SIZE = "footopt.sand", "footopt_sand", "size"
SENSOR = 2  # mjPLUGIN_SENSOR, of a stage that never comes


@lru_cache(maxsize=1)
def register() -> tuple[Any, ...]:
    """Register the plugin; all that MuJoCo keeps pointers to."""
    whole, place = ctypes.c_int, ctypes.c_void_p
    lib = library()
    lib.mj_getPluginConfig.restype = ctypes.c_char_p
    lib.mj_getPluginConfig.argtypes = place, whole, ctypes.c_char_p

    def size(model: int, instance: int) -> int:
        return int(lib.mj_getPluginConfig(model, instance, SIZE.encode()))

    def forget(model: int, state: int, _: int, instance: int) -> None:
        ctypes.memset(state, 0, 8 * size(model, instance))

    calls = (
        ctypes.CFUNCTYPE(whole, place, whole)(size),
        ctypes.CFUNCTYPE(whole, place, place, whole)(lambda model, data, instance: 0),
        ctypes.CFUNCTYPE(None, place, place, place, whole)(forget),
        ctypes.CFUNCTYPE(None, place, place, whole, whole)(lambda *given: None),
    )
    state_size, begin, reset, compute = (ctypes.cast(call, place).value for call in calls)
    name, names = ctypes.create_string_buffer(NAME.encode()), (ctypes.c_char_p * 1)(SIZE.encode())
    # mjpPlugin: name, attributes, capability, functions; those that come after, in any version, are none
    head = ctypes.addressof(name), 1, ctypes.addressof(names), SENSOR
    lib.mjp_registerPlugin((place * 64)(*head, state_size, 0, begin, 0, 0, reset, compute))
    return calls, name, names


def remembering(spec: Any, size: int) -> Any:
    """A specification's model, whose data remember so many numbers; the specification stays as it is."""
    register()
    own = spec.copy()
    own.activate_plugin(NAME)
    own.add_plugin(name=INSTANCE, plugin_name=NAME, active=True).config = {SIZE: str(size)}
    return own.compile()


def memory(model: Any, data: Any, size: int) -> NDArray[np.float64]:
    """Where the sand of data remembers so many numbers: their plugin's state, or else an array of its own."""
    mujoco = needed("mujoco", "footopt.mujoco", "mujoco")
    row = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_PLUGIN, INSTANCE)
    if row < 0:
        return np.zeros(size)
    same, first = model.plugin_statenum[row] == size, model.plugin_stateadr[row]
    check(same, "feet", "others", "those for which the specification was attached", "Attach it again.")
    found: NDArray[np.float64] = data.plugin_state[first : first + size]
    return found
