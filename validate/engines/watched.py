"""Steps of an engine with all that it reports of them, for the laws of contact in `validate/reference/contact_laws.py`.

A run is watched in its first steps, in which nothing is remembered yet, and in some later ones.  Where bodies meet on
the way, one run is watched in all its steps, or in all that belong to the impacts.
"""

import numpy as np

from solutions.support.model import WORLD, model_energy, own_place, start_of, world_place

from ..check import Allowed, JointsAllowed
from ..reference.contact_laws import ITERATED, Motion, Physics, Step, Touching
from ..reference.joint_laws import LOST, Reading
from ..reference.orientation import quaternion_matrix
from .bullet import CONTACT_ERP

SLOP = 1e-5                  # of pybullet, by default [m]
FIRST, LATER = 2, 8          # number of watched steps at the beginning of a run, and afterwards
MOTION = 60, 12              # the same of a run in which bodies meet


def ends_early(iterations, *more):
    """Return the rules of a solver that ends each step after so many iterations, with any residual left.

    more: quantities that this concerns as well
    """
    why = f"its {iterations} iterations per step end before the impulses are found"
    return tuple((name, why) for name in ("bounce", "gain", "short", *ITERATED, *more))


def sweeps_rules(sweeps):
    """Return what is Allowed to a loop of ours that makes so many sweeps, whose bodies may still move at the end."""
    return Allowed(sweeps, rules=ends_early(sweeps), rests=False)


def pymunk_rules(iterations, creeps="", rests=True):
    """Return what is Allowed to pymunk.

    creeps: why its contacts still have a residual at the end; empty where bodies come to rest
    rests: whether they do; False: they may still move

    *Source:* Chipmunk's cpArbiter.c: cpArbiterUpdate takes over the impulses of a contact that it still remembers, and
    cpArbiterApplyCachedImpulse returns at the first step of a collision.
    """
    why = "a contact that comes back within three steps reports its old impulse, which is not applied again"
    rules = ("unapplied", why), *ends_early(iterations)
    return Allowed(iterations, rules=(*rules, ("rest", creeps)) if creeps else rules, rests=rests)


def bullet_rules(iterations, creeps=False, rests=True, slop=SLOP):
    """Return what is Allowed to pybullet.

    creeps: its iterations do not finish bodies at rest either
    slop: overlap that its contacts leave [m]

    *Source:* Bullet's btSequentialImpulseConstraintSolver.cpp: an iteration visits the friction of a contact only if
    its normal impulse is above zero.
    """
    why = "it leaves the friction of a contact as it was when its normal impulse falls to zero"
    rules = ("loose", why), *ends_early(iterations, *["rest"] * creeps)
    return Allowed(iterations, slop, CONTACT_ERP, rules, rests)


def mujoco_rules(iterations):
    """Return what is Allowed to MuJoCo, whose bodies may still move at the end."""
    rules = tuple((name, "its contacts are springs with dampers") for name in ("bounce", "gain", *ITERATED))
    return Allowed(iterations, rules=rules, rests=False, soft=True)


def sweeps_over_joints(opens=""):
    """Return what is allowed to a solver of order 1 that sweeps over joints.

    opens: why it leaves them open in this scene, and changes the energy; empty where it need not
    """
    return JointsAllowed(1, (("gap", opens, None), ("energy", opens, None)) if opens else ())


# of MuJoCo, which closes a gap within a time that is proportional to dt
SOFT_LOOPS = JointsAllowed(2, (("energy", "the springs and dampers that close its loops take energy", LOST),))


def watched_steps(steps, first=FIRST, later=LATER):
    """Return numbers of the steps of a run that are watched."""
    begin = range(min(first, steps))
    return {*begin, *np.linspace(len(begin), steps - 1, later).astype(int).tolist()} & set(range(steps))


def steps_of_motion(steps):
    """Return the same of a run in which bodies meet on the way."""
    return watched_steps(steps, *MOTION)


def run(world, steps, kept, watched=None):
    """Make so many steps in a world with step() and watched() → Step; append those that are watched to `kept`.

    watched: their numbers; None: as watched_steps says
    """
    watched = watched_steps(steps) if watched is None else watched
    for n in range(steps):
        if n in watched:
            kept.append(world.watched())
        else:
            world.step()


class NearTheEdge:
    """Calls of holds(number, kept) → bool, with the watched steps of the last run that stood and of the last that fell.

    A bisection ends with the two runs that are nearest to the edge.
    """

    def __init__(self, holds):
        self.holds, self.kept = holds, {}

    def __call__(self, number):
        steps = []
        stands = bool(self.holds(number, steps))
        self.kept[stands] = steps
        return stands

    def steps(self):
        """Return the steps of both runs."""
        return [step for stands in sorted(self.kept) for step in self.kept[stands]]


def touching(rows, d, stated=None):
    """Return Touching from rows (a, b, n, p_a, p_b, gap, J, μ, ghosts, axes); stated: what replaces μ, see Physics."""
    a, b, n, p_a, p_b, gap, J, mu, ghosts, axes = zip(*rows) if rows else ((),) * 10
    if stated is not None:
        mu = np.full(len(a), stated) if np.ndim(stated) == 0 else stated[list(a), list(b)]
    n, p_a, p_b, J, ghosts = (np.reshape(np.array(each, float), (-1, d)) for each in (n, p_a, p_b, J, ghosts))
    return Touching(np.array(a, int), np.array(b, int), n, p_a, p_b, np.array(gap, float), J, np.array(mu, float),
                    ghosts, None if None in axes or d == 2 else np.reshape(np.array(axes, float), (-1, 2, 3)))


class Pymunk:
    """A space whose bodies move or are static.

    bodies, physics: those that count, in the order of the Physics by which they are judged; without them all that
    move, by the engine's own numbers.    pushed: (before, after) → impulses (n, d) of springs and air in a step
    """

    def __init__(self, space, dt, bodies=None, physics=None, pushed=None):
        self.space, self.dt, self.remembered, self.pushed = space, dt, {}, pushed
        self.bodies = bodies or [body for body in space.bodies if body.body_type == body.DYNAMIC]
        self.physics = physics

    def stated(self):
        """Return the Physics of the scene, or else the engine's own, without its frictions."""
        if self.physics is not None:
            return self.physics
        inverse = np.array([(1.0 / body.mass, 1.0 / body.moment) for body in self.bodies])
        return Physics(np.array(tuple(self.space.gravity)), inverse[:, 0], inverse[:, 1], None)

    def step(self):
        self.space.step(self.dt)

    def motion(self):
        rows = np.array([(*body.position, *body.velocity, body.angular_velocity) for body in self.bodies])
        return Motion(rows[:, :2], rows[:, 2:4], rows[:, 4])

    def watched(self):
        """Make a step, and return it.

        It moves the bodies, with what removes the overlaps of the last step, before it finds contacts.
        """
        self.remembered.clear()
        before, overlap = self.motion(), max((-row[5] for row in self.contacts()), default=0.0)
        self.space.on_collision(pre_solve=self.remember)
        self.step()
        self.space.on_collision(pre_solve=None)
        stated, after = self.stated(), self.motion()
        return Step(self.dt, stated.gravity, stated.inv_mass, stated.inv_inertia, before, after, after.x, overlap,
                    touching(self.contacts(), 2, stated.mu), self.pushed and self.pushed(before, after))

    def remember(self, arbiter, space, data):
        """Note the impulses that a contact has before it is solved, where they are not applied: in its first step."""
        if arbiter.is_first_contact:
            kept = arbiter._arbiter
            self.remembered[frozenset(map(id, arbiter.shapes))] = [
                (kept.contacts[k].jnAcc, kept.contacts[k].jtAcc) for k in range(kept.count)]

    def contacts(self):
        """Return rows of all contact points: pymunk's own method reports only their sum.

        Chipmunk keeps the two impulses of a point across and along its normal, which points from its first shape to its
        second, and the two points at which they act.
        """
        number, rows = {body: k for k, body in enumerate(self.bodies)}, {}

        def add(arbiter):
            kept, (first, second) = arbiter._arbiter, arbiter.shapes
            if first._shape != kept.a:
                first, second = second, first
            ends = [number.get(shape.body, len(self.bodies)) for shape in (first, second)]
            n, mu = np.array((kept.n.x, kept.n.y)), first.friction * second.friction
            for k in range(kept.count):
                point = kept.contacts[k]
                places = [np.array((shape.body.position.x + r.x, shape.body.position.y + r.y))
                          for shape, r in ((first, point.r1), (second, point.r2))]
                axes = np.array((n, (-n[1], n[0])))
                J = np.array((point.jnAcc, point.jtAcc)) @ axes                      # on the second
                ghosts = self.remembered.get(frozenset((id(first), id(second))), {})
                rows[id(first), id(second), k] = (*ends[::-1], n, *places[::-1], float(n @ (places[1] - places[0])), J,
                                                  mu, np.array(ghosts[k] if ghosts else (0.0, 0.0)) @ axes, None)
        for body in self.bodies:
            if body.body_type == body.DYNAMIC:
                body.each_arbiter(add)
        return list(rows.values())


class Bullet:
    """A client whose bodies are in maximal coordinates.

    physics: of the bodies that move, in the order in which they were made; without it the engine's own numbers count.
    pushed: (Motion before) → impulses (n, 3) of springs on their centres in a step [N s]
    """

    def __init__(self, pb, dt, gravity, physics=None, pushed=None):
        self.pb, self.dt, self.pushed = pb, dt, pushed
        every = [pb.getBodyUniqueId(k) for k in range(pb.getNumBodies())]
        about = {body: pb.getDynamicsInfo(body, -1) for body in every}
        self.bodies = [body for body in every if about[body][0] > 0.0]
        self.physics = physics or Physics(
            np.array(gravity, float), np.array([1.0 / about[body][0] for body in self.bodies]),
            1.0 / np.array([about[body][2] for body in self.bodies]), None)
        self.mu = {body: about[body][1] for body in every}

    def step(self):
        self.pb.stepSimulation()

    def motion(self):
        rows = [(*self.pb.getBasePositionAndOrientation(body), *self.pb.getBaseVelocity(body)) for body in self.bodies]
        x, q, v, omega = (np.array(column) for column in zip(*rows))
        return q[:, [3, 0, 1, 2]], Motion(x, v, omega)                       # w is last in pybullet

    def watched(self):
        """Make a step, and return it."""
        q, before = self.motion()
        self.step()
        R, stated = np.array([quaternion_matrix(*one) for one in q]), self.physics
        return Step(self.dt, stated.gravity, stated.inv_mass, (R * stated.inv_inertia[:, None]) @ R.transpose(0, 2, 1),
                    before, self.motion()[1], before.x, 0.0, touching(self.contacts(), 3, stated.mu),
                    self.pushed and self.pushed(before))

    def contacts(self):
        """Return rows of all contact points that could push in the last step."""
        number, rows = {body: k for k, body in enumerate(self.bodies)}, []
        for c in self.pb.getContactPoints() or ():
            F = c[9] * np.array(c[7]) + c[10] * np.array(c[11]) + c[12] * np.array(c[13])
            a, b = (number.get(body, len(self.bodies)) for body in c[1:3])
            rows.append((a, b, c[7], c[5], c[6], c[8], self.dt * F, self.mu[c[1]] * self.mu[c[2]], 0.0 * F,
                         (c[11], c[13])))
        return rows


class MuJoCo:
    """A model whose bodies hang on nothing, each with six velocities: of its centre, and about its own axes.

    physics: of its bodies, in their order;    pushed: (Motion before) → impulses (n, 3) of springs on their centres
    state, data: of its world, which are set when that is built
    """

    def __init__(self, world, dt, physics, pushed=None):
        self.dt, self.physics, self.pushed, self.data = dt, physics, pushed, None
        self.world, self.bodies = world, [k for k in range(world.nbody) if world.body_dofnum[k] == 6]

    def motion(self, R):
        """Return the Motion of all bodies, with angular velocities about their own axes that are turned by R."""
        self.state()                                                     # it computes places of the coordinates
        own = self.data.qvel[self.world.body_dofadr[self.bodies][:, None] + np.arange(6)]
        return Motion(self.data.xpos[self.bodies], own[:, :3], np.einsum("nij,nj->ni", R, own[:, 3:]))

    def watched(self):
        """Make a step, and return it.  It changes velocities about own axes, and turns the bodies afterwards."""
        self.state()
        R, stated = self.data.xmat[self.bodies].reshape(-1, 3, 3), self.physics
        before = self.motion(R)
        self.step()
        rows = self.contacts()
        return Step(self.dt, stated.gravity, stated.inv_mass, (R * stated.inv_inertia[:, None]) @ R.transpose(0, 2, 1),
                    before, self.motion(R), before.x, 0.0, touching(rows, 3, stated.mu),
                    self.pushed and self.pushed(before))

    def contacts(self):
        """Return rows of all contact points of the last step, with its cone of friction."""
        import mujoco
        number = {body: k for k, body in enumerate(self.bodies)}
        local, rows = np.zeros(6), []
        for k, c in enumerate(self.data.contact):
            mujoco.mj_contactForce(self.world, self.data, k, local)
            axes = np.array(c.frame).reshape(3, 3)                       # the normal, from the first to the second
            b, a = (number.get(self.world.geom_bodyid[one], len(self.bodies)) for one in c.geom)
            rows.append((a, b, axes[0], c.pos, c.pos, c.dist, self.dt * axes.T @ local[:3], c.friction[0], np.zeros(3),
                         None))
        return rows


class Joined:
    """Bodies on joints, of which nothing is read but their places and velocities.

    step, state: of the engine's world of the Model, which are set when that is built
    rate: the fastest of the motion [1/s];    work: (State before, State after) → work of loads in a step [J]
    """

    def __init__(self, model, dt, rate, work=None):
        self.model, self.turn, self.work, self.done = model, rate * dt, work, 0.0
        self.ends = [(joint.a, own_place(model, joint.a, joint.place), joint.b, own_place(model, joint.b, joint.place))
                     for joint in model.joints]
        self.lever = max(np.linalg.norm(place) for a, at_a, b, at_b in self.ends
                         for k, place in ((a, at_a), (b, at_b)) if k != WORLD)
        self.still = model._replace(gravity=np.zeros(model.d), springs=())
        self.step = self.state = None
        self.first, self.now = model_energy(model, start_of(model)), start_of(model)

    def watched(self):
        """Make a step, and return its Reading."""
        self.step()
        before, self.now = self.now, self.state()
        if self.work is not None:
            self.done += self.work(before, self.now)
        gap = max(np.linalg.norm(world_place(self.now, a, at_a) - world_place(self.now, b, at_b))
                  for a, at_a, b, at_b in self.ends)
        return Reading(gap / self.lever, model_energy(self.model, self.now) - self.first - self.done,
                      model_energy(self.still, self.now), self.turn)
