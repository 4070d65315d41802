"""Adapters of solvers that come as Python modules, one class each, for the workers of python.cc.

make(key, settings) makes a solver; its solve(problem, tolerance, time_limit, most_iterations) gives
(status, iterations, detail, f), where `problem` holds the arrays of quadratic_program.h and a tolerance of 0 leaves the
library's own options alone. f are n numbers, or None.
"""
import importlib
import importlib.metadata
import math
import time

import numpy as np

LARGEST = 1e300
SOLVED, INFEASIBLE = "solved", "infeasible"
ITERATION_LIMIT, TIME_LIMIT = "iteration_limit", "time_limit"
FAILURE, UNSUPPORTED = "numerical_failure", "unsupported"
MODULES = {"piqp": "piqp", "clarabel": "clarabel", "qpalm": "qpalm", "scs": "scs", "quadprog": "quadprog",
           "drake": "pydrake.solvers", "pinocchio": "pinocchio", "daqp": "daqp"}
WHEELS = {"pinocchio": "pin", "daqp-avi": "daqp"}


def version(folder):
    return importlib.metadata.version(WHEELS.get(folder, folder))


def make(key, settings):
    name = key.split("-")[0]
    return CLASSES["-".join(key.split("-")[:2]) if name == "pinocchio" else name](
        importlib.import_module(MODULES[name]), settings)


def numbers(buffer):
    return np.frombuffer(buffer, np.float64)


def answer(status, iterations, detail, f):
    """The detail is left out of a success."""
    return (status, int(iterations), "" if status == SOLVED else detail,
            None if f is None else np.ascontiguousarray(f, np.float64))


class Program:
    """The arrays as NumPy and SciPy have them, without copies."""

    def __init__(self, p):
        self.n, self.m, self.primal = p["variables"], p["rows"], p["primal"]
        self.g, self.x_lower = numbers(p["g"]), numbers(p["x_lower"])
        self.lower, self.upper = numbers(p["lower"]), numbers(p["upper"])
        if p["dense"]:
            self.H = numbers(p["H"]).reshape((self.n, self.n), order="F")
            self.C = numbers(p["C"]).reshape((self.m, self.n), order="F")
        else:
            self.H = self.sparse(p, "H", self.n)
            self.C = self.sparse(p, "C", self.m)
        self.start = None
        if "start_x" in p:
            self.start = numbers(p["start_x"]), numbers(p["start_y"])

    def sparse(self, p, name, rows):
        from scipy.sparse import csc_matrix
        arrays = (numbers(p[name + "_value"]), np.frombuffer(p[name + "_index"], np.int32),
                  np.frombuffer(p[name + "_start"], np.int32))
        return csc_matrix(arrays, shape=(rows, self.n), copy=False)

    def equal(self):
        return self.lower == self.upper

    def equations_first(self):
        """The order of the rows that cones want, how many equations there are, and C and the lower bounds in it."""
        equal = self.equal()
        order = np.concatenate([np.flatnonzero(equal), np.flatnonzero(~equal)])
        zeros = int(equal.sum())
        return order, zeros, self.C if zeros in (0, self.m) else self.C[order], self.lower[order]

    def f(self, x, y):
        """y: multipliers of C x >= lower, >= 0."""
        return y if self.primal else x


class Adapter:
    def __init__(self, module, settings):
        self.module, self.settings = module, settings


class Piqp(Adapter):
    """Proximal interior point. Stops where primal and dual residual are below eps_abs + eps_rel times their terms, and
    the duality gap likewise. Takes no starting point."""

    def solve(self, p, tolerance, time_limit, most):
        piqp, q = self.module, Program(p)
        solver = piqp.DenseSolver() if p["dense"] else piqp.SparseSolver()
        settings = solver.settings
        settings.verbose = False
        if tolerance > 0:
            settings.eps_abs = settings.eps_duality_gap_abs = tolerance
            settings.eps_rel = settings.eps_duality_gap_rel = tolerance
            settings.iterative_refinement_always_enabled = self.settings["refinement"] == "yes"
        if most > 0:
            settings.max_iter = int(min(most, 2**31 - 1))
        if q.primal:
            equal = q.equal()
            rows = ~equal
            solver.setup(q.H, q.g, *((q.C[equal], q.lower[equal]) if equal.any() else (None, None)),
                         *((q.C[rows], q.lower[rows]) if rows.any() else (None, None)))
        else:
            solver.setup(q.H, q.g, x_l=q.x_lower)
        status = solver.solve()
        result = solver.result
        f = result.x
        if q.primal:
            f = np.zeros(q.m)
            if equal.any():
                f[equal] = -result.y
            if rows.any():
                f[rows] = result.z_l
        words = {piqp.PIQP_SOLVED: SOLVED, piqp.PIQP_MAX_ITER_REACHED: ITERATION_LIMIT,
                 piqp.PIQP_PRIMAL_INFEASIBLE: INFEASIBLE, piqp.PIQP_DUAL_INFEASIBLE: INFEASIBLE}
        return answer(words.get(status, FAILURE), result.info.iter, "PIQP: " + str(status), f)


class Clarabel(Adapter):
    """Homogeneous interior point. Stops where residuals, relative to their terms, are below tol_feas, and the gap is
    below tol_gap_abs or tol_gap_rel."""

    def solve(self, p, tolerance, time_limit, most):
        clarabel, q = self.module, Program(p)
        from scipy.sparse import triu, vstack
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        if tolerance > 0:
            settings.tol_feas = settings.tol_gap_abs = settings.tol_gap_rel = tolerance
            settings.equilibrate_enable = self.settings["equilibrate"] == "yes"
            settings.static_regularization_constant = float(self.settings["static_regularization"])
        if most > 0:
            settings.max_iter = int(min(most, 2**31 - 1))
        if math.isfinite(time_limit):
            settings.time_limit = time_limit
        order, zeros, A, lower = q.equations_first()  # A x + s = b: zeros first, then s >= 0
        cones = ([clarabel.ZeroConeT(zeros)] if zeros else []) + (
            [clarabel.NonnegativeConeT(q.m - zeros)] if q.m > zeros else [])
        solution = clarabel.DefaultSolver(triu(q.H, format="csc"), q.g, -A, -lower, cones, settings).solve()
        y = np.empty(q.m)
        y[order] = solution.z
        status = str(solution.status)
        words = {"Solved": SOLVED, "MaxIterations": ITERATION_LIMIT, "MaxTime": TIME_LIMIT,
                 "PrimalInfeasible": INFEASIBLE, "DualInfeasible": INFEASIBLE}
        return answer(words.get(status, FAILURE), solution.iterations, "Clarabel: " + status,
                      q.f(np.asarray(solution.x), y))


class Qpalm(Adapter):
    """Proximal augmented Lagrangian. Stops where the residuals are below eps_abs + eps_rel times their terms."""

    def solve(self, p, tolerance, time_limit, most):
        qpalm, q = self.module, Program(p)
        settings = qpalm.Settings()
        settings.verbose = 0
        if tolerance > 0:
            settings.eps_abs = settings.eps_rel = tolerance
            settings.scaling = int(self.settings["scaling"])
            settings.gamma_init = settings.gamma_max = float(self.settings["gamma"])
        if most > 0:
            settings.max_iter = int(min(most, 2**31 - 1))
            settings.inner_max_iter = settings.max_iter if tolerance > 0 else settings.inner_max_iter
        if math.isfinite(time_limit):
            settings.time_limit = time_limit
        data = qpalm.Data(q.n, q.m)
        data.Q, data.q, data.A = q.H, q.g, q.C
        data.bmin, data.bmax = np.maximum(q.lower, -1e20), np.minimum(q.upper, 1e20)
        solver = qpalm.Solver(data, settings)
        if q.start is not None:
            solver.warm_start(q.start[0], -q.start[1])
        solver.solve()
        info = solver.info
        words = {info.SOLVED: SOLVED, info.MAX_ITER_REACHED: ITERATION_LIMIT, info.TIME_LIMIT_REACHED: TIME_LIMIT,
                 info.PRIMAL_INFEASIBLE: INFEASIBLE, info.DUAL_INFEASIBLE: INFEASIBLE}
        return answer(words.get(info.status_val, FAILURE), info.iter, "QPALM: " + info.status,
                      q.f(solver.solution.x, -solver.solution.y))


class Scs(Adapter):
    """Operator splitting on the homogeneous embedding. Stops where residuals and gap are below eps_abs + eps_rel times
    their terms."""

    def solve(self, p, tolerance, time_limit, most):
        scs, q = self.module, Program(p)
        if q.m == 0:
            return answer(UNSUPPORTED, 0, "SCS takes no program without constraints", None)
        from scipy.sparse import triu
        options = {"verbose": False}
        if tolerance > 0:
            options.update(eps_abs=tolerance, eps_rel=tolerance,
                           acceleration_lookback=int(self.settings["acceleration_lookback"]),
                           scale=float(self.settings["scale"]), normalize=self.settings["normalize"] == "yes")
        if most > 0:
            options["max_iters"] = int(min(most, 2**31 - 1))
        if math.isfinite(time_limit):
            options["time_limit_secs"] = max(time_limit, 1e-6)
        order, zeros, A, lower = q.equations_first()
        data = {"P": triu(q.H, format="csc"), "A": -A, "b": -lower, "c": q.g}
        solver = scs.SCS(data, {"z": zeros, "l": q.m - zeros}, **options)
        if q.start is None:
            result = solver.solve(warm_start=False)
        else:
            x, y = q.start
            result = solver.solve(warm_start=True, x=x, y=y[order], s=(q.C @ x - q.lower)[order])
        info = result["info"]
        y = np.empty(q.m)
        y[order] = result["y"]
        words = {scs.SOLVED: SOLVED, scs.SOLVED_INACCURATE: ITERATION_LIMIT, scs.INFEASIBLE: INFEASIBLE,
                 scs.UNBOUNDED: INFEASIBLE}
        return answer(words.get(info["status_val"], FAILURE), info["iter"], "SCS: " + info["status"],
                      q.f(result["x"], y))


class Quadprog(Adapter):
    """Goldfarb and Idnani's dual active set. Stops at the optimal set; takes a positive definite H only."""

    def solve(self, p, tolerance, time_limit, most):
        q = Program(p)
        try:
            if q.primal:
                equal = q.equal()
                order = np.concatenate([np.flatnonzero(equal), np.flatnonzero(~equal)])
                solution = self.module.solve_qp(q.H, -q.g, q.C.T[:, order], q.lower[order], int(equal.sum()))
                f = np.empty(q.m)
                f[order] = solution[4]
                # quadprog gives only the size of an equation's multiplier.
                if equal.any():
                    f[equal] = self.signed(q, equal, f, solution[0])
            else:
                rows = np.flatnonzero(q.x_lower == 0)
                solution = self.module.solve_qp(q.H, -q.g, np.eye(q.n)[:, rows], np.zeros(len(rows)))
                f = solution[0]
        except ValueError as error:
            word = INFEASIBLE if "inconsistent" in str(error) else FAILURE
            return answer(word, 0, "quadprog: " + str(error), None)
        return answer(SOLVED, solution[3][0], "", f)

    @staticmethod
    def signed(q, equal, f, v):
        """Multipliers of the equations from M v = J^T f, that of the others being known."""
        rest = q.H @ v - q.C[~equal].T @ f[~equal]
        return np.linalg.lstsq(q.C[equal].T, rest, rcond=None)[0]


class DaqpAvi(Adapter):
    """Affine variational inequality: dual active sets of a proximal iteration. Stops where no constraint is violated by
    more than primal_tol and the proximal iteration moves by less than eta_prox."""

    def solve(self, p, tolerance, time_limit, most):
        q = Program(p)
        settings = {"primal_tol": tolerance, "eta_prox": tolerance} if tolerance > 0 else {}
        if most > 0:
            settings["iter_limit"] = int(min(most, 2**31 - 1))
        if math.isfinite(time_limit):
            settings["time_limit"] = max(time_limit, 1e-6)  # 0: none
        # Bounds of the variables alone; those that are infinite are beyond its 1e30.
        f, _, flag, info = self.module.solve(q.H, q.g, np.zeros((0, q.n)), np.full(q.n, 1e30), np.maximum(q.x_lower, -1e30),
                                             np.zeros(q.n, np.int32), is_avi=True, **settings)
        words = {1: SOLVED, -1: INFEASIBLE, -3: INFEASIBLE, -4: ITERATION_LIMIT, -7: TIME_LIMIT}
        return answer(words.get(flag, FAILURE), info["iterations"], f"DAQP: exit flag {flag}", f)


class DrakeMoby(Adapter):
    """MobyLcpSolver, as a program with one complementarity condition: Lemke's method on A with growing shifts of the
    diagonal, which is all that the Python module offers of it. Stops by its own tolerances."""

    def solve(self, p, tolerance, time_limit, most):
        q = Program(p)
        program = self.module.MathematicalProgram()
        x = program.NewContinuousVariables(q.n)
        program.AddLinearComplementarityConstraint(q.H, q.g, x)
        result = self.module.MobyLcpSolver().Solve(program)
        f = result.GetSolution(x)
        if result.is_success():
            return answer(SOLVED, 0, "", f)
        return answer(FAILURE, 0, "Drake: " + str(result.get_solution_result()), f if np.all(np.isfinite(f)) else None)


class Rows:
    """What Pinocchio is given of a problem: A and b in its order of rows. Plain rows stay as they are. Of a problem with
    friction each contact is a point contact in space, t, t', n: the second tangent, and both of a contact without
    friction, are coupled to nothing and have no load, so that their forces are 0."""

    def __init__(self, p, H, g):
        self.bilateral = np.frombuffer(p["bilateral"], np.uint8) != 0
        tangents = np.frombuffer(p["friction_row"], np.int32)
        self.n, self.H, self.g, self.row, self.mu = g.size, H, g, None, None
        if tangents.size == 0:
            return
        tangent_of = np.full(self.n, -1)
        tangent_of[np.frombuffer(p["friction_normal"], np.int32)] = tangents
        mu_of = np.zeros(self.n)
        mu_of[np.frombuffer(p["friction_normal"], np.int32)] = numbers(p["friction_mu"])
        is_normal = ~self.bilateral
        is_normal[tangents] = False
        normals, joints = np.flatnonzero(is_normal), np.flatnonzero(self.bilateral)
        self.mu, has_tangent = mu_of[normals], tangent_of[normals] >= 0
        first = np.where(has_tangent, tangent_of[normals], normals)
        self.row = np.concatenate([np.stack([first, first, normals], axis=1).ravel(), joints])
        factor = np.stack([has_tangent, np.zeros(normals.size), np.ones(normals.size)], axis=1).ravel()
        self.factor = np.concatenate([factor, np.ones(joints.size)])
        self.H = H[np.ix_(self.row, self.row)] * np.outer(self.factor, self.factor)
        dummies = np.flatnonzero(self.factor == 0)
        self.H[dummies, dummies] = H[self.row[dummies], self.row[dummies]]
        self.g = g[self.row] * self.factor
        self.bilateral = np.ones(joints.size, bool)

    def key(self):
        return (b"" if self.mu is None else self.mu.tobytes(), self.bilateral.tobytes())

    def into(self, f):
        return np.array(f) if self.row is None else np.asarray(f)[self.row] * self.factor

    def out_of(self, x):
        return x if self.row is None else np.bincount(self.row, x * self.factor, self.n)


class Pinocchio(Adapter):
    """Constraint solvers on a dense Delassus matrix. Plain rows are one friction of joints, whose forces have bounds: 0
    and infinity where a row pushes, none where it is a joint. They stop where feasibility and complementarity are below
    absolute or relative tolerances, or at a limit of iterations: they read no clock."""

    of_tolerance_with_friction = 1.0

    def __init__(self, module, settings):
        super().__init__(module, settings)
        self.kept = {}

    def constraint(self, rows):
        """By a model of as many joints, of which nothing else is used: kept between problems with the same rows, as a
        user would keep it."""
        key = rows.key()
        if key not in self.kept:
            if len(self.kept) >= 1000:
                self.kept.clear()
            self.kept[key] = self.new_constraint(rows)
        return self.kept[key]

    def new_constraint(self, rows):
        pin = self.module
        model = pin.Model()
        models, states = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        if rows.mu is not None:
            body = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
        joints = pin.StdVec_Index()
        for i in range(rows.bilateral.size):
            joints.append(model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), str(i)))
        for mu in rows.mu if rows.mu is not None else ():
            contact = pin.PointContactConstraintModel(model, body)
            contact.setFriction(float(mu))
            models.append(pin.ConstraintModel(contact))
        if rows.bilateral.size:
            friction = pin.JointFrictionConstraintModel(model, joints)
            friction.setFrictionLowerLimit(np.where(rows.bilateral, -LARGEST, 0.0))
            friction.setFrictionUpperLimit(np.full(rows.bilateral.size, LARGEST))
            models.append(pin.ConstraintModel(friction))
        state = model.createData()
        pin.forwardKinematics(model, state, pin.neutral(model))
        for one in models:
            states.append(pin.ConstraintData(one.createData()))
            one.calc(model, state, states[len(states) - 1])
        return model, models, states

    def options(self, tuned):
        raise NotImplementedError

    def solve(self, p, tolerance, time_limit, most):
        pin, q = self.module, Program(p)
        rows = Rows(p, q.H, q.g)
        _, models, states = self.constraint(rows)
        solver, settings, result = self.options(tolerance > 0)
        if tolerance > 0:
            if rows.mu is not None:
                tolerance *= self.of_tolerance_with_friction
            settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance
            settings.relative_feasibility_tol = settings.relative_complementarity_tol = tolerance
        if most > 0:
            settings.max_iterations = int(min(most, 2**31 - 1))
        if q.start is not None:
            result.setConstraintImpulseGuess(rows.into(q.start[0]))
        matrix = pin.DelassusOperatorDense(rows.H)
        call = lambda: solver.solve(matrix, rows.g, models, states, settings, result)
        status, iterations = self.run(call, rows, len(models), settings, result, time_limit)
        return answer(status, iterations, "", rows.out_of(result.retrieveConstraintImpulses()))

    def run(self, call, rows, sets, settings, result, time_limit):
        return (SOLVED if call() else ITERATION_LIMIT), result.iterations


class PinocchioAdmm(Pinocchio):
    of_tolerance_with_friction = 0.01  # with the tolerances of plain rows a quarter of the claims miss the tier

    def options(self, tuned):
        pin = self.module
        settings = pin.ADMMSolverSettings()
        if tuned:
            settings.mu_prox = float(self.settings["mu_prox"])
            settings.admm_update_rule = getattr(pin.ADMMUpdateRule, self.settings["update_rule"].upper())
        return pin.ADMMConstraintSolver(), settings, pin.ADMMSolverResult()


class PinocchioPgs(Pinocchio):
    """Beside another set its own measure ends the sweeps too early: it is that of one set. There sweeps are asked for in
    growing numbers, until one more corrects no velocity by more than the tolerance times the largest of b, or the time
    is over."""

    def options(self, tuned):
        pin = self.module
        settings = pin.PGSSolverSettings()
        if tuned:
            settings.over_relaxation = float(self.settings["over_relaxation"])
        return pin.PGSConstraintSolver(), settings, pin.PGSSolverResult()

    def run(self, call, rows, sets, settings, result, time_limit):
        if sets < 2:
            return super().run(call, rows, sets, settings, result, time_limit)
        tolerance = settings.absolute_feasibility_tol * np.abs(rows.g).max()
        settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 0.0
        settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
        most, done, portion, largest = settings.max_iterations, 0, 16, 1024
        diagonal = np.diag(rows.H)
        end = time.monotonic() + time_limit
        while True:
            settings.max_iterations = min(portion, most - done)
            call()
            before = np.array(result.retrieveConstraintImpulses())
            result.setConstraintImpulseGuess(before)
            settings.max_iterations = 1
            call()
            after = np.array(result.retrieveConstraintImpulses())
            done += min(portion, most - done)
            result.setConstraintImpulseGuess(after)
            if np.max(diagonal * np.abs(after - before)) <= tolerance:
                return SOLVED, done
            if done >= most or time.monotonic() >= end:
                return (ITERATION_LIMIT if done >= most else TIME_LIMIT), done
            portion = min(2 * portion, largest)


CLASSES = {"piqp": Piqp, "clarabel": Clarabel, "qpalm": Qpalm, "scs": Scs, "quadprog": Quadprog, "drake": DrakeMoby, "daqp": DaqpAvi,
           "pinocchio-admm": PinocchioAdmm, "pinocchio-pgs": PinocchioPgs}
