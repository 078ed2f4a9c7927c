"""Masses on springs: how a net starts and is drawn, what its scenes have in common, and the same in pymunk."""

import numpy as np

from solutions.checks import check_positive
from solutions.springs import make_spring_network
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.methods import EXPLICIT, IMPLICIT_MESH, INTEGRATORS, ONE_OF_EACH_ORDER
from validate.reference.springs import implicit_net, net_model, pymunk_net_model, square_net, state_of
from validate.scene import PYMUNK, engine, ours


def start_of(net, positive):
    """Return start(p) → (x, v, network) of net(p); it raises BadInput unless these parameters are positive."""
    def start(p):
        for name in positive:
            check_positive(name, getattr(p, name))
        return state_of(net(p), make_spring_network)
    return start


start_net = start_of(square_net, ("n", "spacing", "m", "k"))


def in_space(net):
    """Return p → (state, p) of the ReferenceNetwork net(p): the same motion with three coordinates."""
    return lambda p: (state_of(net(p).padded(), make_spring_network), p)


def observe_net(state, p):
    """Return the places of all nodes, seen from the front."""
    return state[0][:, :2].ravel()


def net_points(observed, p):
    """Draw every node."""
    return observed.reshape(-1, 2)


def net_links(p):
    """Draw every spring."""
    return square_net(p).pairs.tolist()


def pymunk_net(net, dt, observe):
    """Make an EngineRun of point masses and DampedSprings; observe(x (n, d)) reads it.

    Masses are equal, so wind is a part of gravity and viscosity one factor e^(−k_v dt/m) on all velocities.  The
    factor also reduces the impulse that springs have just given: at rest they stretch e^(k_v dt/m) times too far, a
    first-order error.
    """
    import pymunk
    wide = net.padded()
    space = pymunk_space((wide.gravity + wide.wind / net.m)[:2])
    space.damping = np.exp(-net.k_v / net.m)             # the fraction of velocity kept after one second
    bodies = []
    for n, (x, v) in enumerate(zip(wide.x, wide.v)):
        held = n in net.fixed
        body = pymunk.Body(body_type=pymunk.Body.STATIC) if held else pymunk.Body(net.m, float("inf"))
        body.position = tuple(map(float, x[:2]))
        if not held:
            body.velocity = tuple(map(float, v[:2]))
        space.add(body)
        bodies.append(body)
    for (i, j), rest in zip(net.pairs, net.rest):
        if not (i in net.fixed and j in net.fixed):      # between two fixed ends there is nothing to solve
            space.add(pymunk.DampedSpring(bodies[i], bodies[j], (0.0, 0.0), (0.0, 0.0), float(rest), net.k, net.k_d))
    d = net.x.shape[1]
    return pymunk_world(space, dt, lambda: observe(np.array([body.position for body in bodies])[:, :d]))


def net_runners(net, motion, limits, finer_in_full=(), **mesh_in_quick):
    """Return the runners of a scene of the ReferenceNetwork net(p): our methods, and pymunk.

    motion           the Motion of net(p)
    limits           (p, dt) → {order: largest relative error}
    finer_in_full    of pymunk
    mesh_in_quick    fields of the Runner of the implicit mesh, whose step takes seconds to compile
    The implicit methods of lesson 1 are left to a full run: they build a dense matrix at every correction.
    """
    return (
        *(ours(m, limit=limits, predicted=motion.predict(m.table), in_quick=m in ONE_OF_EACH_ORDER,
               compiled_in_quick=m in EXPLICIT) for m in INTEGRATORS),
        ours(IMPLICIT_MESH, limit=limits, predicted=motion.predict_model(net_model(net, implicit_net)),
             **mesh_in_quick),
        engine(PYMUNK, "", lambda p, dt: pymunk_net(net(p), dt, np.ravel), "DampedSpring between point masses",
               finer_in_full=finer_in_full, order=1, limit=limits,
               predicted=motion.predict_model(net_model(net, pymunk_net_model))),
    )


# the fields that the scenes of a SquareNet share
NET = {
    "lesson": "springs",
    "start": start_net,
    "observe": observe_net,
    "points": net_points,
    "links": net_links,
    "link_look": "spring",
    "uses": ("two coordinates", "springs with dampers", "one step function"),
    "ablations": {
        "the third dimension": in_space(square_net),
        "rotation": "the whole loop of lesson 10 has it, and is measured",
        "contact of the net with itself": "the whole loop of lesson 10 has it, and is measured",
    },
}
