"""MuJoCo, a live engine of order 4, also where pybullet has no wheel: joints by angles and soft contacts.

Bodies on joints and free bodies have no constraint here that a step could violate.  Runge–Kutta 4 turns a body by
the method of Munthe-Kaas, so its error is of order 4.  MuJoCo's default is the semi-implicit Euler step.
A contact is a spring with a damper, whose numbers are `solref` and `solimp`.
"""

from functools import cache

import numpy as np

from ..scene import EngineRun
from . import quiet_import
from .switches import Switch, made

TOLERANCE = 1e-8             # of its solver, by default [-]
STIFF = 0.9999, 0.9999, 0.001, 0.5, 2.0      # `solimpfriction`: as hard as it can be
IMPEDANCE, TIME_CONSTANT = 0.95, 0.02    # of contacts: `solimp`, here the same at every depth, and `solref` [s]
SOFT = f"elliptic cone, impedance {IMPEDANCE}, time constant {TIME_CONSTANT} s"


@cache
def module():
    """Return MuJoCo's module, and suppress its log file MUJOCO_LOG.TXT in the working folder."""
    mujoco = quiet_import("mujoco")
    mujoco.set_mju_user_warning(lambda text: None)
    return mujoco


def text(values):
    """Return numbers as MuJoCo's XML writes them, with all their digits."""
    return " ".join(repr(float(value)) for value in np.ravel(values))


def world(dt, bodies, gravity=(0.0, 0.0, 0.0), integrator="RK4", more="", tolerance=0.0):
    """Return (model, data) of bodies in XML.

    more: further parts of the model    tolerance: of the solver of constraints, 0 for all of its iterations
    """
    mujoco = module()
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{text(dt)}" gravity="{text(gravity)}" integrator="{integrator}" cone="elliptic" '
        f'tolerance="{text(tolerance)}" iterations="100"><flag autoreset="disable"/></option>'
        f"{more}<worldbody>{bodies}</worldbody></mujoco>")
    return model, mujoco.MjData(model)


def running(model, data, read):
    """Make the EngineRun of a world."""
    step = module().mj_step
    made(model)
    return EngineRun(lambda: step(model, data), read, lambda: None)


def empty_world():
    """Make the EngineRun of a world without bodies."""
    return running(*world(1e-3, "", integrator="Euler"), lambda: None)


def inertial(m, moments, place=(0.0, 0.0, 0.0)):
    """Return the XML of a mass [kg], its moments about its centre [kg m²], and the place of the centre [m]."""
    return f'<inertial mass="{text(m)}" pos="{text(place)}" diaginertia="{text(moments)}"/>'


# ---------------------------------------------------------------------------------------------- points

def sliding(m, d, **joint):
    """Return the XML of a body of m [kg] that slides along the first d axes; joint: attributes of its joints."""
    attributes = "".join(f' {name}="{text(value)}"' for name, value in joint.items())
    slides = "".join(f'<joint type="slide" axis="{text(axis)}"{attributes}/>' for axis in np.eye(3)[:d])
    return f"{slides}{inertial(m, np.ones(3))}"


def points(masses, x, v, dt, read, gravity=(0.0, 0.0, 0.0), **joint):
    """Make the EngineRun of points at x (n, d) with velocities v; read(x (n, d)).

    joint: stiffness [N/m] of a spring to the origin and damping [N s/m], along each axis.
    """
    d = len(x[0])
    model, data = world(dt, "".join(f"<body>{sliding(m, d, **joint)}</body>" for m in masses), gravity)
    data.qpos[:], data.qvel[:] = np.ravel(x), np.ravel(v)
    return running(model, data, lambda: read(data.qpos.reshape(-1, d).copy()))


def rubbed(m, friction, gravity, v, dt, read):
    """Make the EngineRun of a body that slides along x with the friction [N] of a joint: `frictionloss`; read(x).

    gravity: along x [m/s²]    v: half a step before the start [m/s]
    """
    joint = f'<joint type="slide" axis="1 0 0" frictionloss="{text(friction)}" solimpfriction="{text(STIFF)}"/>'
    model, data = world(dt, f"<body>{joint}{inertial(m, np.ones(3))}</body>", (gravity, 0.0, 0.0), "Euler",
                        tolerance=TOLERANCE)
    data.qvel[0] = v
    return running(model, data, lambda: read(data.qpos[0]))


# ---------------------------------------------------------------------------------------------- switches

def disabled(model, bit):
    """Set one of MuJoCo's flags that disable a part, and return whether the world has contacts or joints to solve."""
    model.opt.disableflags |= getattr(module().mjtDisableBit, bit).value
    return model.ngeom > 1 or model.neq > 0


def let_all_pass(model):
    """Disable all contacts."""
    return disabled(model, "mjDSBL_CONTACT") and model.ngeom > 1


def rub_nothing(model):
    """Give contacts a normal force only: those of shapes, and those of the pairs that a Model names."""
    dims = np.append(model.geom_condim[model.geom_contype > 0], model.pair_dim)
    model.geom_condim[:] = model.pair_dim[:] = 1
    return model.ngeom > 1 and bool((dims > 1).any())


def forget_contacts(model):
    """Begin the iterations of each step anew, and not with the last step's accelerations."""
    return disabled(model, "mjDSBL_WARMSTART")


def sweep_once(model):
    """Iterate once over contacts and joints: one step of Newton's method, where that is the solver."""
    before, model.opt.iterations = model.opt.iterations, 1
    return before > 1 and (model.ngeom > 1 or model.neq > 0)


SWITCHES = (
    Switch("collision detection", let_all_pass),
    Switch("friction", rub_nothing),
    Switch("memory of contacts", forget_contacts),
    Switch("all sweeps but one", sweep_once),
)
