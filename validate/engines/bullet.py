"""pybullet, the 3D engine, with the settings that every scene needs."""

from functools import cache, partial

import numpy as np

from ..check import Whose
from ..reference.orientation import quaternion
from ..scene import Departure, EngineRun
from . import quiet_import
from .switches import Switch, made, worlds_made

_idle: list = []             # connected clients that are free for another run
ITERATIONS = 50              # of the contact solver, by default
CONTACT_ERP = 0.08           # share of an overlap that a contact takes back in a step [-]
WARMER = 0.85                # the same in Bullet itself, which pybullet overrides [-]
WARM = 0.1                   # share of the last impulses with which the contact solver begins, by default [-]
APART = 100.0                # of bodies in a step that is done beforehand, more than the size of any of them [m]
UPRIGHT = np.eye(3)          # rotation of a body that is not rotated


class Client:
    """pybullet's functions, each bound to one client, so that calls do not have to name it."""

    def __init__(self, module, number):
        self.module, self.number = module, number

    def __getattr__(self, name):
        value = getattr(self.module, name)
        # without a number pybullet means client 0, and a call then takes a fifth less
        bound = partial(value, physicsClientId=self.number) if callable(value) and self.number else value
        setattr(self, name, bound)                               # the next call then finds it directly
        return bound


class Bullet:
    """A pybullet client without a window, with the settings of every scene.  Bodies have no shape by default."""

    def __init__(self, dt, gravity=(0.0, 0.0, 0.0)):
        pybullet = quiet_import("pybullet")
        self.client = _idle.pop() if _idle else pybullet.connect(pybullet.DIRECT)
        self.pb = Client(pybullet, self.client)
        made(self)
        self.dt = dt
        self.gravity, self.waiting = tuple(map(float, gravity)), []      # bodies whose moments do not count yet
        self.pb.setGravity(*self.gravity)
        self.pb.setTimeStep(dt)
        # the residual threshold stops the solver at an absolute velocity, which ruins small steps; the breaking
        # threshold is global to the process and survives reconnecting, so every scene sets it
        self.pb.setPhysicsEngineParameter(solverResidualThreshold=0, contactBreakingThreshold=0.02)

    def give_moments(self, body, m, I, maximal, **more):
        """Set mass [kg] and moments (3,) [kg m²] in one call, or the first is lost; `more` are further properties.

        In maximal coordinates moments that are not those of the shape count from the second step on: see `begin`.
        """
        moments = list(map(float, I))
        if maximal and not np.allclose(self.pb.getDynamicsInfo(body, -1)[2], moments, rtol=1e-12, atol=0.0):
            self.waiting.append(body)
        self.pb.changeDynamics(body, -1, mass=m, localInertiaDiagonal=moments, **more)

    def begin(self):
        """Let all moments count in the first step, too; return self.  Joints are made afterwards.

        Bullet computes the inverse tensor of a body in maximal coordinates at the end of a step.  So one step is done
        beforehand, without gravity, with all bodies at rest and far from each other.  Then each is put in its place.
        """
        if not self.waiting:
            return self
        pb = self.pb
        moving = [body for body in map(pb.getBodyUniqueId, range(pb.getNumBodies()))
                  if pb.getDynamicsInfo(body, -1)[0] > 0.0]
        starts = [(*pb.getBasePositionAndOrientation(body), *pb.getBaseVelocity(body)) for body in moving]
        for k, (body, (_, q, *_)) in enumerate(zip(moving, starts)):
            pb.resetBasePositionAndOrientation(body, (0.0, 0.0, APART * (k + 1)), q)
            pb.resetBaseVelocity(body, (0.0,) * 3, (0.0,) * 3)
        pb.setGravity(0.0, 0.0, 0.0)
        self.waiting.clear()
        self.step()
        for body, (x, q, v, omega) in zip(moving, starts):
            pb.resetBasePositionAndOrientation(body, x, q)
            pb.resetBaseVelocity(body, v, omega)
        pb.setGravity(*self.gravity)
        return self

    def position(self, body):
        return self.pb.getBasePositionAndOrientation(body)[0]

    def velocity(self, body):
        return self.pb.getBaseVelocity(body)[0]

    def push(self, body, force, x):
        """Apply a force [N] at the centre x [m] during the next step only (pybullet clears it)."""
        self.pb.applyExternalForce(body, -1, force, x, self.pb.WORLD_FRAME)

    def step(self):
        self.pb.stepSimulation()

    def make_in_a_call(self, substeps):
        """Set the number of steps that a call from Python makes."""
        self.pb.setPhysicsEngineParameter(fixedTimeStep=substeps * self.dt, numSubSteps=substeps)

    def close(self):
        """Empty the world and keep its client, with its own settings, for the next run: connecting takes 20 ms."""
        self.pb.setPhysicsEngineParameter(numSolverIterations=ITERATIONS, warmStartingFactor=WARM, numSubSteps=0)
        self.pb.resetSimulation()
        _idle.append(self.client)


class Rigid(Bullet):
    """pybullet with bodies that have moments of inertia, in `maximal` or in reduced coordinates.

    Bodies have no damping, and their velocity is not clamped.
    """

    def __init__(self, dt, gravity=(0.0, 0.0, 0.0), iterations=50):
        super().__init__(dt, gravity)
        # a contact begins at the depth of the slop; until then a body falls, 1e-5 m in 1.4 ms, without friction
        self.pb.setPhysicsEngineParameter(numSolverIterations=iterations, contactSlop=0)

    def body(self, m, I, x, omega, maximal, v=(0.0, 0.0, 0.0), R=UPRIGHT, shape=-1, mu=0.0):
        """Make a body at x with the rotation R."""
        q = np.roll(quaternion(R), -1).tolist()  # pybullet has w last
        body = self.pb.createMultiBody(
            m, shape, basePosition=list(map(float, x)), baseOrientation=q, useMaximalCoordinates=int(maximal)
        )
        unclamped = {} if maximal else {"maxJointVelocity": 1e9}
        self.give_moments(
            body,
            m,
            I,
            maximal,
            linearDamping=0,
            angularDamping=0,
            lateralFriction=mu,
            rollingFriction=0,
            spinningFriction=0,
            restitution=0,
            **unclamped,
        )
        self.pb.resetBaseVelocity(body, list(map(float, v)), list(map(float, omega)))
        return body

    def R(self, body):
        """Return the orientation (3, 3)."""
        q = self.pb.getBasePositionAndOrientation(body)[1]
        return np.array(self.pb.getMatrixFromQuaternion(q)).reshape(3, 3)

    def omega(self, body):
        return self.pb.getBaseVelocity(body)[1]

    def close(self):
        """Restore the engine's own settings for the next world."""
        self.pb.setPhysicsEngineParameter(contactSlop=1e-5)
        super().close()


IMPACT_SETTINGS = ("maximal coordinates; contactERP 0, contactSlop 0, contactProcessingThreshold 0, "
                   "restitutionVelocityThreshold 0")


def hidden_damping(acceleration, start):
    """Return the Departure of pybullet's default reduced-coordinate body, which adds −0.04 v (1 + |v|) to a.

    |v| is the length of the vector.  The damping of 0.04 is documented: it is the default of linearDamping in the
    guide's table of changeDynamics.  Only the factor 1 + |v| is hidden: btMultiBody uses the same number for a linear
    and for a quadratic term.
    start(p) → (x, v), each (d,); DOP853 solves the law.
    *Source:* PyBullet Quickstart Guide, changeDynamics; Bullet's btMultiBody.cpp, DAMPING_K1_LINEAR and
    DAMPING_K2_LINEAR; measured.
    """
    @cache
    def own_law(p, t):
        from scipy.integrate import solve_ivp
        begin = np.concatenate(start(p))
        d = len(begin) // 2

        def slope(t, y):
            x, v = y[:d], y[d:]
            return np.concatenate((v, acceleration(t, x, v, p) - 0.04 * v * (1.0 + np.linalg.norm(v))))

        return solve_ivp(slope, (0.0, max(t, 1e-9)), begin, method="DOP853", rtol=1e-12, atol=1e-13).y[:d, -1]
    return Departure("its reduced-coordinate bodies are damped by default, −0.04 v (1 + |v|); the 0.04 is documented, "
                     "the factor 1 + |v| is not", own_law, Whose.DEFAULT)


HINGES = "createMultiBody: links on hinges in reduced coordinates, no damping, no clamp of velocity, motors off"


def substepped(make, substeps):
    """Return make(p, dt) of the same world, of which a call makes so many steps of dt."""
    def world(p, dt):
        with worlds_made() as worlds:
            run = make(p, dt)
        for bullet in worlds:
            bullet.make_in_a_call(substeps)
        return run
    return world


def empty_world():
    """Make the EngineRun of a world without bodies."""
    bullet = Bullet(1e-3)
    return EngineRun(bullet.step, lambda: None, bullet.close)


# ---------------------------------------------------------------------------------------------- switches

def parts(bullet):
    """Return [(body, link)] of everything in pybullet; the list is empty if nothing has a shape.

    pybullet does not report whether a body in maximal coordinates has a shape, but its client remembers the calls.
    """
    pb = bullet.pb
    if "createCollisionShape" not in vars(pb):
        return []
    return [(body, link) for body in map(pb.getBodyUniqueId, range(pb.getNumBodies()))
            for link in range(-1, pb.getNumJoints(body))]


def let_all_pass(bullet):
    """Disable the collisions of all shapes."""
    for body, link in parts(bullet):
        bullet.pb.setCollisionFilterGroupMask(body, link, 0, 0)
    return len(parts(bullet)) > 1


def rub_nothing(bullet):
    rubbing = [part for part in parts(bullet) if bullet.pb.getDynamicsInfo(*part)[1] > 0.0]
    for body, link in rubbing:
        bullet.pb.changeDynamics(body, link, lateralFriction=0.0)
    return len(rubbing) > 1


def forget_contacts(bullet):
    """Begin the sweeps of each step from zero impulses."""
    bullet.pb.setPhysicsEngineParameter(warmStartingFactor=0)
    return len(parts(bullet)) > 1


def let_sweep(bullet, iterations):
    """Sweep so often over contacts and joints, and return how often it was before."""
    before = bullet.pb.getPhysicsEngineParameters()["numSolverIterations"]
    bullet.pb.setPhysicsEngineParameter(numSolverIterations=iterations)
    return before


def sweep_once(bullet):
    """Sweep once over contacts and joints."""
    return let_sweep(bullet, 1) > 1 and (len(parts(bullet)) > 1 or bullet.pb.getNumConstraints() > 0)


SWITCHES = (
    Switch("collision detection", let_all_pass),
    Switch("friction", rub_nothing),
    Switch("memory of contacts", forget_contacts),
    Switch("all sweeps but one", sweep_once),
)
