"""Nets of springs: initial states, drawings, and the runners that move them."""

from functools import partial

import numpy as np

from solutions.springs import make_spring_network
from solutions.support.model import Body, Drag, Spring, make_model
from validate.methods import EXPLICIT, IMPLICIT_MESH, RK4
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE
from validate.reference.springs import implicit_net, net_model, pymunk_net_model, state_of
from validate.scene import LATE_LEAPFROG, MUJOCO, PYMUNK, engine, ours
from validate.scenes._common import built, check_positives, measured
from validate.scenes.integrators._common import integrator_runners


def start_of(net, positive):
    """Return start(p) → (x, v, network) of net(p); it raises BadInput unless these parameters are positive."""
    def start(p):
        check_positives(p, *positive)
        return state_of(net(p), make_spring_network)
    return start


def in_space(net):
    """Return p → (state, p) of the ReferenceNetwork net(p): the same motion with three coordinates."""
    return lambda p: (state_of(net(p).padded(), make_spring_network), p)


def model_of(net):
    """Return model(p) of the ReferenceNetwork net(p) in the plane.

    All masses are equal, so that the wind, which pushes each of them alike, is a part of gravity.
    """
    def model(p):
        one = net(p)
        bodies = [Body(tuple(x), one.m if free else np.inf, v=tuple(v)) for x, v, free in zip(one.x, one.v, one.free())]
        springs = [Spring(j, i, (0.0, 0.0), (0.0, 0.0), rest, one.k, one.k_d)
                   for (i, j), rest in zip(one.pairs.tolist(), one.rest) if not {i, j} <= set(one.fixed)]
        return make_model(bodies, one.gravity + one.wind / one.m, springs=springs,
                          loads=[Drag(one.k_v)] if one.k_v else [])
    return model


def read_net(state, p):
    """Return the positions of all nodes."""
    return state.x.ravel()


def net_world(net, product, **settings):
    """Return make(p, dt) of an engine's runner."""
    return built(product, model_of(net), read_net, **settings)


def observe_net(state, p):
    """Return the positions of all nodes, seen from the front."""
    return state[0][:, :2].ravel()


def net_points(observed, p):
    """Draw every node."""
    return observed.reshape(-1, 2)


def net_fields(net, positive, contact="contact of the net with itself", **other):
    """Return the fields that the scenes of the ReferenceNetwork net(p) share.

    positive    names of parameters that must be positive
    contact     the parts that the scene omits, in words
    other       fields that this scene has in place of the usual ones
    """
    return {
        "lesson": "springs",
        "start": start_of(net, positive),
        "observe": observe_net,
        "model": model_of(net),
        "read": read_net,
        "points": net_points,
        "links": lambda p: net(p).pairs.tolist(),
        "link_look": "spring",
        "uses": ("two coordinates", "springs with dampers", "one step function"),
        "ablations": {"the third dimension": in_space(net), **measured("rotation", contact)},
        **other,
    }


def net_runners(net, motion, limits, **mesh_in_quick):
    """Return the runners of a scene of the ReferenceNetwork net(p): our methods, pymunk and MuJoCo.

    motion           the Motion of net(p)
    limits           (p, dt) → {order: largest relative error}
    mesh_in_quick    fields of the Runner of the implicit mesh, whose step takes seconds to compile
    The implicit methods of lesson 1 run in a full run only, because they build a dense matrix at every correction.
    """
    in_pymunk = partial(net_world, net, PYMUNK, own_drag=True, iterations=1)
    return (
        *integrator_runners(motion, limits, compiled=EXPLICIT),
        ours(IMPLICIT_MESH, limit=limits, predicted=motion.predict_model(net_model(net, implicit_net)),
             **mesh_in_quick),
        engine(PYMUNK, "", in_pymunk(), f"DampedSpring between point masses; {ONE_SWEEP}",
               order=1, limit=limits, predicted=motion.predict_model(net_model(net, pymunk_net_model))),
        engine(PYMUNK, "leapfrog start", in_pymunk(ahead=0.5), f"the same, first velocities + ½ a dt; {DAMPED}",
               order=LATE_LEAPFROG, limit=lambda p, dt: limits(p, dt)[1],
               predicted=motion.predict_model(net_model(net, partial(pymunk_net_model, ahead=0.5)))),
        engine(MUJOCO, "", net_world(net, MUJOCO),
               "point masses on slide joints, tendons as springs; Runge–Kutta 4",
               order=4, limit=limits, predicted=motion.predict(RK4.table), most_steps=5000),
        engine(MUJOCO, "leapfrog start", net_world(net, MUJOCO, integrator="Euler", ahead=0.5),
               f"the same with Euler, first velocities − ½ a dt; {DAMPED}", order=LATE_LEAPFROG,
               limit=lambda p, dt: limits(p, dt)[1], most_steps=5000,
               predicted=motion.predict(NEW_VELOCITY_OLD_FORCE, ahead=-0.5)),
    )


ONE_SWEEP = "1 iteration: with more, its dampers err as much"
DAMPED = "second order if no force depends on a velocity"
SQUARE = ("n", "spacing", "m", "k")      # parameters of a SquareNet that must be positive
