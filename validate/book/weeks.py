"""Division of a lesson into lectures, labs and exercises: one week, or two if its hours require it."""

import re
from typing import NamedTuple

from ..subject import modules
from . import course, plan


class Week(NamedTuple):
    """A week with a lesson.  The exercises before and after the lab are whole sections of its notebook."""
    before: tuple            # (first, last) exercise that students write before the lab
    after: tuple             # and after it; 0 means the last exercise of the lesson

    def parts(self, name):
        """Return the ranges (first, last) of exercises before and after the lab."""
        return [(first, last or len(course.lessons()[name].exercises)) for first, last in (self.before, self.after)]
    lecture: str             # 90 minutes
    show: tuple              # scenes of the report for the lecture
    lab: str                 # 60 minutes
    together: str            # 45 minutes


WEEKS = {
    "integrators": (Week(
        (1, 6), (7, 0),
        "Ask why only one of the three planets stays. Draw the slopes of Euler, midpoint and Runge–Kutta into one "
        "figure. The order is the slope of the error over the step. Then exchange Euler's two lines.",
        ("kepler", "oscillator"),
        "Before the figure of 1.4 to 1.6 is drawn, each student predicts for each method whether the energy of an "
        "oscillator grows, stays or falls.",
        "What is the longest stable step of symplectic Euler and of Runge–Kutta without damping? Theory says 2/ω and "
        "2.83/ω. Then move the slider."),),
    "springs": (Week(
        (1, 9), (10, 0),
        "Ask why only one cloth keeps its shape. Go through the forces of the lesson; show why springs alone never "
        "move the centre of mass, and which springs of a cloth are no threads.",
        ("hanging_springs", "spring_net"),
        "Signs go wrong in 2.7. Draw two points, one spring and both forces on paper; then add the damper.",
        "How many more steps does a hundred times the stiffness cost? Ten times as many, because ω dt < 2. Why has "
        "the implicit step no such limit?"),),
    "friction": (Week(
        (1, 7), (8, 0),
        "Ask why one of the two blocks crawls. The normal force, the cone of all forces that a support can give, "
        "static friction (an inequality) and kinetic friction (a law).",
        ("incline", "stopping_block"),
        "Draw stick and slip as two states, and the events that lead from one to the other. They are 3.8 to 3.11.",
        "From which μ does the block hold (tan θ)? If friction is one more force for Euler's method, by how much does "
        "the velocity swing at the end (μ g dt)?"),),
    "inertia_tensors": (Week(
        (1, 10), (11, 0),
        "Ask why the angular momentum of the dumbbell is not parallel to its angular velocity. Derive the tensor from "
        "L = Σ m r × (ω × r). Its eigenvectors are the principal axes.",
        ("tensors",),
        "Check 4.5 to 4.8 by their limits, on paper: a cylinder without height is a disc, a capsule without length is "
        "a ball.",
        "How far from the origin may a body of one metre be until the naive integrals have no correct digit? Estimate "
        "it from 10⁻¹⁶ D⁵ (a kilometre), then run the cell."),),
    "rotation": (Week(
        (1, 10), (11, 0),
        "Ask why only one of the bricks turns over. The state (x, R, P, L) and its derivative; why ω wanders while L "
        "stands still; quaternions and half the angle.",
        ("asymmetric_top", "heavy_top"),
        "Turn a body by 90° in three ways (5.6, 5.7 and 5.10), on paper and with the functions. Many answers have a "
        "product the wrong way round.",
        "By which factor per step does the lecture's loop grow for a spinning cylinder, and which step does not grow? "
        "Below which spin does the sleeping top fall (20 rad/s)?"),),
    "collisions": (Week(
        (1, 6), (7, 8),
        "Avoidance, detection and response are three things. The discrete and the continuous test; the record of a "
        "contact: points, normal, gap and time.",
        ("point_and_plane", "point_and_cylinder"),
        "Draw a segment, a triangle and a box, and the regions of the plane to which each corner, edge and face is "
        "nearest. They are the cases of 6.7 and 6.8.",
        "*Break it*: which share of the balls gets through a wall? Derive 1 − (R + w/2)/(v h), then run the cell."),
        Week(
        (9, 11), (12, 0),
        "The broad phase: why all pairs are too many, boxes that hold bodies, and their tree. The narrow phase of "
        "convex bodies: separating axes and GJK.",
        ("pairs", "distances"),
        "Two rectangles on squared paper: find the separating edge, and clip one side by the other. Then 6.12 to "
        "6.14.",
        "*Make it*: each group writes a rule for a polite crowd, and the notebook judges it.")),
    "impulses": (Week(
        (1, 11), (12, 0),
        "Ask who paid for the rod's energy. The impulse as the limit of a stiff spring; restitution; K, the response "
        "of the relative velocity to an impulse.",
        ("bounces", "oblique_discs"),
        "Compute K of a rod on paper. Draw the friction cone and the impulse that would stop the slip: does the rod "
        "stick or slip (7.10)?",
        "At which friction can Painlevé's rod jam (4/3, at the slope 2)? How long does a ball bounce that bounces "
        "infinitely often (√(2h/g) (1 + e)/(1 − e))?"),),
    "pbd": (Week(
        (1, 5), (6, 11),
        "Ask why one of the two cloths hangs like rubber. A constraint, its gradient and its multiplier; all at once "
        "(the projection method) and one after the other (PBD).",
        ("pendulum", "rope"),
        "8.4 is the longest answer of the lesson. Write down the linear system of a chain of two links first.",
        "How far too low does a chain hang, for a given step and number of sweeps (8.8)? Predict it, then measure."),
        Week(
        (12, 14), (15, 0),
        "The stiffness of PBD depends on the step; a compliance does not, once the sweeps have converged. A rigid "
        "body as a point with an effective inverse mass.",
        ("cloth",),
        "A push at one end of a rod: which share moves it, and which share turns it? On paper, before 8.15 to 8.17.",
        "*Break it*: eight sweeps or eight substeps? Predict how much stiffer each makes a chain (8 and 64 times).")),
    "contact": (Week(
        (1, 8), (9, 11),
        "Ask what is wrong with a solver that lets ten boxes sink. All contacts in one matrix; the complementarity "
        "problem; projected Gauss–Seidel and its contraction.",
        ("stack", "mass_ratio"),
        "Two contacts by hand: each is open or pushes. Compute all four cases; which one obeys the law? Then 9.8.",
        "How fast does the upper one of two boxes sink (g Δt ρᵐ/(1 − ρᵐ))? Predict it, then look at ten boxes and at "
        "the three cures."),
        Week(
        (12, 16), (17, 0),
        "A pile without a matrix: arms, soft contacts, memory. Then other solvers for the same laws: the proximal map, "
        "Newton's method, and the convex problem that several engines solve instead.",
        ("piles",),
        "Put the parts of a step of a pile in order, with what each costs. Which of them may be skipped while nothing "
        "moves?",
        "Which residual does the convex relaxation leave on a sliding block, and how high does the block float "
        "(μ v Δt)? Predict it, then look at the eight solvers.")),
    "simulator": (Week(
        (1, 7), (8, 0),
        "Ask how you would know that the dominoes are right. The loop, and the lesson from which each part comes. A "
        "scene leaves out what it does not need.",
        ("machine", "rocking_block"),
        "Put the step together from cards with the names of its functions. What goes wrong if two cards are exchanged?",
        "How fast may a disc fall until the floor misses it? Why does a ball spiral outwards on a turntable, and by "
        "how much per step?"),),
    "kinematics": (Week(
        (1, 8), (9, 0),
        "Ask what the flailing arm does not know. Forward kinematics is a sum; the columns of the Jacobian; its "
        "ellipse; the two solutions of an arm of two links.",
        ("reach_2r", "singular_arm"),
        "Draw an arm of two links in three postures, each with its ellipse. Which posture has no area?",
        "Why does a straight arm not move towards a target on its own axis? How much damping keeps an arm calm whose "
        "target is out of reach?"),),
    "sensitivities": (Week(
        (1, 5), (6, 0),
        "Ask how much higher a ball bounces that was dropped from a little higher. Differences, and why a shorter step "
        "is not always better; the tangent of a step; the time of an event moves, too.",
        ("step_of_a_difference", "bounced_ball"),
        "A ball is dropped from h on a floor with e. Derive where it is just after its bounce, and differentiate it. "
        "Where does the −e come from?",
        "Why has the step that pushes a ball out of the floor the derivative 0? Which input of a throw has no "
        "derivative at all?"),),
}


def sections(name):
    """Return [(first, last, title)] of the sections with exercises, as the notebook has them."""
    text = course.notebook_of(name).read_text(encoding="utf-8")
    found = re.findall(r"## Exercises? \d+\.(\d+)(?: (?:to|and) \d+\.(\d+))?: (.+?)(?:\\n|\")", text)
    return [(int(first), int(last or first), title) for first, last, title in found]


def hours(name, first, last):
    """Return hours to write the exercises of a range, rounded so that all ranges of a lesson add up to its hours."""
    lesson = course.lessons()[name]
    until = [lesson.head.writing * sum(one.minutes for one in lesson.exercises[:number])
             / sum(one.minutes for one in lesson.exercises) for number in (first - 1, last)]
    return plan.half(until[1]) - plan.half(until[0])


def work(name, first, last):
    """Return the exercises of a range, by section, with the hours to write them."""
    lesson = course.lessons()[name]
    told = "; ".join(f"{plan.span(lesson.exercises[low - 1:high])} *{title}*" for low, high, title in sections(name)
                     if first <= low and high <= last)
    needed = hours(name, first, last)
    return f"{told} (about {needed:g} {'hour' if needed <= 1.0 else 'hours'})"


def table(name, report):
    """Return the weeks of a lesson."""
    notebook = f"[notebook](../notebooks/{course.notebook_of(name).stem})"
    weeks, parts = WEEKS[name], []
    for number, week in enumerate(weeks, 1):
        before, after = week.parts(name)
        titles = {scene: modules.bind_scene(scene).title for scene in week.show}
        shown = ", ".join(course.link_into(report, f"{scene}.html", title) or title for scene, title in titles.items())
        rows = [
            ("Monday, 90 minutes", f"Lecture. {week.lecture}", f"{notebook}, *The idea*; report: {shown}"),
            ("Tuesday, Wednesday", f"Students write {work(name, *before)}.", f"[functions](../lessons/{name})"),
            ("Wednesday, 60 minutes", f"Lab. {week.lab}", "*Where students go wrong*, below"),
            ("Thursday, 45 minutes", f"Together. {week.together}", notebook),
            ("Thursday to Sunday", f"Students write {work(name, *after)}.", f"[functions](../lessons/{name})"),
        ]
        if number == len(weeks):
            rows.append(("Sunday, 23:59", f"Students hand in `lessons/{name}.py`, and bring answers to the *Three "
                         "questions*. *Make it* and *The scene* are for those who want more.", notebook))
            rows.append(("Monday", "Grade, and hand out the page of each student. Discuss the *hardest exercises* of "
                         "the class page.", "*Commands*, below"))
        parts.append((f"**Week {number}**\n\n" if len(weeks) > 1 else "") + plan.table(("when", "what", "with"), rows))
    return "\n\n".join(parts)
