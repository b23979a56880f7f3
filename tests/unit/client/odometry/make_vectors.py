#!/usr/bin/env python3
"""Writes vectors.json, which client/odometry and the Python package must reproduce.

It shares no code and no formula with either: rotations are exponentials of matrices by their series, Jacobians are
differences, the update is a least-squares problem over whitened equations, and the way to the answer is kept as a list
of all places. The rules themselves are those of client/odometry/README.md.

usage: make_vectors.py > vectors.json
"""

import json
import math

import numpy as np

RANDOM = np.random.default_rng(20261130)


def skew(v):
    return np.cross(np.eye(3), v)


def exp(v):
    """A rotation matrix, by the series of exp of a sixteenth, squared four times."""
    small, term, total = skew(np.asarray(v) / 16.0), np.eye(3), np.eye(3)
    for n in range(1, 18):
        term = term @ small / n
        total = total + term
    for _ in range(4):
        total = total @ total
    return total


def log(rotation):
    """Axis times angle, of the eigenvector to 1; its sign by the antisymmetric part."""
    angle = math.acos(min(1.0, max(-1.0, (np.trace(rotation) - 1) / 2)))
    antisymmetric = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    if angle < 1e-4:  # acos is inexact there
        return antisymmetric / 2
    values, vectors = np.linalg.eig(rotation)
    axis = np.real(vectors[:, np.argmin(np.abs(values - 1))])
    return angle * axis * np.sign(axis @ antisymmetric)


def pose(position, turn):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = exp(turn), position
    return matrix


def disturbed(matrix, error):
    """The map's axes: position and rotation err independently of each other."""
    result = np.array(matrix)
    result[:3, 3] += error[:3]
    result[:3, :3] = exp(error[3:]) @ result[:3, :3]
    return result


def error_between(true, stated):
    return np.concatenate([true[:3, 3] - stated[:3, 3], log(true[:3, :3] @ stated[:3, :3].T)])


def jacobian(function, stated):
    """Of the error of function(pose) by the error of the pose, by central differences."""
    step, columns = 1e-5, []
    for i in range(6):
        error = np.zeros(6)
        error[i] = step
        ahead = error_between(function(disturbed(stated, error)), function(stated))
        behind = error_between(function(disturbed(stated, -error)), function(stated))
        columns.append((ahead - behind) / (2 * step))
    return np.array(columns).T


DRIFT = {
    "at_rest": [0.01, 0.01, 0.01, 0.005],
    "per_meter": [0.02, 0.05, 0.02, 0.01],
    "per_radian": [0.02, 0.01, 0.01, 0.03],
}


def variances(sigmas):
    flat, high, tilt, yaw = sigmas
    return np.array([flat, flat, high, tilt, tilt, yaw]) ** 2


def growth(way):
    return way if way < 1 else way * way


class Belief:
    """An answer, its covariance, and all places where the odometry has been since."""

    def __init__(self, options, place, answer, covariance):
        self.options = options
        self.begin(place, None, answer, covariance + np.diag(variances(options["drift"]["at_rest"])))

    def begin(self, place, before, answer, measured):
        """The answers of a place are kept with what was believed before them."""
        self.first, self.before, self.answers = place, before, [(answer, measured)]
        self.places, (self.stated, self.covariance) = [place], self.believed()

    def believed(self):
        """At the first place of all that belong together: the answers' mean counts as one answer."""
        mean = self.answers[0][0]
        for count, (answer, _) in enumerate(self.answers[1:], 2):
            mean = disturbed(mean, error_between(answer, mean) / count)
        measured = sum(covariance for _, covariance in self.answers) / len(self.answers)
        if not self.before:
            return mean, measured
        stated, expected = self.before
        # Least squares over twelve whitened equations: step = 0 by odometry, step = error by the answers.
        whitened = [np.linalg.inv(np.linalg.cholesky(c)) for c in (expected, measured)]
        equations = np.vstack(whitened)
        wanted = np.concatenate([np.zeros(6), whitened[1] @ error_between(mean, stated)])
        step = np.linalg.lstsq(equations, wanted, rcond=None)[0]
        return disturbed(stated, step), np.linalg.inv(equations.T @ equations)

    def expected(self, place):
        step = np.linalg.inv(self.first) @ place
        moved = jacobian(lambda base: base @ step, self.stated)
        meters = radians = 0.0
        for a, b in zip(self.places, self.places[1:] + [place]):
            between = np.linalg.inv(a) @ b
            meters += math.dist(b[:3, 3], a[:3, 3])
            radians += np.linalg.norm(log(between[:3, :3]))
        drift = self.options["drift"]
        added = growth(meters) * variances(drift["per_meter"]) + growth(radians) * variances(drift["per_radian"])
        half_way = np.array(step)
        half_way[:3, 3] /= 2
        half_way[:3, :3] = np.eye(3)
        lever = jacobian(lambda base: base @ half_way, self.stated)
        total = moved @ self.covariance @ moved.T + lever @ np.diag(added) @ lever.T
        return self.stated @ step, total

    def gap(self, place, answer, covariance):
        stated, expected = self.expected(place)
        error = error_between(answer, stated)
        total = expected + covariance + np.diag(variances(self.options["drift"]["at_rest"]))
        # The furthest direction: the largest u . error / sqrt(u' total u) is at u = total^-1 error.
        sigmas = []
        for part in (slice(0, 3), slice(3, 6)):
            direction = np.linalg.inv(total[part, part]) @ error[part]
            spread = math.sqrt(direction @ total[part, part] @ direction)
            sigmas.append(abs(direction @ error[part]) / spread if spread else 0.0)
        return [float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:])), *sigmas]

    def take(self, place, answer, covariance):
        measured = covariance + np.diag(variances(self.options["drift"]["at_rest"]))
        back = np.linalg.inv(place) @ self.first
        near = np.linalg.norm(back[:3, 3]) < 0.05 and np.linalg.norm(log(back[:3, :3])) < 0.05
        if not self.options["smooth"]:
            self.begin(place, None, answer, measured)
        elif not near:
            self.begin(place, self.expected(place), answer, measured)
        else:
            moved = jacobian(lambda base: base @ back, answer)
            self.answers.append((answer @ back, moved @ measured @ moved.T))
            self.places, (self.stated, self.covariance) = [place], self.believed()


class Rules:
    """What becomes of the answers."""

    def __init__(self, options):
        self.options, self.belief, self.others, self.held = options, None, [], 0

    def fits(self, gap):
        return max(gap[2:]) <= self.options["max_sigmas"]

    def confirms(self, gap, gap_to_belief):
        if not gap_to_belief:
            return self.fits(gap)
        return max(gap[2:]) <= 1.5 * self.options["max_sigmas"] and max(gap[2:]) * 3 <= max(gap_to_belief[2:])

    def see(self, place):
        for belief in [self.belief, *[other for other, _ in self.others]]:
            if belief:
                belief.places.append(place)

    def judge(self, place, answer, covariance):
        self.see(place)
        gap = self.belief.gap(place, answer, covariance) if self.belief else None
        if gap and self.fits(gap):
            self.belief.take(place, answer, covariance)
            self.others, self.held = [], 0
            return "TAKEN", gap, 0
        for entry in self.others:
            if self.confirms(entry[0].gap(place, answer, covariance), gap):
                entry[0].take(place, answer, covariance)
                entry[1] += 1
                break
        else:
            entry = [Belief(self.options, place, answer, covariance), 1]
            self.others = [*self.others, entry][-self.options["agreeing_answers"] :]
        if entry[1] >= self.options["agreeing_answers"]:
            self.belief, self.others, self.held = entry[0], [], 0
            return "RELOCATED", gap, entry[1]
        self.held += 1
        if not gap:
            return "UNCONFIRMED", gap, entry[1]
        return ("POSITION_CONTRADICTED" if gap[2] > self.options["max_sigmas"] else "ROTATION_CONTRADICTED"), gap, entry[1]


def random_covariance(sigma):
    root = RANDOM.normal(size=(6, 6)) * np.array([sigma] * 3 + [sigma / 5] * 3)[:, None] / math.sqrt(6)
    return root @ root.T + np.diag([sigma**2 / 10] * 3 + [sigma**2 / 250] * 3)


def quaternion(rotation):
    """By the half angle."""
    turn = log(rotation)
    angle = np.linalg.norm(turn)
    axis = turn / angle if angle else turn
    return [*(math.sin(angle / 2) * axis), math.cos(angle / 2)]


def numbers(matrix):
    return {"position": list(matrix[:3, 3]), "xyzw": quaternion(matrix[:3, :3])}


def uncertain(matrix, covariance):
    return {**numbers(matrix), "covariance": covariance.ravel().tolist()}


OFFSETS = {
    "w": [2.0, -1.5, 0.2, 0, 0, 0.3],
    "r": [0, 0, 0, 0, 0, 3.0],
    "s": [0.3, 0, 0, 0, 0, 0],
    "m": [0.28, 0, 0, 0, 0, 0],
    "y": [0.19, 0.24, 0, 0, 0, 0],
}


def drive(name, options, kinds):
    """`kinds`: one letter an image: g good, w wrong, r wrong in its rotation, n not localized, K the robot is carried
    away before it (then good), s 0.3 m off, which a long way without answers may explain, m 0.28 m off, which only
    other answers of a new place agree with, y 0.3 m off in another direction, h good, and the robot has hardly moved."""
    truth, place, rules, steps = pose([3, -2, 0.5], [0.1, -0.2, 2.5]), pose([10, 20, 0], [0, 0, -1.0]), Rules(options), []
    for kind in kinds:
        step = pose([RANDOM.uniform(0.05, 1.5), RANDOM.normal() * 0.05, 0], RANDOM.normal(size=3) * [0.02, 0.02, 0.3])
        if kind == "h":
            step = pose([0.01, -0.01, 0], [0, 0.001, 0.01])
        truth, place = truth @ step, place @ step @ pose(RANDOM.normal(size=3) * 0.002, RANDOM.normal(size=3) * 0.001)
        if kind == "K":
            truth = pose([40, 5, -1], [0, 0.1, -3.0])
        entry = {"odom_from_base": numbers(place)}
        if kind == "n":
            rules.see(place)
        else:
            covariance = random_covariance(0.05)
            error = np.linalg.cholesky(covariance) @ RANDOM.normal(size=6) * 0.5
            answer = disturbed(disturbed(truth, error), np.array(OFFSETS.get(kind, [0] * 6)))
            entry["answer"] = uncertain(answer, covariance)
            verdict, gap, agreeing = rules.judge(place, answer, covariance)
            entry["verdict"], entry["gap"], entry["agreeing"] = verdict, gap, agreeing
        entry["held_in_a_row"] = rules.held
        if rules.belief:
            back = jacobian(lambda base: base @ np.linalg.inv(rules.belief.first), rules.belief.stated)
            at_origin = rules.belief.stated @ np.linalg.inv(rules.belief.first)
            entry["map_from_odom"] = uncertain(at_origin, back @ rules.belief.covariance @ back.T)
            later = place @ pose([0.4, 0.1, 0], [0, 0, 0.2])
            entry["later_odom_from_base"] = numbers(later)
            entry["later_map_from_base"] = uncertain(*rules.belief.expected(later))
        steps.append(entry)
    return {"name": name, "options": options, "steps": steps}


def main():
    usual = {"drift": DRIFT, "max_sigmas": 3.0, "agreeing_answers": 3, "smooth": True}
    exact = {
        "at_rest": [0.002, 0.003, 0.001, 0.001],
        "per_meter": [0.005, 0.006, 0.002, 0.003],
        "per_radian": [0.001, 0.0, 0.004, 0.01],
    }
    drives = [
        drive("start, wrong ones, refused images", usual, "gggggwgnngggrgggwwggg"),
        drive("carried away", usual, "gggggggKggggggg"),
        drive("carried away, with wrong answers between", usual, "ggggKwggggg"),
        drive("a long way without answers", usual, "gggg" + "n" * 25 + "sgggg"),
        drive("wrong ones between right ones do not add up", usual, "gggwgwgwgg"),
        drive("a new place is agreed on with more tolerance", usual, "ggggmgKmmgggg"),
        drive("errors on the same side are no new place", usual, "ggggsymgsymgg"),
        drive("a start asks for full agreement", usual, "gmmgmgg"),
        drive("without smoothing", {**usual, "smooth": False}, "gggggwggngrg"),
        drive("two that agree suffice", {**usual, "agreeing_answers": 2}, "wgggwwgKggg"),
        drive("nothing is held back", {**usual, "agreeing_answers": 1}, "gwgg"),
        drive("better odometry, another gate", {**usual, "drift": exact, "max_sigmas": 4.5}, "gggggwgnnsggrg"),
        drive("answers of one place count as one", usual, "hhhhhhgghhhwhhhhhhgKhhhhg"),
    ]
    rounded = json.loads(json.dumps(drives), parse_float=lambda text: float(f"{float(text):.12g}"))
    print(json.dumps(rounded, separators=(",", ":")).replace('{"name"', '\n{"name"'))


if __name__ == "__main__":
    main()
